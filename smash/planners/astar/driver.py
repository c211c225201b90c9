"""The search as an object: it runs in shares, grows its memory up to a limit, and says what it has proven."""

from __future__ import annotations

import math
from collections.abc import Callable
from time import perf_counter

from smash.planners.astar.compiled import INTERPRETED, Code
from smash.planners.astar.compiler import Compiler
from smash.planners.astar.engine import StoreEngine
from smash.planners.astar.pattern_sets import PatternBuilder, Patterns, takes_patterns
from smash.planners.astar.search import BEST, EXPANDED, FLOOR, FULL, PROVEN, UPPER
from smash.planners.astar.store import free_memory, grown, most_nodes
from smash.planners.astar.task import make_setting
from smash.problem.model import PlanOptions
from smash.problem.views.numbered import Numbered, Step

INTERPRETED_NODES = 1500
"""Nodes filed before numba is imported: smaller searches end sooner without it."""
COMPILE_SECONDS = 1.5
"""How long to wait for the compiled search: its machine code is loaded by then, unless it must be made."""
MOST_INTERPRETED = 100_000
"""Nodes filed while the machine code is still being made."""
FIRST_NODES = 1 << 16
MOST_BUCKETS = 1 << 24
"""Where more would be needed the plan known is too far from the bound: plans are looked for nearer to it."""
PATTERN_AFTER = 1.0
"""Seconds of the compiled search before pattern databases are built: smaller searches end sooner without them."""
PATTERN_SHARE, PATTERN_SECONDS = 0.15, 40.0
"""Share of the time left, and most seconds, for building them; the search starts anew with them."""
INTERPRETED_BLOCKS, BOUNDED_BLOCKS = 30, 250
"""With more blocks one expansion takes too long to be interpreted; with more than the second the first bound too."""


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
        ended: why the search is over (`proven`; `memory`; `too far`: the plan known is too far from the bound for all
            that lies between to be searched), or None.
        expanded: nodes expanded.
        patterns: the pattern databases that bound the cost too, once they are built.
    """

    def __init__(
        self,
        problem: Numbered,
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
        self.patterns: Patterns | None = None
        self._patterns_from = math.inf
        self._patterned = takes_patterns(problem, options)
        self._interpreted = problem.blocks <= INTERPRETED_BLOCKS
        self._memory = free_memory() if memory is None else memory
        self._options = options
        self._known = self._upper = upper
        self._begun: StoreEngine | None = None
        if problem.blocks <= BOUNDED_BLOCKS:
            self._begin(INTERPRETED, INTERPRETED_NODES, compiled=False)

    @property
    def _engine(self) -> StoreEngine:
        assert self._begun is not None
        return self._begun

    def _begin(self, code: Code, nodes: int, *, compiled: bool) -> None:
        """Bound the start, and open the search from it."""
        self._begun = StoreEngine(make_setting(self.problem, self._options), code, compiled)
        self._prove(min(self._engine.first_bound(), self._known))
        # As far above the bound as there are buckets for: the first bucket of all is at the bound.
        self._upper = min(self._known, self.lower_bound + max(1, MOST_BUCKETS // (self._known + 1) - 1))
        if self.lower_bound >= self._known:
            self.ended = "proven"
        else:
            self._engine.open(nodes, self.lower_bound, self._upper)

    def _exhausted(self) -> str:
        """Return why a search is over that found nothing cheaper than it looked for."""
        return "proven" if self._engine.counter(UPPER) < self._upper or self._upper == self._known else "too far"

    def run(self, deadline: float, may_compile: bool = True) -> list[Step] | None:
        """Search until a better plan is found (returned), the search has ended, or `deadline` [s, `perf_counter`].

        Without `may_compile` it also pauses where the interpreted search has filled its store.
        """
        while self.ended is None:
            if not self._ready(deadline, may_compile):
                return None
            if perf_counter() > self._patterns_from:
                self._build_patterns(deadline)
            engine = self._engine
            outcome = engine.expand()
            self._prove(min(engine.counter(FLOOR), engine.counter(UPPER)))
            self.expanded = engine.counter(EXPANDED)
            if outcome == PROVEN:
                self.ended = self._exhausted()
            if engine.counter(BEST) != engine.reported:
                engine.reported = engine.counter(BEST)
                return engine.steps(self.problem, engine.path())
            stuck = outcome == FULL and (not (may_compile or engine.compiled) or not self._grow(deadline))
            if stuck or perf_counter() > deadline:
                return None
        return None

    def raise_bound(self, lower_bound: int, upper: int) -> None:
        """Take over what others have proven and found; an interpreted search starts anew when it is compiled."""
        if self.ended is not None:
            return
        self.lower_bound = max(self.lower_bound, lower_bound)
        self._known = min(self._known, upper)
        if self.lower_bound >= self._known:
            self.lower_bound = self._known
            self.ended = "proven"
        elif self._begun is not None:
            counters = self._begun.store.counters
            counters[UPPER] = min(counters[UPPER], upper)
            self._upper = min(self._upper, upper)

    def _prove(self, bound: int) -> None:
        if bound > self.lower_bound:
            self.lower_bound = bound
            if self._on_bound is not None:
                self._on_bound(bound)

    def _ready(self, deadline: float, may_compile: bool) -> bool:
        """Take the compiled search where it is there, or where the problem is too large to be searched without."""
        if self._begun is None:
            code = Compiler.code(deadline) if may_compile else None
            if code is not None:
                self._begin(code, FIRST_NODES, compiled=True)
            return self._begun is not None and self.ended is None
        if self._engine.compiled:
            return True
        if may_compile and (Compiler.started() or not self._interpreted):
            self._compile(perf_counter() if self._interpreted else deadline)
        return self._interpreted or self._engine.compiled

    def _grow(self, deadline: float) -> bool:
        """Make room, by compiling first if that is soon done; False where memory ends."""
        engine = self._engine
        if not engine.compiled and not Compiler.started():
            self._compile(min(deadline, perf_counter() + COMPILE_SECONDS))
            return True
        nodes = int(engine.store.shape[2])
        most = most_nodes(engine.task.width * engine.task.blocks, self._memory) if engine.compiled else MOST_INTERPRETED
        if nodes >= most:
            self.ended = "memory" if engine.compiled else None
            return False
        engine.store = grown(engine.task, engine.store, min(2 * nodes, most), engine.code, engine.compiled)
        return True

    def _compile(self, deadline: float) -> bool:
        """Start anew with the compiled search; False where it is not there by `deadline`."""
        code = Compiler.code(deadline)
        if code is None:
            return False
        if self._patterned:
            self._patterns_from = perf_counter() + PATTERN_AFTER
        self._start_anew(code)
        return True

    def _build_patterns(self, deadline: float) -> None:
        """Build pattern databases, and start anew with them."""
        self._patterns_from = math.inf
        code = self._engine.code
        seconds = min(PATTERN_SECONDS, PATTERN_SHARE * (deadline - perf_counter()))
        self.patterns = PatternBuilder(self.problem, code).build(perf_counter() + seconds)
        if self.patterns is not None:
            self._start_anew(code)

    def _start_anew(self, code: Code) -> None:
        # A plan that filing the start gave, and that nobody has heard of, is to be found again.
        unheard = self._engine.counter(BEST) != self._engine.reported
        upper = self._engine.counter(UPPER) + unheard
        self._begun = StoreEngine(self._engine.setting, code, True)
        self._engine.patterns = self.patterns
        self._engine.open(FIRST_NODES, min(self.lower_bound, upper - 1), upper)
