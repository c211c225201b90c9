"""The scaling benchmark: each planner over the paper's sizes to ten thousand blocks, as far as it still answers."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from pathlib import Path

from smash.experiments.sweeps.experiment import Experiment, PlannerEntry
from smash.problem.files.instances import write_instance
from smash.problem.sets.open_instances import Shape, draw_instance

SIZES: tuple[tuple[int, int], ...] = (
    (4, 3),
    (6, 3),
    (9, 3),
    (15, 3),
    (25, 5),
    (50, 5),
    (100, 10),
    (200, 20),
    (300, 30),
    (500, 25),
    (1000, 50),
    (2000, 100),
    (5000, 150),
    (10_000, 200),
)
"""(blocks, stacks): the paper's three sizes, then wider tables."""
LARGEST: Mapping[str, int] = {
    "smash": 10_000,
    "precedence": 10_000,
    "greedy": 10_000,
    "astar": 15,
    "smash-layered": 15,
    "smash-flow": 4,
    "fd-lama": 25,
    "fd-opt-ipdb": 9,
}
"""Planner -> the size up to which it is worth a run: above, it spends its whole budget without an answer."""
PAPERS_BUFFERS = 12


def suite_name(blocks: int, stacks: int) -> str:
    """Return the name of the instance set of one size."""
    return f"{blocks:04}-blocks-{stacks}-stacks"


def write_scaling_suites(directory: Path, largest: int, count: int, seed: int) -> list[tuple[int, str]]:
    """Write `count` random `stacks` instances of every size up to `largest`; equal arguments give equal files.

    Returns:
        (blocks, name of the set) of each size.
    """
    sizes = []
    for blocks, stacks in SIZES:
        if blocks > largest:
            continue
        suite = suite_name(blocks, stacks)
        (directory / suite).mkdir(parents=True, exist_ok=True)
        shape = Shape(blocks, stacks, PAPERS_BUFFERS)
        for number in range(count):
            name = f"{suite}-{number:02}"
            instance = draw_instance(name, shape, random.Random(f"scaling/{seed}/{name}"))
            write_instance(instance, directory / suite / f"{name}.json")
        sizes.append((blocks, suite))
    return sizes


def scaling_experiment(
    sizes: Sequence[tuple[int, str]], planners: Sequence[str], budget: float, seed: int = 0
) -> Experiment:
    """Return the experiment over `sizes`: no buffer, the paper's 12, and as many as blocks.

    Args:
        sizes: (blocks, set) as `write_scaling_suites` returns them.
        planners: names; those of `LARGEST` stop at their size, any other goes all the way.
        budget: seconds of each run.
        seed: for planners that draw.
    """
    entries = [
        PlannerEntry(name=planner, suites=[suite], buffers=sorted({0, PAPERS_BUFFERS, blocks}))
        for planner in planners
        for blocks, suite in sizes
        if blocks <= LARGEST.get(planner, blocks)
    ]
    return Experiment(
        name="scaling", suites=[suite for _, suite in sizes], planners=entries, budgets=[budget], seeds=[seed]
    )
