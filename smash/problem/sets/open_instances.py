"""Graded instances beyond the paper's benchmarks: the committed `open-*` sets.

Each family asks for one thing that the paper's sizes do not: few buffers at more blocks, wide tables with
hundreds of blocks, partial `on` goals of the classical blocks world, starts with blocks already toppled, many
short stacks (where it is hard to say which of them to topple). Caps on a topple are variants of every instance.
The sizes of a family go from those that are solved in a moment to those that nobody has solved yet:
`smash best-known` keeps the list. Where most of a generation is proven, another one goes on from there, and the
earlier one stays as it is.
"""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from smash.problem.making import make_instance
from smash.problem.model import Goal, Instance, OnGoal, PositionsGoal, StacksGoal
from smash.problem.sets.generators import block_names, buffer_names, cut, stack_names


@dataclass(frozen=True, slots=True)
class Shape:
    """The size of a random instance and the kind of its goal.

    `listed` is the share of the blocks that a `positions` or `on` goal speaks of, `toppled` the share of the
    blocks that lie on the table at the start.
    """

    blocks: int
    stacks: int
    buffers: int
    kind: Literal["stacks", "positions", "on"] = "stacks"
    listed: float = 1.0
    toppled: float = 0.0


_FIRST: dict[str, tuple[Shape, ...]] = {
    "open-few-buffers": tuple(Shape(blocks, 3, buffers) for blocks in (12, 15, 20, 30) for buffers in (0, 1, 2)),
    "open-wide": tuple(
        Shape(blocks, stacks, 12)
        for blocks, stacks in ((15, 3), (25, 5), (50, 5), (50, 10), (100, 10), (200, 10), (200, 20), (500, 25))
    ),
    "open-on": tuple(
        Shape(blocks, stacks, 0, "on", listed)
        for blocks, stacks in ((15, 4), (30, 6), (60, 8), (120, 12))
        for listed in (0.5, 1.0)
    ),
    "open-positions": tuple(
        Shape(blocks, 4, buffers, "positions", 0.4, toppled)
        for blocks in (15, 30, 60)
        for buffers, toppled in ((1, 0.0), (4, 0.3))
    ),
    "open-short-stacks": (
        *(Shape(blocks, blocks // 3, 0, "on", listed) for blocks in (30, 45, 60, 120) for listed in (0.3, 0.5)),
        *(Shape(blocks, 2 * blocks // 5, 0) for blocks in (100, 200, 300, 500)),
    ),
}
_HARDER: dict[str, tuple[Shape, ...]] = {
    "open-few-buffers-2": tuple(Shape(blocks, 3, buffers) for blocks, buffers in ((18, 0), (24, 1), (26, 2), (40, 2))),
    "open-wide-2": tuple(Shape(blocks, stacks, 12) for blocks, stacks in ((200, 8), (300, 15), (700, 35), (1000, 50))),
    "open-on-2": tuple(
        Shape(blocks, stacks, 0, "on", listed)
        for blocks, stacks, listed in ((60, 10, 1.0), (90, 10, 1.0), (200, 16, 0.5), (200, 16, 1.0))
    ),
    "open-positions-2": tuple(
        Shape(blocks, 4, buffers, "positions", 0.4, toppled)
        for blocks, buffers, toppled in ((34, 1, 0.0), (50, 1, 0.0), (100, 4, 0.3), (200, 4, 0.3))
    ),
    "open-short-stacks-2": (
        *(Shape(blocks, blocks // 3, 0, "on", 0.5) for blocks in (200, 400)),
        *(Shape(blocks, 2 * blocks // 5, 0) for blocks in (700, 1000)),
    ),
}

GENERATIONS: dict[str, dict[str, tuple[Shape, ...]]] = {"first": _FIRST, "harder": _HARDER}
"""Name of a generation of sets -> its sets, as `FAMILIES` has them."""

FAMILIES: dict[str, tuple[Shape, ...]] = _FIRST | _HARDER
"""Set name -> the shapes of its instances, in the order of their numbers."""


def open_set(name: str, seed: int) -> Iterator[Instance]:
    """Yield the instances of an open set; equal arguments give equal instances."""
    for index, shape in enumerate(FAMILIES[name]):
        yield draw_instance(f"{name}-{index:02}", shape, random.Random(f"{name}/{seed}/{index}"))


def draw_instance(name: str, shape: Shape, draw: random.Random) -> Instance:
    """Draw an instance of a shape: uniform permutations, cut into stacks at uniform places."""
    blocks = block_names(shape.blocks)
    stacks = stack_names(shape.stacks)
    order = draw.sample(blocks, len(blocks))
    toppled = round(shape.toppled * len(order))
    table, standing = order[:toppled], order[toppled:]
    return make_instance(
        name=name,
        blocks=blocks,
        stacks=stacks,
        buffers=buffer_names(shape.buffers),
        start=dict(zip(stacks, cut(standing, len(stacks), draw), strict=True)),
        table=sorted(table),
        goal=_draw_goal(shape, blocks, stacks, draw),
    )


def _draw_goal(shape: Shape, blocks: Sequence[str], stacks: Sequence[str], draw: random.Random) -> Goal:
    listed = draw.sample(blocks, max(len(stacks), round(shape.listed * len(blocks))))
    piles = cut(listed, len(stacks), draw)
    match shape.kind:
        case "stacks":
            return StacksGoal({stack: tuple(pile) for stack, pile in zip(stacks, piles, strict=True)})
        case "positions":
            return PositionsGoal(
                {
                    block: (stack, height)
                    for stack, pile in zip(stacks, piles, strict=True)
                    for height, block in enumerate(pile, start=1)
                }
            )
        case "on":
            on = {upper: under for pile in piles for under, upper in itertools.pairwise(pile)}
            return OnGoal(on, tuple(pile[0] for pile in piles[::2]))
