"""Which problems have a plan at all: decided from start and goal, without a search (`docs/theory.md`, "Solvable").

With topple everything can be brought to the table region and built up from there, so that a plan exists
unless an `on` goal wants more bottoms than there are locations. Without topple three locations reach every
arrangement; two locations are one line of blocks with a movable gap (first location upward, then the second
downward), whose order never changes, and one location is a pile on which blocks of the table region can only be put.
Blocks on a carrier that must not be carried are as loose as those of the table region.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from smash.problem.model import Instance, OnGoal, PositionsGoal, StacksGoal
from smash.problem.rules import Law

Pile = tuple[str, ...]
ENOUGH_LOCATIONS = 3
"""With so many locations pick and place alone reaches every arrangement."""


def why_infeasible(law: Law) -> str | None:
    """Return in one line why no plan exists, or None where one does.

    The answer is exact, but for instances with further aggregating actions: there None promises nothing.
    A cap on the blocks of a topple makes no difference. `Problem.infeasible` keeps the answer.
    """
    instance, goal = law.instance, law.instance.goal
    locations = len(instance.locations)
    if isinstance(goal, OnGoal) and len(goal.bottom) > locations:
        return f"the goal wants {len(goal.bottom)} blocks at the bottom of a location, there are {locations} locations"
    if law.kinds or locations >= ENOUGH_LOCATIONS:
        return None
    if isinstance(goal, OnGoal):
        reachable = any(_towers_fit(instance, goal, piles) for piles in _splits(instance))
    else:
        reachable = _piles_fit(instance, _goal_piles(instance, goal))
    if reachable:
        return None
    if locations == 1:
        return "without topple, one location's blocks never change their order, and the goal changes it"
    return "without topple, two locations keep the order of their blocks read as one line, and the goal changes it"


def _goal_piles(instance: Instance, goal: StacksGoal | PositionsGoal) -> list[Pile]:
    """Return the listed blocks of every location, bottom first."""
    piles = goal.stacks if isinstance(goal, StacksGoal) else goal.stacks()
    return [tuple(piles.get(location, ())) for location in instance.locations]


def _piles_fit(instance: Instance, wanted: list[Pile]) -> bool:
    """Whether one or two locations can hold the listed blocks at their heights, the rest anywhere."""
    loose = frozenset(instance.table).union(*(carrier.holds for carrier in instance.carriers))
    starts = [instance.start[location] for location in instance.locations]
    if len(starts) == 1:
        common = min(len(starts[0]), len(wanted[0]))
        return starts[0][:common] == wanted[0][:common]
    line = starts[0] + starts[1][::-1]
    left = tuple(block for block in wanted[0] if block not in loose)
    right = tuple(block for block in reversed(wanted[1]) if block not in loose)
    return line[: len(left)] == left and line[len(line) - len(right) :] == right


def _splits(instance: Instance) -> Iterator[list[Pile]]:
    """Yield the arrangements of the standing blocks that one or two locations can take."""
    starts = [instance.start[location] for location in instance.locations]
    if len(starts) == 1:
        yield starts
        return
    line = starts[0] + starts[1][::-1]
    for gap in range(len(line) + 1):
        yield [line[:gap], line[gap:][::-1]]


def _towers_fit(instance: Instance, goal: OnGoal, piles: Sequence[Pile]) -> bool:
    """Whether inserting blocks of the table region into `piles` can make every tower of an `on` goal.

    With two piles a block can be inserted at any height (the gap moves there), with one only on top.
    """
    place = {block: (number, height) for number, pile in enumerate(piles) for height, block in enumerate(pile)}
    open_bottoms = set(range(len(piles))) if len(piles) > 1 or not piles[0] else set()
    to_insert = 0
    for tower in goal.towers():
        standing = [place[block] for block in tower if block in place]
        if any(upper != (lower[0], lower[1] + 1) for lower, upper in itertools.pairwise(standing)):
            return False
        if len(piles) == 1 and standing and not _continues_on_top(tower, place, len(piles[0])):
            return False
        if tower[0] not in goal.bottom:
            continue
        if not standing:
            to_insert += 1
            continue
        number, height = standing[0]
        if height > 0:
            return False
        open_bottoms.discard(number)
    return to_insert <= len(open_bottoms)


def _continues_on_top(tower: Pile, place: dict[str, tuple[int, int]], height: int) -> bool:
    """Whether the blocks of `tower` that are still to be put follow the standing ones, on top of the only pile."""
    standing = sum(block in place for block in tower)
    if any(block not in place for block in tower[:standing]):
        return False
    return standing == len(tower) or place[tower[standing - 1]][1] == height - 1
