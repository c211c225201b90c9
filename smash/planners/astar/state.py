"""States taken apart and put together; what is right for good; direct moves (compiled, see `compiled`)."""

from __future__ import annotations

from smash.planners.astar.task import BYTE, TOPPLED, Ints, Task


def unpack(task: Task, cells: Ints, rows: Ints, offset: int) -> None:
    """Take the filed state at `rows[offset:]` apart into piles."""
    blocks = task.blocks
    wide = task.width > 1
    table = blocks + task.classes
    fixed = 0 if task.anywhere else task.lines
    for line in range(fixed):
        cells[task.length + line] = 0
        cells[task.kind + line] = cells[task.line_class + line]
    for number in range(task.classes):
        cells[task.class_used + number] = 0
    for block in range(blocks):
        cells[task.above + block] = -1
        cells[task.slot_of + block] = -1
    for block in range(blocks):
        below = _below(task, rows, offset + block) if wide else rows[offset + block]
        if below < blocks:
            cells[task.above + below] = block
    used = fixed
    for base in range(blocks):
        below = _below(task, rows, offset + base) if wide else rows[offset + base]
        if below < blocks or below == table:
            continue
        number = below - blocks
        cells[task.class_used + number] += 1
        slot = cells[task.class_line + number]
        if slot < 0:
            slot = used
            used += 1
            cells[task.kind + slot] = number
        level = 0
        block = base
        while block >= 0:
            cells[task.content + slot * blocks + level] = block
            cells[task.slot_of + block] = slot
            level += 1
            block = cells[task.above + block]
        cells[task.length + slot] = level
    cells[task.counters] = used


def _below(task: Task, rows: Ints, place: int) -> int:
    """Return the number that is filed at `place`, the first of its bytes."""
    below = int(rows[place])
    for byte in range(1, task.width):
        below += int(rows[place + byte * task.blocks]) << (BYTE * byte)
    return below


def _file(task: Task, rows: Ints, place: int, below: int) -> None:
    for byte in range(task.width):
        rows[place + byte * task.blocks] = below >> (BYTE * byte) & 255


def pack(task: Task, cells: Ints, rows: Ints, offset: int) -> None:
    """File the state in hand at `rows[offset:]`."""
    blocks = task.blocks
    wide = task.width > 1
    table = blocks + task.classes
    for block in range(blocks):
        if wide:
            _file(task, rows, offset + block, table)
        else:
            rows[offset + block] = table
    for slot in range(cells[task.counters]):
        below = blocks + cells[task.kind + slot]
        for level in range(cells[task.length + slot]):
            block = cells[task.content + slot * blocks + level]
            if wide:
                _file(task, rows, offset + block, below)
            else:
                rows[offset + block] = below
            below = block


def take(task: Task, cells: Ints, block: int) -> None:
    """Take `block` from the top of its pile, or from the table region."""
    slot = cells[task.slot_of + block]
    if slot < 0:
        return
    cells[task.length + slot] -= 1
    cells[task.slot_of + block] = -1
    if cells[task.length + slot] == 0:
        cells[task.class_used + cells[task.kind + slot]] -= 1


def put(task: Task, cells: Ints, block: int, code: int) -> None:
    """Put `block` on the block `code`, or on the floor of a free location of the class `code - blocks`."""
    blocks = task.blocks
    if code < blocks:
        slot = cells[task.slot_of + code]
    else:
        number = code - blocks
        cells[task.class_used + number] += 1
        slot = cells[task.class_line + number]
        if slot < 0:
            slot = cells[task.counters]
            cells[task.counters] = slot + 1
            cells[task.kind + slot] = number
            cells[task.length + slot] = 0
    cells[task.content + slot * blocks + cells[task.length + slot]] = block
    cells[task.length + slot] += 1
    cells[task.slot_of + block] = slot


def apply_move(task: Task, cells: Ints, block: int, code: int) -> int:
    """Make a move of `moves` and return its cost: a transfer, or (`code` TOPPLED) all from `block` up fall."""
    if code != TOPPLED:
        take(task, cells, block)
        put(task, cells, block, code)
        return 2
    slot = cells[task.slot_of + block]
    top = -1
    while top != block:
        top = top_of(task, cells, slot)
        take(task, cells, top)
    return 1


def judge(task: Task, cells: Ints) -> None:
    """Find what is right for good: `keep` per slot; `done`, `anchor` and `clear_at` per line."""
    if task.anywhere:
        _judge_towers(task, cells)
        return
    for slot in range(cells[task.counters]):
        length = cells[task.length + slot]
        base = slot * task.blocks
        level = 0
        if slot < task.lines:
            size = line_size(task, cells, slot)
            wanted = task.line_blocks + cells[task.line_first + slot]
            while level < min(length, size) and cells[task.content + base + level] == cells[wanted + level]:
                level += 1
            cells[task.done + slot] = level
            cells[task.anchor + slot] = slot
            cells[task.clear_at + slot] = level
            if level < size:
                cells[task.keep + slot] = level
                continue
        while level < length and cells[task.line_of + cells[task.content + base + level]] < 0:
            level += 1
        cells[task.keep + slot] = level


def _judge_towers(task: Task, cells: Ints) -> None:
    for line in range(task.lines):
        cells[task.done + line] = 0
        cells[task.anchor + line] = -1
        cells[task.clear_at + line] = 0
    for slot in range(cells[task.counters]):
        base = slot * task.blocks
        level = 0
        under_line = -1
        under_waits = False
        covers = False
        while level < cells[task.length + slot]:
            block = cells[task.content + base + level]
            line = cells[task.line_of + block]
            if covers or (level > 0 and cells[task.on_table + block] == 1):
                break
            if line >= 0 and cells[task.index_of + block] > 0:
                if under_line != line or cells[task.done + line] != cells[task.index_of + block]:
                    break
            elif under_waits or (line >= 0 and level > 0 and cells[task.line_grounded + line]):
                break
            under_line = line
            under_waits = False
            covers = cells[task.clear + block] == 1
            level += 1
            if line >= 0:
                cells[task.done + line] = cells[task.index_of + block] + 1
                cells[task.anchor + line] = slot
                cells[task.clear_at + line] = level
                under_waits = cells[task.done + line] < line_size(task, cells, line)
        cells[task.keep + slot] = level


def line_size(task: Task, cells: Ints, line: int) -> int:
    """Return the number of blocks of a line."""
    return cells[task.line_first + line + 1] - cells[task.line_first + line]


def top_of(task: Task, cells: Ints, slot: int) -> int:
    """Return the top block of a slot's pile, which is not empty."""
    return cells[task.content + slot * task.blocks + cells[task.length + slot] - 1]


def is_goal(task: Task, cells: Ints) -> bool:
    """Return whether every line is built and nothing has to leave its pile (after `judge`)."""
    for line in range(task.lines):
        if cells[task.done + line] < line_size(task, cells, line):
            return False
    for slot in range(cells[task.counters]):  # noqa: SIM110 (numba compiles no generators)
        if cells[task.keep + slot] < cells[task.length + slot]:
            return False
    return True


def accessible(task: Task, cells: Ints, block: int) -> bool:
    """Return whether `block` can be picked: on top of its pile, or in the table region."""
    slot = cells[task.slot_of + block]
    return slot < 0 or top_of(task, cells, slot) == block


def free_floor(task: Task, cells: Ints) -> int:
    """Return the code of a free floor, of a location that can be toppled if there is one; -1 where all are taken."""
    found = -1
    for number in range(task.classes):
        if cells[task.class_used + number] < cells[task.class_size + number]:
            if cells[task.class_topple + number]:
                return task.blocks + number
            found = task.blocks + number
    return found


def settle(task: Task, cells: Ints) -> int:
    """Judge the state; where `tidy`, make every direct move into `trail` first. Return how many were made."""
    judge(task, cells)
    if not task.tidy:
        return 0
    count = 0
    before = -1
    while count != before:
        before = count
        for line in range(task.lines):
            first = cells[task.line_first + line]
            size = line_size(task, cells, line)
            while cells[task.done + line] < size:
                if not _place_next(task, cells, line, cells[task.line_blocks + first + cells[task.done + line]], count):
                    break
                count += 1
        if count != before:
            judge(task, cells)
    return count


def _place_next(task: Task, cells: Ints, line: int, block: int, count: int) -> bool:
    """Move the next block of a line straight to its place, if it is accessible and the place is clear."""
    slot = cells[task.anchor + line]
    if (slot >= 0 and cells[task.length + slot] != cells[task.clear_at + line]) or not accessible(task, cells, block):
        return False
    done = cells[task.done + line]
    if done > 0:
        code = cells[task.line_blocks + cells[task.line_first + line] + done - 1]
    elif task.anywhere:
        code = free_floor(task, cells)
    else:
        code = task.blocks + cells[task.line_class + line]
    if code < 0:
        return False
    take(task, cells, block)
    put(task, cells, block, code)
    cells[task.trail + 2 * count] = block
    cells[task.trail + 2 * count + 1] = code
    cells[task.done + line] = done + 1
    cells[task.anchor + line] = cells[task.slot_of + block]
    cells[task.clear_at + line] = cells[task.length + cells[task.slot_of + block]]
    return True
