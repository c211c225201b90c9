"""Random instances of the paper's two benchmarks (section "Experiments and Benchmarks").

Sizes of the three stacks are a uniform composition of n into 3 non-empty parts, the blocks a uniform
permutation, the target of the single-goal benchmark uniform. Every instance has a random stream of its own,
so that instance k does not depend on how many are drawn.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Sequence

from smash.problem.making import make_instance
from smash.problem.model import Instance, PositionsGoal, StacksGoal

STACKS = ("s1", "s2", "s3")
EXTRA = "g"
"""The single-goal benchmark's fourth location: empty at the start, the target's goal."""


def draw_arrangement(blocks: tuple[str, ...], draw: random.Random) -> dict[str, tuple[str, ...]]:
    """Return a uniform permutation of `blocks` cut into three non-empty stacks at uniform places."""
    order = list(blocks)
    draw.shuffle(order)
    return {stack: tuple(part) for stack, part in zip(STACKS, cut(order, len(STACKS), draw), strict=True)}


def cut(order: Sequence[str], parts: int, draw: random.Random) -> list[list[str]]:
    """Cut a sequence into `parts` non-empty pieces at uniform places.

    Raises:
        ValueError: where the sequence is shorter than `parts`.
    """
    places = [0, *sorted(draw.sample(range(1, len(order)), parts - 1)), len(order)]
    return [list(order[start:end]) for start, end in itertools.pairwise(places)]


def single_goal(name: str, blocks: int, buffers: int, draw: random.Random) -> Instance:
    """Draw a single-goal instance: one target block must reach height 1 of the empty location `g`."""
    names = block_names(blocks)
    start = draw_arrangement(names, draw)
    target = draw.choice(names)
    return make_instance(
        name=name,
        blocks=names,
        stacks=(*STACKS, EXTRA),
        buffers=buffer_names(buffers),
        start=start,
        goal=PositionsGoal({target: (EXTRA, 1)}),
    )


def multi_goal(name: str, blocks: int, buffers: int, draw: random.Random) -> Instance:
    """Draw a multi-goal instance: start and goal are two random arrangements on the same three stacks."""
    names = block_names(blocks)
    return make_instance(
        name=name,
        blocks=names,
        stacks=STACKS,
        buffers=buffer_names(buffers),
        start=draw_arrangement(names, draw),
        goal=StacksGoal(draw_arrangement(names, draw)),
    )


BENCHMARKS = {"single": single_goal, "multi": multi_goal}


def generate(benchmark: str, blocks: int, buffers: int, count: int, seed: int) -> Iterator[Instance]:
    """Yield `count` instances of a benchmark, named `multi-9-000` and on.

    Args:
        benchmark: `single` or `multi`.
        blocks: number of blocks, 3 or more.
        buffers: number of buffers.
        count: number of instances.
        seed: the set's seed; equal arguments give equal instances.
    """
    for index in range(count):
        draw = random.Random(f"{benchmark}/{blocks}/{seed}/{index}")
        yield BENCHMARKS[benchmark](f"{benchmark}-{blocks}-{index:03}", blocks, buffers, draw)


def block_names(count: int) -> tuple[str, ...]:
    """Return `b1`, `b2`, …."""
    return tuple(f"b{number}" for number in range(1, count + 1))


def buffer_names(count: int) -> tuple[str, ...]:
    """Return `u1`, `u2`, …."""
    return tuple(f"u{number}" for number in range(1, count + 1))
