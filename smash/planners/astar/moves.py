"""The moves worth trying from a settled state (compiled).

What is left out, and why no optimum is lost (tested against exhaustive search):

- what is right for good never moves, and where `tidy` a direct move is never one of several (`settle`);
- a block of the table region moves only to where the goal may want it: any other move could be dropped;
- with topple, the same holds for the blocks of a location that can be toppled: toppling one block alone is
  cheaper than putting it aside; and a topple takes all that must leave, up to the cap, for that is free.
"""

from __future__ import annotations

from smash.planners.astar.state import accessible, top_of
from smash.planners.astar.task import TOPPLED, Ints, Task


def list_moves(task: Task, cells: Ints) -> int:
    """Write the moves to try into `moves`, as pairs (block, code), and return their number."""
    cells[task.listed] = 0
    for slot in range(cells[task.counters]):
        if cells[task.length + slot] == 0 or (task.tidy == 1 and cells[task.length + slot] == cells[task.keep + slot]):
            continue
        top = top_of(task, cells, slot)
        if task.topple == 1 and cells[task.class_topple + cells[task.kind + slot]] == 1:
            _topples(task, cells, slot)
            if task.tidy == 0:
                _final_moves(task, cells, top)
        else:
            _all_moves(task, cells, top, slot)
    if task.tidy == 0:
        for block in range(task.blocks):
            if cells[task.slot_of + block] < 0:
                _final_moves(task, cells, block)
    return cells[task.listed]


def _add(task: Task, cells: Ints, block: int, code: int) -> None:
    count = cells[task.listed]
    cells[task.moves + 2 * count] = block
    cells[task.moves + 2 * count + 1] = code
    cells[task.listed] = count + 1


def _topples(task: Task, cells: Ints, slot: int) -> None:
    length = cells[task.length + slot]
    base = slot * task.blocks
    if task.tidy == 1:
        fewest = most = min(task.cap, length - cells[task.keep + slot])
    else:
        fewest, most = 1, min(task.cap, length)
    for falling in range(fewest, most + 1):
        _add(task, cells, cells[task.content + base + length - falling], TOPPLED)


def _floors(task: Task, cells: Ints, block: int, slot: int) -> None:
    """Add a move to a floor of each class that has a free one; to another of its own class only from higher up."""
    for number in range(task.classes):
        if cells[task.class_used + number] == cells[task.class_size + number]:
            continue
        if slot >= 0 and cells[task.length + slot] == 1 and cells[task.kind + slot] == number:
            continue
        _add(task, cells, block, task.blocks + number)


def _all_moves(task: Task, cells: Ints, block: int, slot: int) -> None:
    """Add the moves of `block` to every other location."""
    _floors(task, cells, block, slot)
    for other in range(cells[task.counters]):
        if other != slot and cells[task.length + other] > 0:
            _add(task, cells, block, top_of(task, cells, other))


def _final_moves(task: Task, cells: Ints, block: int) -> None:
    """Add the moves of `block` to where its `on` goal may want it."""
    line = cells[task.line_of + block]
    if line < 0:
        return
    slot = cells[task.slot_of + block]
    index = cells[task.index_of + block]
    if index > 0:
        under = cells[task.line_blocks + cells[task.line_first + line] + index - 1]
        if cells[task.slot_of + under] >= 0 and accessible(task, cells, under):
            _add(task, cells, block, under)
    elif cells[task.line_grounded + line] == 1:
        _floors(task, cells, block, slot)
    else:
        _all_moves(task, cells, block, slot)
