"""Random instances of the paper's two benchmarks (section "Experiments and Benchmarks").

Sizes of the stacks are a uniform composition of n into as many non-empty parts (the paper: 3), the blocks a uniform
permutation, the target of the single-goal benchmark uniform. Every instance has a random stream of its own,
so that instance k does not depend on how many are drawn.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Sequence

from smash.problem.arguments import whole_number
from smash.problem.errors import SmashError
from smash.problem.making import make_instance
from smash.problem.model import Instance, PositionsGoal, StacksGoal

STACKS = 3
"""The paper's number of stacks."""
BUFFERS = 12
"""The paper's largest number of buffers."""
MOST = 100_000
"""Most blocks, stacks, buffers or instances that are made by number: their files can still be read."""
EXTRA = "g"
"""The single-goal benchmark's further location: empty at the start, the target's goal."""


def draw_arrangement(
    blocks: tuple[str, ...], stacks: tuple[str, ...], draw: random.Random
) -> dict[str, tuple[str, ...]]:
    """Return a uniform permutation of `blocks` cut into non-empty stacks at uniform places."""
    order = list(blocks)
    draw.shuffle(order)
    return {stack: tuple(part) for stack, part in zip(stacks, cut(order, len(stacks), draw), strict=True)}


def cut(order: Sequence[str], parts: int, draw: random.Random) -> list[list[str]]:
    """Cut a sequence into `parts` non-empty pieces at uniform places.

    Raises:
        ValueError: where the sequence is shorter than `parts`.
    """
    places = [0, *sorted(draw.sample(range(1, len(order)), parts - 1)), len(order)]
    return [list(order[start:end]) for start, end in itertools.pairwise(places)]


def single_goal(name: str, blocks: int, stacks: int, buffers: int, draw: random.Random) -> Instance:
    """Draw a single-goal instance: one target block must reach height 1 of the empty location `g`."""
    names, piles = block_names(blocks), stack_names(stacks)
    start = draw_arrangement(names, piles, draw)
    target = draw.choice(names)
    return make_instance(
        name=name,
        blocks=names,
        stacks=(*piles, EXTRA),
        buffers=buffer_names(buffers),
        start=start,
        goal=PositionsGoal({target: (EXTRA, 1)}),
    )


def multi_goal(name: str, blocks: int, stacks: int, buffers: int, draw: random.Random) -> Instance:
    """Draw a multi-goal instance: start and goal are two random arrangements on the same stacks."""
    names, piles = block_names(blocks), stack_names(stacks)
    return make_instance(
        name=name,
        blocks=names,
        stacks=piles,
        buffers=buffer_names(buffers),
        start=draw_arrangement(names, piles, draw),
        goal=StacksGoal(draw_arrangement(names, piles, draw)),
    )


BENCHMARKS = {"single": single_goal, "multi": multi_goal}


def generate(
    kind: str, blocks: int, *, stacks: int = STACKS, buffers: int = BUFFERS, count: int = 1, seed: int = 0
) -> list[Instance]:
    """Return random instances of a benchmark of the paper; equal arguments give equal instances.

    They are called `multi-9-000` and on, with another number of stacks than the paper's `multi-9x4-000` and on.

    Example:
        `smash.generate("multi", 9, count=20, seed=1)`

    Args:
        kind: `single` (one target block must reach the empty location `g`) or `multi` (every block has its place).
        blocks: number of blocks, `stacks` or more.
        stacks: number of stacks that hold blocks, `s1` and on.
        buffers: number of empty buffers, `u1` and on.
        count: number of instances; instance k does not depend on it.
        seed: of the set.

    Raises:
        SmashError: where there is no such benchmark, or a number is too small or too large.
    """
    if kind not in BENCHMARKS:
        raise SmashError(f"no benchmark is called {kind!r}; known: {', '.join(BENCHMARKS)}")
    for what, number, least in (
        ("blocks", blocks, 1),
        ("stacks", stacks, 1),
        ("buffers", buffers, 0),
        ("count", count, 0),
    ):
        whole_number(what, number, least, MOST)
    whole_number("seed", seed, 0)
    if blocks < stacks:
        raise SmashError(f"blocks: {blocks} are too few for {stacks} stacks, none of which is empty")
    size = f"{blocks}" if stacks == STACKS else f"{blocks}x{stacks}"
    instances = []
    for index in range(count):
        draw = random.Random(f"{kind}/{size}/{seed}/{index}")
        instances.append(BENCHMARKS[kind](f"{kind}-{size}-{index:03}", blocks, stacks, buffers, draw))
    return instances


def stack_names(count: int) -> tuple[str, ...]:
    """Return `s1`, `s2`, …."""
    return tuple(f"s{number}" for number in range(1, count + 1))


def block_names(count: int) -> tuple[str, ...]:
    """Return `b1`, `b2`, …."""
    return tuple(f"b{number}" for number in range(1, count + 1))


def buffer_names(count: int) -> tuple[str, ...]:
    """Return `u1`, `u2`, …."""
    return tuple(f"u{number}" for number in range(1, count + 1))
