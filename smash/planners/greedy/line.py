"""Pick and place with at most two locations: one line of blocks and a cursor in it.

Read the first location upward and then the second downward: a transfer moves the cursor between them by one
block and changes nothing else, and a block from the table region enters the line at the cursor. So what can be
reached is decided by looking: the blocks of the start line keep their order for ever. (With three locations or
more every arrangement can be reached; with topple too.)
"""

from __future__ import annotations

from collections.abc import Sequence

from smash.problem.ends import tower_ends
from smash.problem.model import OnGoal
from smash.problem.views.numbered import ON_TABLE, Numbered, Step
from smash.problem.views.targets import Piles, goal_piles


def line_steps(problem: Numbered) -> list[Step] | None:
    """Return steps that reach the goal without topple on one or two locations, or None where there are none.

    Raises:
        ValueError: with more than two locations.
    """
    if problem.locations > 2:
        raise ValueError("a line has one or two locations")
    start = [list(pile) for pile in (*problem.start, ())[:2]]
    line = start[0] + start[1][::-1]
    cuts = range(len(line) + 1) if problem.locations == 2 else [len(line)]
    plans = []
    for cut in sorted(cuts, key=lambda cut: abs(cut - len(start[0]))):
        ends = _ends(problem, line, cut)
        if ends is None or (problem.locations == 1 and list(ends[0][: len(line)]) != line):
            continue
        plans += [_swept(start, ends, first) for first in (0, 1)[: problem.locations]]
        if len(plans) >= _ENOUGH:
            break
    return min(plans, key=len, default=None)


_ENOUGH = 8
"""Plans compared before the shortest is taken."""


def _ends(problem: Numbered, line: Sequence[int], cut: int) -> Piles | None:
    """Return both final piles if the start line is cut after `cut` blocks, or None where no goal state is cut so."""
    piles = (list(line[:cut]), list(line[cut:])[::-1])
    wanted = goal_piles(problem)
    if wanted is None:
        return _tower_ends(problem, piles)
    table = set(problem.table)
    finals = [_with_prefix(pile, want, table) for pile, want in zip(piles, (*wanted, ())[:2], strict=True)]
    if any(final is None for final in finals):
        return None
    return tuple(tuple(final) for final in finals if final is not None)


def _with_prefix(pile: list[int], want: Sequence[int], table: set[int]) -> list[int] | None:
    """Return `pile` with table blocks put in so that it begins with `want`, or None."""
    staying = iter(pile)
    for block in want:
        if block not in table and next(staying, None) != block:
            return None
    return [*want, *staying]


def _tower_ends(problem: Numbered, piles: tuple[list[int], list[int]]) -> Piles | None:
    """Return both final piles of an `on` goal: towers completed from the table, or None."""
    goal, names, number = problem.instance.goal, problem.instance.blocks, problem.block_number
    assert isinstance(goal, OnGoal)
    ends = tower_ends(goal, [tuple(names[block] for block in pile) for pile in piles[: problem.locations]])
    return None if ends is None else tuple(tuple(number[block] for block in end) for end in (*ends, ())[:2])


def _swept(start: Sequence[Sequence[int]], ends: Piles, first: int) -> list[Step]:
    """Return steps from `start` to `ends`: one sweep of the cursor that puts in the table blocks on its way.

    Args:
        start: the two piles.
        ends: the two final piles, whose line holds the start line in its order.
        first: the location that is emptied first, as far as there is a block to put in.
    """
    left, right = list(start[first]), list(start[1 - first])
    here, there = first, 1 - first
    final = [*ends[first], *ends[there][::-1]]
    known = {*left, *right}
    added = [position for position, block in enumerate(final) if block not in known]
    steps: list[Step] = []

    def shift(source: list[int], target: list[int], numbers: tuple[int, int]) -> None:
        target.append(source.pop())
        steps.append((target[-1], *numbers))

    if added:
        kept = sum(block in known for block in final[: added[0]])
        while len(left) > kept:
            shift(left, right, (here, there))
        while len(left) <= added[-1]:
            if right and right[-1] == final[len(left)]:
                shift(right, left, (there, here))
            else:
                left.append(final[len(left)])
                steps.append((left[-1], ON_TABLE, here))
    while len(left) > len(ends[first]):
        shift(left, right, (here, there))
    while len(left) < len(ends[first]):
        shift(right, left, (there, here))
    return steps
