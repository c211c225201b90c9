"""Additive pattern databases: what the blocks of a few sets cost by themselves (compiled, see `compiled`).

Without topple a transfer moves one block, and leaving blocks out of a plan leaves a plan for the rest. So the fewest
transfers of the blocks of disjoint sets, each set by itself, add up to a bound. A pattern's table holds them for every
arrangement of its blocks; in those of the goal the blocks that it lists are the lowest, each in its place, and others
lie anywhere above. An arrangement's *number* is that of its order (bottom first, location after location) times the
ways of cutting the order into piles, and the number of the way.

A layout is a sequence of numbers: how many patterns and locations there are; then per pattern five entries (`SIZE` and
following); then what those point to. Patterns of one sum stand side by side.
"""

from __future__ import annotations

from smash.planners.astar.task import Ints, Task

PATTERNS, PLACES, FIRST = range(3)
"""Entries of a layout: the number of patterns, of locations, and the first pattern's."""
SIZE, TABLE, SUM, CUTS, NUMBERING = range(5)
"""Entries of a pattern: its blocks; where its table begins in `tables`; the sum that it is a part of; where the numbers
of the ways of cutting begin in the layout; where the numbers of its blocks begin there (-1: a block of others)."""
ENTRIES = 5
UNKNOWN = 255
"""In a table: not reached yet."""


def pattern_bound(task: Task, cells: Ints, layout: Ints, tables: Ints) -> int:
    """Return a bound on the cost of reaching the goal from the state in hand; 0 where the layout has no pattern."""
    most = total = 0
    current = 0
    for pattern in range(layout[PATTERNS]):
        header = FIRST + ENTRIES * pattern
        if layout[header + SUM] != current:
            current = layout[header + SUM]
            most = max(most, total)
            total = 0
        total += tables[layout[header + TABLE] + _number_in_hand(task, cells, layout, header)]
    return 2 * max(most, total)


def _number_in_hand(task: Task, cells: Ints, layout: Ints, header: int) -> int:
    """Return the number of a pattern's arrangement in the state in hand."""
    size = layout[header + SIZE]
    numbering = layout[header + NUMBERING]
    places = layout[PLACES]
    order = cut = met = used = place = 0
    for slot in range(cells[task.counters]):
        if slot >= task.lines and cells[task.length + slot] == 0:
            continue
        before = met
        base = slot * task.blocks
        for level in range(cells[task.length + slot]):
            number = layout[numbering + cells[task.content + base + level]]
            if number >= 0:
                order = order * (size - met) + number - _bits(used & ((1 << number) - 1))
                used |= 1 << number
                met += 1
        if place < places - 1:
            cut = cut * (size + 1) + met - before
        place += 1
    while place < places - 1:
        cut *= size + 1
        place += 1
    ways = layout[layout[header + CUTS]]
    return order * ways + layout[layout[header + CUTS] + 1 + cut]


def _bits(number: int) -> int:
    """Return how many bits of a number are set."""
    count = 0
    while number:
        number &= number - 1
        count += 1
    return count


def mark_goals(
    size: int, places: int, ways: Ints, cuts: Ints, wanted: Ints, table: Ints, work: Ints, begin: int, end: int
) -> int:
    """Set the arrangements of `begin .. end-1` that reach the goal to 0 transfers; return how many there are.

    Args:
        size: blocks of the pattern.
        places: locations.
        ways: per way of cutting the heights of all piles.
        cuts: the number of ways, and what `spread` reads.
        wanted: per location how many blocks of the pattern the goal lists there; then those, bottom first.
        table: of the pattern.
        work: scratch for two orders and the heights.
        begin: the first arrangement to look at.
        end: the one after the last.
    """
    found = 0
    for number in range(begin, end):
        _arrange(size, places, ways, number // cuts[0], number % cuts[0], work)
        bottom = 0
        listed = places
        right = True
        for place in range(places):
            if work[2 * size + place] < wanted[place]:
                right = False
                break
            for level in range(wanted[place]):
                right = right and work[bottom + level] == wanted[listed + level]
            bottom += work[2 * size + place]
            listed += wanted[place]
        if right:
            table[number] = 0
            found += 1
    return found


def spread(
    size: int, places: int, ways: Ints, cuts: Ints, table: Ints, work: Ints, depth: int, begin: int, end: int
) -> int:
    """Reach what lies one transfer from the arrangements `begin .. end-1` at `depth`; return how many were new.

    Args:
        size: blocks of the pattern.
        places: locations.
        ways: per way of cutting the heights of all piles.
        cuts: the number of ways, then per combination of heights (but the last) the number of its way.
        table: of the pattern.
        work: scratch for two orders and the heights.
        depth: the fewest transfers from the goal.
        begin: the first arrangement to look at.
        end: the one after the last.
    """
    found = 0
    count = cuts[0]
    heights = 2 * size
    for number in range(begin, end):
        if table[number] != depth:
            continue
        _arrange(size, places, ways, number // count, number % count, work)
        top = -1
        for source in range(places):
            top += work[heights + source]
            if work[heights + source] == 0:
                continue
            # The places before the source count from the bottom of the order, those after it without the block taken.
            last = 0
            for target in range(places):
                last += work[heights + target]
                if target == source:
                    last -= 1
                    continue
                _carry(size, work, top, last)
                work[heights + source] -= 1
                work[heights + target] += 1
                other = _order_number(size, work) * count + cuts[1 + _cut(size, places, work)]
                work[heights + target] -= 1
                work[heights + source] += 1
                if table[other] == UNKNOWN:
                    table[other] = depth + 1
                    found += 1
    return found


def _arrange(size: int, places: int, ways: Ints, order_number: int, way: int, work: Ints) -> None:
    """Write the arrangement of a number into `work`: its order, and the heights of its piles."""
    for index in range(size - 1, -1, -1):
        work[index] = order_number % (size - index)
        order_number //= size - index
    used = 0
    for index in range(size):
        block = 0
        left = work[index]
        while used >> block & 1 or left > 0:
            if used >> block & 1 == 0:
                left -= 1
            block += 1
        work[index] = block
        used |= 1 << block
    for place in range(places):
        work[2 * size + place] = ways[way * places + place]


def _carry(size: int, work: Ints, source: int, target: int) -> None:
    """Write the second order: the first with its block at `source` taken out and put in at `target`."""
    index = 0
    for place in range(size):
        if place == target:
            work[size + place] = work[source]
        else:
            if index == source:
                index += 1
            work[size + place] = work[index]
            index += 1


def _order_number(size: int, work: Ints) -> int:
    """Return the number of the second order."""
    number = used = 0
    for index in range(size):
        block = work[size + index]
        number = number * (size - index) + block - _bits(used & ((1 << block) - 1))
        used |= 1 << block
    return number


def _cut(size: int, places: int, work: Ints) -> int:
    cut = 0
    for place in range(places - 1):
        cut = cut * (size + 1) + work[2 * size + place]
    return cut
