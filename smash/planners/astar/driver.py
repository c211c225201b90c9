"""The search as an object: it runs in shares, grows its memory up to a limit, and says what it has proven."""

from __future__ import annotations

import threading
from collections.abc import Callable
from time import perf_counter

from smash.planners.astar.compiled import INTERPRETED, Code, compiled_code
from smash.planners.astar.search import BEST, EXPANDED, FLOOR, FULL, PROVEN, UPPER, Store
from smash.planners.astar.store import filled, free_memory, grown, make_store, most_nodes
from smash.planners.astar.task import Ints, Setting, make_setting
from smash.planners.astar.walk import Walk
from smash.planners.indexed import Indexed, Step
from smash.problem.model import Instance, PlanOptions, StacksGoal

INTERPRETED_NODES = 1500
"""Nodes filed before numba is imported: smaller searches end sooner without it."""
COMPILE_SECONDS = 1.5
"""How long to wait for the compiled search: its machine code is loaded by then, unless it must be made."""
MOST_INTERPRETED = 100_000
"""Nodes filed while the machine code is still being made."""
FIRST_NODES = 1 << 16
MOST_BUCKETS = 1 << 24
"""Beyond this the plan known is so far from the bound that no search can close the gap."""
INTERPRETED_BLOCKS = 30
"""With more blocks one expansion takes too long to be interpreted."""
WORK = {False: 3_000, True: 200_000}
"""What a share of expansions is worth, in blocks squared times locations: some milliseconds between two looks at
the clock, interpreted and compiled."""


class StateSearch:
    """A* from the start of `problem` for plans cheaper than `upper`; `run` may be called again and again.

    Args:
        problem: the numbered instance.
        options: what a plan may use.
        upper: the cost of a plan that is known.
        memory: the most memory to take [bytes]; None: as much as `free_memory` says.
        on_bound: called at once with every better lower bound than 0.

    Attributes:
        lower_bound: what no plan is cheaper than, so far.
        ended: why the search is over (`proven`, `memory`, or what it cannot take), or None.
        expanded: nodes expanded.
    """

    def __init__(
        self,
        problem: Indexed,
        options: PlanOptions,
        upper: int,
        memory: int | None = None,
        on_bound: Callable[[int], object] | None = None,
    ) -> None:
        self.problem = problem
        self._on_bound = on_bound
        self.lower_bound = 0
        self.ended: str | None = None
        self.expanded = 0
        self._interpreted = problem.blocks <= INTERPRETED_BLOCKS
        self._memory = free_memory() if memory is None else memory
        setting = make_setting(problem, options)
        if setting is None:
            self.ended = "too many blocks and kinds of locations for a byte"
            return
        self._engine = _Engine(setting, INTERPRETED, False)
        self._prove(min(self._engine.first_bound(), upper))
        if self.lower_bound >= upper:
            self.ended = "proven"
        elif (upper - self.lower_bound + 1) * (upper + 1) > MOST_BUCKETS:
            self.ended = "the plan known is too far from the bound"
        else:
            self._engine.open(INTERPRETED_NODES, self.lower_bound, upper)

    def run(self, deadline: float, may_compile: bool = True) -> list[Step] | None:
        """Search until a better plan is found (returned), the search has ended, or `deadline` [s, `perf_counter`].

        Without `may_compile` it also pauses where the interpreted search has filled its store.
        """
        while self.ended is None:
            if not self._ready(deadline, may_compile):
                return None
            engine = self._engine
            outcome = engine.expand()
            self._prove(min(engine.counter(FLOOR), engine.counter(UPPER)))
            self.expanded = engine.counter(EXPANDED)
            if outcome == PROVEN:
                self.ended = "proven"
            if engine.counter(BEST) != engine.reported:
                engine.reported = engine.counter(BEST)
                return self._steps()
            stuck = outcome == FULL and (not (may_compile or engine.compiled) or not self._grow(deadline))
            if stuck or perf_counter() > deadline:
                return None
        return None

    def raise_bound(self, lower_bound: int, upper: int) -> None:
        """Take over what others have proven and found; an interpreted search starts anew when it is compiled."""
        if self.ended is not None:
            return
        self.lower_bound = max(self.lower_bound, lower_bound)
        counters = self._engine.store.counters
        counters[UPPER] = min(counters[UPPER], upper)
        if self.lower_bound >= counters[UPPER]:
            self.lower_bound = int(counters[UPPER])
            self.ended = "proven"

    def _prove(self, bound: int) -> None:
        if bound > self.lower_bound:
            self.lower_bound = bound
            if self._on_bound is not None:
                self._on_bound(bound)

    def _ready(self, deadline: float, may_compile: bool) -> bool:
        """Take the compiled search where it is there, or where the problem is too large to be searched without."""
        if self._engine.compiled:
            return True
        if may_compile and (_Compiler.started() or not self._interpreted):
            self._compile(perf_counter() if self._interpreted else deadline)
        return self._interpreted or self._engine.compiled

    def _grow(self, deadline: float) -> bool:
        """Make room, by compiling first if that is soon done; False where memory ends."""
        engine = self._engine
        if not engine.compiled and not _Compiler.started():
            self._compile(min(deadline, perf_counter() + COMPILE_SECONDS))
            return True
        nodes = int(engine.store.shape[2])
        most = most_nodes(engine.task.blocks, self._memory) if engine.compiled else MOST_INTERPRETED
        if nodes >= most:
            self.ended = "memory" if engine.compiled else None
            return False
        engine.store = grown(engine.task, engine.store, min(2 * nodes, most), engine.code, engine.compiled)
        return True

    def _compile(self, deadline: float) -> bool:
        """Start anew with the compiled search; False where it is not there by `deadline`."""
        code = _Compiler.code(deadline)
        if code is None:
            return False
        # A plan that filing the start gave, and that nobody has heard of, is to be found again.
        unheard = self._engine.counter(BEST) != self._engine.reported
        upper = self._engine.counter(UPPER) + unheard
        self._engine = _Engine(self._engine.setting, code, True)
        self._engine.open(FIRST_NODES, self.lower_bound, upper)
        return True

    def _steps(self) -> list[Step]:
        """Return the steps to the best node: the moves on the way, each with the direct moves that follow it."""
        engine = self._engine
        walk = Walk(self.problem, engine.setting.class_of)
        for block, code in engine.path():
            walk.move(block, code)
        return walk.steps


class _Engine:
    """The functions of the search, interpreted or compiled, with the arrays that they work on."""

    def __init__(self, setting: Setting, code: Code, compiled: bool) -> None:
        self.setting = setting
        self.task = setting.task
        self.code = code
        self.compiled = compiled
        self.cells = filled(setting.cells, compiled)
        self.reported = -1
        self.share = max(1, WORK[compiled] // max(1, self.task.blocks**2 * len(setting.class_of)))
        self.store: Store

    def first_bound(self) -> int:
        """Return the bound at the start."""
        return self._at_start() + self.code.lower_bound(self.task, self.cells)

    def open(self, nodes: int, first: int, upper: int) -> None:
        """File the start in an empty store."""
        self.store = make_store(self.task, self.compiled, nodes, first, upper)
        self.code.unpack(self.task, self.cells, self._start_row(), 0)
        self.code.file_state(self.task, self.cells, self.store, -1, 0, -1, 0)

    def expand(self) -> int:
        """Expand a share of nodes."""
        return self.code.expand_some(self.task, self.cells, self.store, self.share)

    def counter(self, which: int) -> int:
        """Return a counter of the store."""
        return int(self.store.counters[which])

    def path(self) -> list[tuple[int, int]]:
        """Return all moves from the start to the best node, as pairs (block, code)."""
        nodes: list[int] = []
        node = self.counter(BEST)
        while node > 0:
            nodes.append(node)
            node = int(self.store.parent[node])
        made = self._trail(self._at_start() // 2)
        for node in reversed(nodes):
            block, code = int(self.store.moved[node]), int(self.store.code[node])
            made.append((block, code))
            self.code.apply_move(self.task, self.cells, block, code)
            made += self._trail(self.code.settle(self.task, self.cells))
        return made

    def _trail(self, count: int) -> list[tuple[int, int]]:
        first = self.task.trail
        entries = [int(entry) for entry in self.cells[first : first + 2 * count]]
        return list(zip(entries[::2], entries[1::2], strict=True))

    def _at_start(self) -> int:
        """Take the start in hand, settled; return what its direct moves cost."""
        self.code.unpack(self.task, self.cells, self._start_row(), 0)
        return 2 * self.code.settle(self.task, self.cells)

    def _start_row(self) -> Ints:
        return filled(self.setting.start, self.compiled, "u1")


class _Compiler:
    """Compiles once a process, in a thread: the first time ever it takes long, and budgets are kept meanwhile."""

    _thread: threading.Thread | None = None
    _code: Code | None = None

    @classmethod
    def code(cls, deadline: float) -> Code | None:
        """Return the compiled functions, ready to run, or None where `deadline` passes before they are."""
        if cls._thread is None:
            cls._thread = threading.Thread(target=cls._compile, daemon=True)
            cls._thread.start()
        cls._thread.join(max(0.0, deadline - perf_counter()))
        return cls._code

    @classmethod
    def started(cls) -> bool:
        """Return whether compiling has begun."""
        return cls._thread is not None

    @classmethod
    def _compile(cls) -> None:
        """Call every function once, on a problem of one block."""
        goal = StacksGoal({"s": ("b",)})
        instance = Instance("warm", ("b",), ("s",), (), {"s": ()}, goal, ("b",))
        setting = make_setting(Indexed.of(instance), PlanOptions())
        assert setting is not None
        engine = _Engine(setting, compiled_code(), True)
        engine.open(4, 0, engine.first_bound() + 1)
        engine.expand()
        engine.path()
        engine.code.apply_move(engine.task, engine.cells, 0, -1)
        engine.code.file_again(engine.task, engine.store)
        cls._code = engine.code


def warm_up() -> None:
    """Compile the search, so that its machine code is cached."""
    _Compiler._compile()
