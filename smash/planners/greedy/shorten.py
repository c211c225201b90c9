"""Take needless put-asides out of a plan: two transfers of a block become one, where the law still allows all else."""

from __future__ import annotations

import math
from collections.abc import Sequence
from time import perf_counter

from smash.problem.views.numbered import ON_TABLE, TOPPLE, Step

SPAN = 4000
"""The farthest apart two transfers of a block may be to be looked at, in steps: keeps the time near-linear."""


def shorten(steps: Sequence[Step], deadline: float = math.inf) -> list[Step]:
    """Return a plan with the same end that is never longer; what is done by `deadline` [s, `perf_counter`].

    A block that goes A to B and later B to C can go A to C at one moment between, if A is untouched under
    it until then (what lands on it leaves again), and C from then on.
    """
    current = list(steps)
    while True:
        shorter = _one_pass(current, deadline)
        if len(shorter) == len(current):
            return current
        current = shorter


def _one_pass(steps: list[Step], deadline: float) -> list[Step]:
    current: list[Step | None] = list(steps)
    last: dict[int, int] = {}
    for index, step in enumerate(steps):
        block, source, target = step
        if block == TOPPLE:
            continue
        before = last.get(block)
        last[block] = index
        earlier = None if before is None else current[before]
        if before is None or earlier is None or earlier[2] != source or index - before > SPAN:
            continue
        if perf_counter() > deadline:
            break
        moment = _moment(current, before, index, earlier[1], target)
        if moment is not None:
            _join(current, before, index, moment, last)
    return [step for step in current if step is not None]


def _moment(steps: Sequence[Step | None], before: int, after: int, source: int, target: int) -> int | None:
    """Return the index after whose step the block can go straight from `source` to `target`, or None."""
    ready: list[int] = []
    height = 0
    for index in range(before, after):
        if index > before and source != ON_TABLE:
            height += _growth(steps[index], source)
        if height < 0:
            break
        if height == 0:
            ready.append(index)
    height = 0
    for index in range(after - 1, before - 1, -1):
        if height == 0:
            while ready and ready[-1] > index:
                ready.pop()
            if ready and ready[-1] == index:
                return index
        height -= _growth(steps[index], target)
        if height < 0:
            return None
    return None


def _growth(step: Step | None, location: int) -> int:
    """Return by how many blocks a step makes the pile at `location` grow."""
    if step is None:
        return 0
    block, second, third = step
    if block == TOPPLE:
        return -third if second == location else 0
    return (third == location) - (second == location)


def _join(steps: list[Step | None], before: int, after: int, moment: int, last: dict[int, int]) -> None:
    """Put one transfer after the step at `moment` in place of those at `before` and `after`; keep `last` right."""
    first, second = steps[before], steps[after]
    assert first is not None
    assert second is not None
    direct: Step | None = (first[0], first[1], second[2]) if first[1] != second[2] else None
    steps[before:after] = [*steps[before + 1 : moment + 1], direct, *steps[moment + 1 : after]]
    steps[after] = None
    for index in range(before, moment):
        step = steps[index]
        if step is not None and step[0] != TOPPLE and last.get(step[0]) == index + 1:
            last[step[0]] = index
    if direct is None:
        del last[first[0]]
    else:
        last[first[0]] = moment
