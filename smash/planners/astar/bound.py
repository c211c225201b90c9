"""An admissible bound on the cost from a state, read off the precedence graph of its blocks (compiled).

Every listed block that is not right for good, and all above it, must be moved: 2 each. What must leave and is
not listed costs 2 each, or a topple. Then a relaxed run moves whatever could go straight to its place; where
it is stuck, each pile's top waits for the top of another pile (or of its own) to leave first: following this
ends in cycles. The blocks of one cycle cannot all move straight: one is put aside (2 more), or one of their
piles is toppled (1 more). Cycles counted share no block (with topple: no pile), so their costs add up.
"""

from __future__ import annotations

from smash.planners.astar.state import line_size
from smash.planners.astar.task import Ints, Task

IN_CYCLE = -1


def lower_bound(task: Task, cells: Ints) -> int:
    """Return a bound on the cost of reaching the goal from the settled state in hand."""
    blocks = task.blocks
    cost = 0
    for block in range(blocks):
        cells[task.loose + block] = 1 if cells[task.slot_of + block] < 0 else 0
        if cells[task.slot_of + block] < 0 and cells[task.line_of + block] >= 0:
            cost += 2
    for line in range(task.lines):
        cells[task.built + line] = cells[task.done + line]
    for slot in range(cells[task.counters]):
        cells[task.left + slot] = cells[task.length + slot]
        for level in range(cells[task.keep + slot], cells[task.length + slot]):
            if cells[task.line_of + cells[task.content + slot * blocks + level]] >= 0:
                cost += 2
        cost += _forced(task, cells, slot)
    while True:
        _run(task, cells)
        cycles = _break_cycles(task, cells)
        if cycles == 0:
            return cost
        cost += cycles


def _forced(task: Task, cells: Ints, slot: int) -> int:
    """Return what a pile costs beyond 2 per listed block, whatever the others do; mark its blocks as loose.

    A block is forced aside if under it, in its own pile, lies one that must be placed before it, or if its
    line stands in this very pile.
    """
    base = slot * task.blocks
    topples = task.topple == 1 and cells[task.class_topple + cells[task.kind + slot]] == 1
    cost = 0
    for line in range(task.lines):
        cells[task.lowest + line] = task.blocks
    for level in range(cells[task.keep + slot], cells[task.length + slot]):
        block = cells[task.content + base + level]
        line = cells[task.line_of + block]
        forced = line < 0
        if line >= 0:
            forced = cells[task.anchor + line] == slot or cells[task.lowest + line] < cells[task.index_of + block]
            if cells[task.index_of + block] < cells[task.lowest + line]:
                cells[task.lowest + line] = cells[task.index_of + block]
        if forced:
            cells[task.loose + block] = 1
            cost += 2
    if not topples or cost == 0:
        return cost
    cost = 0
    level = cells[task.length + slot] - 1
    while level >= cells[task.keep + slot]:
        if cells[task.loose + cells[task.content + base + level]] == 1:
            cost += 1
            level -= task.cap
        else:
            level -= 1
    _empty(task, cells, slot)
    return cost


def _empty(task: Task, cells: Ints, slot: int) -> None:
    """Let go of all that must leave a pile."""
    for level in range(cells[task.keep + slot], cells[task.length + slot]):
        cells[task.loose + cells[task.content + slot * task.blocks + level]] = 1
    if cells[task.left + slot] > cells[task.keep + slot]:
        cells[task.left + slot] = cells[task.keep + slot]


def _run(task: Task, cells: Ints) -> None:
    """Take off what is loose and place what can go straight, until nothing changes."""
    moved = True
    while moved:
        moved = False
        for slot in range(cells[task.counters]):
            while (
                cells[task.left + slot] > cells[task.keep + slot] and cells[task.loose + _top(task, cells, slot)] == 1
            ):
                cells[task.left + slot] -= 1
        for line in range(task.lines):
            first = cells[task.line_first + line]
            size = line_size(task, cells, line)
            while cells[task.built + line] < size and _place_loose(
                task, cells, line, cells[task.line_blocks + first + cells[task.built + line]]
            ):
                moved = True


def _top(task: Task, cells: Ints, slot: int) -> int:
    return cells[task.content + slot * task.blocks + cells[task.left + slot] - 1]


def _place_loose(task: Task, cells: Ints, line: int, block: int) -> bool:
    """Place the next block of a line in the relaxed run, if it can be taken and its place is clear."""
    anchor = cells[task.anchor + line]
    if anchor >= 0 and cells[task.left + anchor] > cells[task.clear_at + line]:
        return False
    slot = cells[task.slot_of + block]
    if slot >= 0 and cells[task.left + slot] > cells[task.keep + slot] and _top(task, cells, slot) == block:
        cells[task.left + slot] -= 1
        cells[task.loose + block] = 1
    if cells[task.loose + block] == 0 or (slot >= 0 and _covered(task, cells, block, slot)):
        return False
    cells[task.built + line] += 1
    return True


def _covered(task: Task, cells: Ints, block: int, slot: int) -> bool:
    """Return whether `block` still lies in its pile in the relaxed run."""
    for level in range(cells[task.keep + slot], cells[task.left + slot]):
        if cells[task.content + slot * task.blocks + level] == block:
            return True
    return False


def _waits_for(task: Task, cells: Ints, slot: int) -> int:
    """Return the slot whose top must leave before the top of `slot` can be placed; -1 where none is left to."""
    line = cells[task.line_of + _top(task, cells, slot)]
    anchor = cells[task.anchor + line]
    if anchor >= 0 and cells[task.left + anchor] > cells[task.clear_at + line]:
        return anchor
    needed = cells[task.line_blocks + cells[task.line_first + line] + cells[task.built + line]]
    return cells[task.slot_of + needed]


def _break_cycles(task: Task, cells: Ints) -> int:
    """Count the cycles of the waiting tops, let go of them, and return what they cost at least.

    All are found before any is let go of: a top whose wait is over no longer tells of a cycle.
    """
    slots = cells[task.counters]
    for slot in range(slots):
        cells[task.mark + slot] = 0
    cost = 0
    for start in range(slots):
        slot = start
        while slot >= 0 and cells[task.mark + slot] == 0 and cells[task.left + slot] > cells[task.keep + slot]:
            cells[task.mark + slot] = start + 1
            slot = _waits_for(task, cells, slot)
        if slot >= 0 and cells[task.mark + slot] == start + 1:
            cost += _mark_cycle(task, cells, slot)
    for slot in range(slots):
        if cells[task.mark + slot] == IN_CYCLE:
            if task.topple == 1:
                _empty(task, cells, slot)
            else:
                cells[task.loose + _top(task, cells, slot)] = 1
    return cost


def _mark_cycle(task: Task, cells: Ints, start: int) -> int:
    """Mark the piles of a cycle of tops; return 1 where a topple of one of them can break it, else 2."""
    slot = start
    cost = 2
    while cells[task.mark + slot] != IN_CYCLE:
        cells[task.mark + slot] = IN_CYCLE
        if task.topple == 1 and cells[task.class_topple + cells[task.kind + slot]] == 1:
            cost = 1
        slot = _waits_for(task, cells, slot)
    return cost
