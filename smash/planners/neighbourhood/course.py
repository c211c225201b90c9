"""A plan with the states that it passes through: as steps, cut and joined."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field

from smash.problem.actions.topple import Topple
from smash.problem.model import TABLE, Action, Pick, Place
from smash.problem.views.numbered import ON_TABLE, TOPPLE, Numbered, Step


@dataclass(slots=True)
class Arrangement:
    """Where the blocks are: `piles[q]` at location q, bottom first, and those in the table region."""

    piles: list[list[int]]
    table: set[int] = field(default_factory=set)

    @classmethod
    def start_of(cls, problem: Numbered) -> Arrangement:
        """Return where they are at the start."""
        return cls([list(pile) for pile in problem.start], set(problem.table))

    def copy(self) -> Arrangement:
        """Return another one of the same."""
        return Arrangement([list(pile) for pile in self.piles], set(self.table))

    def take(self, step: Step) -> None:
        """Take a legal step."""
        first, second, third = step
        if first == TOPPLE:
            pile = self.piles[second]
            self.table.update(pile[len(pile) - third :])
            del pile[len(pile) - third :]
            return
        if second == ON_TABLE:
            self.table.remove(first)
        else:
            self.piles[second].pop()
        self.piles[third].append(first)


def arrangement_after(problem: Numbered, steps: Sequence[Step]) -> Arrangement:
    """Return where the blocks are after legal steps from the start."""
    arrangement = Arrangement.start_of(problem)
    for step in steps:
        arrangement.take(step)
    return arrangement


def steps_of(problem: Numbered, actions: Sequence[Action]) -> list[Step]:
    """Return a legal plan of picks, places and topples as steps; a block that is put back where it was makes none.

    Args:
        problem: the numbered instance, of an empty hand.
        actions: the plan.

    Raises:
        ValueError: where it has another action.
    """
    number = {location: index for index, location in enumerate(problem.instance.locations)}
    heights = [len(pile) for pile in problem.start]
    steps: list[Step] = []
    source = ON_TABLE
    for action in actions:
        match action:
            case Pick():
                source = ON_TABLE if action.source == TABLE else number[action.source]
            case Place():
                target = number[action.target]
                if source != target:
                    steps.append((problem.block_number[action.block], source, target))
                    heights[target] += 1
                    if source != ON_TABLE:
                        heights[source] -= 1
            case Topple():
                location = number[action.location]
                falling = heights[location] - action.height + 1
                heights[location] -= falling
                steps.append((TOPPLE, location, falling))
            case _:
                raise ValueError(f"{action} is no pick, place or topple")
    return steps


def without_detours(problem: Numbered, steps: Sequence[Step], class_of: Sequence[int], seed: int = 0) -> list[Step]:
    """Return a plan without what lies between two equal arrangements, the later steps at the locations of the earlier.

    Arrangements are equal where they differ by the names of locations of one class only. Takes a time linear in the
    number of blocks that move.

    Args:
        problem: the numbered instance.
        steps: a legal plan.
        class_of: per location the number of its class: nothing tells those of one class apart, the goal included.
        seed: for the keys by which arrangements are compared; two that are not equal have the same one by a chance of
            the order of 1 in 10^15.
    """
    draw = random.Random(seed)
    keys: dict[tuple[int, int], int] = {}

    def key(block: int, below: int) -> int:
        """Return what a block on another, or on the floor of a class (`-2 - class`), adds to the sum."""
        if (block, below) not in keys:
            keys[block, below] = draw.getrandbits(64)
        return keys[block, below]

    arrangement = Arrangement.start_of(problem)

    def below(location: int) -> int:
        pile = arrangement.piles[location]
        return pile[-2] if len(pile) > 1 else -2 - class_of[location]

    total = 0
    sums = [0]
    for step in steps:
        first, second, third = step
        if first == TOPPLE:
            for _ in range(third):
                pile = arrangement.piles[second]
                total -= key(pile[-1], below(second)) - key(pile[-1], ON_TABLE)
                arrangement.table.add(pile.pop())
        else:
            total -= key(first, ON_TABLE if second == ON_TABLE else below(second))
            arrangement.take(step)
            total += key(first, below(third))
        sums.append(total)
    last = {value: index for index, value in enumerate(sums)}
    kept: list[Step] = []
    names = list(range(len(class_of)))  # of the locations in the rest of the plan
    at = 0
    while at < len(steps):
        if last[sums[at]] > at:
            names = _renamed(problem, kept, steps[: last[sums[at]]], class_of)
            at = last[sums[at]]
            continue
        first, second, third = steps[at]
        if first == TOPPLE:
            kept.append((first, names[second], third))
        else:
            kept.append((first, ON_TABLE if second == ON_TABLE else names[second], names[third]))
        at += 1
    return kept


def _renamed(problem: Numbered, kept: Sequence[Step], left: Sequence[Step], class_of: Sequence[int]) -> list[int]:
    """Return per location after `left` the one that is in its place after `kept`."""
    here, there = arrangement_after(problem, kept).piles, arrangement_after(problem, left).piles
    at = {pile[0]: location for location, pile in enumerate(here) if pile}
    empty: dict[int, list[int]] = {}
    for location in range(len(here) - 1, -1, -1):
        if not here[location]:
            empty.setdefault(class_of[location], []).append(location)
    names = [at[pile[0]] if pile else -1 for pile in there]
    for location, pile in enumerate(there):
        if not pile and location in empty.get(class_of[location], ()):
            names[location] = location
            empty[class_of[location]].remove(location)
    return [name if name >= 0 else empty[class_of[location]].pop() for location, name in enumerate(names)]
