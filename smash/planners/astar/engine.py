"""What both searches over states share: the functions and the numbers of a problem, and the way back to steps."""

from __future__ import annotations

from collections.abc import Iterable

from smash.planners.astar.compiled import Code
from smash.planners.astar.pattern_sets import Patterns
from smash.planners.astar.search import BEST, Store
from smash.planners.astar.store import filled, make_store
from smash.planners.astar.task import Ints, Setting
from smash.planners.astar.walk import Walk
from smash.problem.views.numbered import Numbered, Step

WORK = {False: 3_000, True: 200_000}
"""What a share of expansions is worth, in blocks squared times locations: some milliseconds between two looks at
the clock, interpreted and compiled."""
TRIES = {False: 300_000, True: 20_000_000}
"""The same for the moves of one expansion, in blocks times blocks and locations: those of a large state take longer."""

Move = tuple[int, int]
"""A block, and what it is put on (`task.TOPPLED`: it falls, with all above it)."""


class Engine:
    """The functions of the search, interpreted or compiled, with the cells that they work on.

    Attributes:
        share: how many nodes to expand between two looks at the clock.
        tries: how many moves to try at most between two looks at the clock.
    """

    def __init__(self, setting: Setting, code: Code, compiled: bool) -> None:
        self.setting = setting
        self.task = setting.task
        self.code = code
        self.compiled = compiled
        self.cells = filled(setting.cells, compiled)
        blocks, locations = max(1, self.task.blocks), len(setting.class_of)
        self.share = max(1, WORK[compiled] // max(1, blocks**2 * locations))
        self.tries = max(1, TRIES[compiled] // (blocks * (blocks + locations)))

    def allow(self) -> None:
        """Allow the moves of a share to be tried."""
        self.cells[self.task.allowed] = self.tries

    def at_start(self) -> int:
        """Take the start in hand, settled; return what its direct moves cost."""
        self.unpack_start()
        return 2 * self.code.settle(self.task, self.cells)

    def unpack_start(self) -> None:
        """Take the start in hand as it is."""
        self.code.unpack(self.task, self.cells, self.start_row(), 0)

    def first_bound(self) -> int:
        """Return the bound at the start."""
        return self.at_start() + self.code.lower_bound(self.task, self.cells)

    def start_row(self) -> Ints:
        """Return the start as a filed state."""
        return filled(self.setting.start, self.compiled, "u1")

    def steps(self, problem: Numbered, moves: Iterable[Move]) -> list[Step]:
        """Return `moves` from the start as steps, each with the direct moves that follow it."""
        walk = Walk(problem, self.setting.class_of)
        self._walk_trail(walk, self.at_start() // 2)
        row = self.start_row()
        for block, code in moves:
            self.code.pack(self.task, self.cells, row, 0)
            self.code.unpack(self.task, self.cells, row, 0)  # frees the slots that were left
            walk.move(block, code)
            self.code.apply_move(self.task, self.cells, block, code)
            self._walk_trail(walk, self.code.settle(self.task, self.cells))
        return walk.steps

    def _walk_trail(self, walk: Walk, count: int) -> None:
        for entry in range(self.task.trail, self.task.trail + 2 * count, 2):
            walk.move(int(self.cells[entry]), int(self.cells[entry + 1]))


class StoreEngine(Engine):
    """An engine with the node store of A*.

    Attributes:
        reported: the best node that has been told of.
        patterns: databases that bound the cost too.
    """

    reported = -1
    store: Store
    patterns: Patterns | None = None

    def open(self, nodes: int, first: int, upper: int) -> None:
        """File the start in an empty store."""
        self.store = make_store(self.task, self.compiled, nodes, first, upper, self.patterns)
        self.unpack_start()
        self.code.file_state(self.task, self.cells, self.store, -1, 0, -1, 0)

    def expand(self) -> int:
        """Expand a share of nodes."""
        self.allow()
        return self.code.expand_some(self.task, self.cells, self.store, self.share)

    def counter(self, which: int) -> int:
        """Return a counter of the store."""
        return int(self.store.counters[which])

    def path(self) -> list[Move]:
        """Return the moves from the start to the best node, without the direct ones."""
        moves: list[Move] = []
        node = self.counter(BEST)
        while node > 0:
            moves.append((int(self.store.moved[node]), int(self.store.code[node])))
            node = int(self.store.parent[node])
        return moves[::-1]
