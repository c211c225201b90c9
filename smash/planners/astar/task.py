"""What the search knows, as integers: the instance, and the state in hand taken apart into piles.

All of it stands in one sequence, `cells`: a list where the search is interpreted (nothing to import), a numpy
array where it is compiled. `Task` says where each part begins: `cells[task.length + slot]` is the length of the
pile in a slot. A state is filed as a number per block: what is below it, that is a block `0 .. n-1`, the
floor of a location of class c (`n + c`), or the table region (`n + classes`); one byte each, and where that holds
too little a second and a third, after the first of all blocks. Locations that nothing tells apart share a class, so
that states which differ by their names only are one.
"""

from __future__ import annotations

from collections.abc import MutableSequence
from typing import NamedTuple

from smash.problem.model import OnGoal, PlanOptions
from smash.problem.views.numbered import Numbered
from smash.problem.views.targets import Piles, goal_piles, towers_of

Ints = MutableSequence[int]
BYTE = 8
"""Bits of what is below a block that are filed together."""
UNBOUNDED = 1 << 40
"""More moves than are ever tried between two looks at the clock."""
TOPPLED = -1
"""The second half of a move that topples: the first is the lowest block that falls."""


class Task(NamedTuple):
    """The problem's numbers, and where each part of `cells` begins.

    A *line* is a sequence of blocks to be built: a location's goal pile, or a tower of an `on` goal. A *slot*
    is a place for a pile; where lines have locations of their own, the first slots are theirs.
    """

    blocks: int
    width: int
    """Bytes of a filed state per block."""
    classes: int
    lines: int
    topple: int
    """1 where topple is allowed."""
    cap: int
    """The most blocks of one topple."""
    anywhere: int
    """1 for `on` goals: a line is built at any location, else each at the location of its own class."""
    tidy: int
    """1 where a block that can go straight to its final place is moved there at once, and never leaves it."""

    class_size: int
    class_topple: int
    """1 where the locations of the class can be toppled."""
    class_line: int
    """The line that is built at the one location of the class, or -1."""
    line_first: int
    """Where the line begins in `line_blocks`; one entry more, for the end of the last."""
    line_blocks: int
    line_class: int
    """The class of the line's location, or -1."""
    line_grounded: int
    """1 where the line's first block must be at the bottom of a location."""
    line_of: int
    """Per block its line, or -1 where the goal does not list it."""
    index_of: int
    """Per block its place in its line, 0 for the first."""
    on_table: int
    """Per block 1 where it must be at the bottom of a location or in the table region."""
    clear: int
    """Per block 1 where nothing may lie on it."""

    content: int
    """`slot * blocks + level`: the piles, bottom first."""
    length: int
    kind: int
    """Per slot the class of its location."""
    keep: int
    """Per slot how many of its lowest blocks may stay for ever."""
    slot_of: int
    """Per block its slot, -1 in the table region."""
    above: int
    done: int
    """Per line how many of its first blocks are right for good."""
    anchor: int
    """Per line the slot that it stands or must stand in, -1 for any."""
    clear_at: int
    """Per line the length of its slot's pile when the next block can be put on it."""
    class_used: int
    counters: int
    """The number of slots in use."""
    left: int
    """Relaxed run: per slot the blocks not yet taken."""
    built: int
    """Relaxed run: per line the blocks placed."""
    loose: int
    """Relaxed run: per block 1 where it can be taken at any time."""
    mark: int
    lowest: int
    listed: int
    """The number of moves to try."""
    moves: int
    """Pairs (block, code) of the moves to try."""
    allowed: int
    """How many more moves may be tried before the next look at the clock."""
    resumed: int
    """The state whose expansion was broken off for that, -1 for none."""
    resume: int
    """The first of its moves that was not tried."""
    trail: int
    """Pairs (block, code) of the direct moves made by `settle`."""


class Setting(NamedTuple):
    """A task with its cells, the class of each location, and the start as a filed state."""

    task: Task
    cells: list[int]
    class_of: list[int]
    start: list[int]


def make_setting(problem: Numbered, options: PlanOptions) -> Setting:
    """Return the numbers of a problem."""
    wanted = goal_piles(problem)
    topples = [int(options.topple and location < problem.stacks) for location in range(problem.locations)]
    if wanted is None:
        towers = towers_of(problem)
        lines = tuple(tower.blocks for tower in towers)
        grounded = [int(tower.grounded) for tower in towers]
        keys = [(-1, topple) for topple in topples]
    else:
        at = [location for location, pile in enumerate(wanted) if pile]
        lines = tuple(wanted[location] for location in at)
        grounded = [1] * len(lines)
        keys = [(at.index(location) if wanted[location] else -1, topple) for location, topple in enumerate(topples)]
    kinds = sorted(set(keys), reverse=True)
    class_of = [kinds.index(key) for key in keys]
    width = max(1, -(-(problem.blocks + len(kinds)).bit_length() // BYTE))
    room = problem.stacks if options.topple else problem.locations
    parts = {
        "class_size": [class_of.count(number) for number in range(len(kinds))],
        "class_topple": [topple for _, topple in kinds],
        "class_line": [line for line, _ in kinds],
        "line_class": [next((c for c, kind in enumerate(kinds) if kind[0] == line), -1) for line in range(len(lines))],
        "line_grounded": grounded,
        **_listed(lines, problem.blocks),
        **_resting(problem),
        **_scratch(problem.blocks, len(lines), len(kinds), min(problem.blocks, problem.locations)),
    }
    cells: list[int] = []
    begins: dict[str, int] = {}
    for name, values in parts.items():
        begins[name] = len(cells)
        cells += values
    task = Task(
        blocks=problem.blocks,
        width=width,
        classes=len(kinds),
        lines=len(lines),
        topple=int(options.topple),
        cap=min(problem.blocks, options.max_topple or problem.blocks),
        anywhere=int(wanted is None),
        tidy=int(wanted is not None or room >= problem.blocks),
        **begins,
    )
    return Setting(task, cells, class_of, _filed(problem, class_of, len(kinds), width))


def _listed(lines: Piles, blocks: int) -> dict[str, list[int]]:
    """Return the parts that hold the lines."""
    line_of, index_of, first = [-1] * blocks, [0] * blocks, [0]
    for number, line in enumerate(lines):
        first.append(first[-1] + len(line))
        for index, block in enumerate(line):
            line_of[block], index_of[block] = number, index
    return {
        "line_first": first,
        "line_blocks": [block for line in lines for block in line],
        "line_of": line_of,
        "index_of": index_of,
    }


def _resting(problem: Numbered) -> dict[str, list[int]]:
    """Return the parts that hold what an `on` goal asks beside its lines."""
    goal, blocks = problem.instance.goal, problem.instance.blocks
    ontable, clear = (goal.ontable, goal.clear) if isinstance(goal, OnGoal) else ((), ())
    return {
        "on_table": [int(block in ontable) for block in blocks],
        "clear": [int(block in clear) for block in blocks],
    }


def _scratch(blocks: int, lines: int, classes: int, piles: int) -> dict[str, list[int]]:
    """Return the parts that change: a state in hand has a slot a line and a pile, and one for each pile begun after.

    One move begins a pile, and each line one by its first block.
    """
    slots = 2 * lines + piles + 2
    sizes = {
        **dict.fromkeys(("length", "kind", "keep", "left", "mark"), slots),
        **dict.fromkeys(("slot_of", "above", "loose"), blocks),
        **dict.fromkeys(("done", "anchor", "clear_at", "built", "lowest"), lines),
        "content": slots * blocks,
        "class_used": classes,
        "counters": 1,
        "listed": 1,
        "moves": 2 * (blocks + 1) * (piles + classes + 2),
        "trail": 4 * blocks + 2,
    }
    parts = {name: [0] * size for name, size in sizes.items()}
    return {**parts, "allowed": [UNBOUNDED], "resumed": [-1], "resume": [0]}


def _filed(problem: Numbered, class_of: list[int], classes: int, width: int) -> list[int]:
    row = [problem.blocks + classes] * problem.blocks
    for location, pile in enumerate(problem.start):
        below = problem.blocks + class_of[location]
        for block in pile:
            row[block] = below
            below = block
    return [below >> (BYTE * byte) & ((1 << BYTE) - 1) for byte in range(width) for below in row]
