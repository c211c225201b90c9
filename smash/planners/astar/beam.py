"""Beam search: plans where A* cannot finish. Passes with layers of limited width, twice as wide from pass to pass.

A layer holds states that are equally many moves away (direct moves not counted: `settle` makes them). The best by
their estimate, the dearest to reach among equals, are expanded into the next layer; what cannot lead to a plan
cheaper than the best known one is dropped. Where a pass never had to leave a state out, no cheaper plan exists. Passes
differ by the weight of what is left to do: with more than 1 a layer prefers states nearer to the goal.
"""

from __future__ import annotations

from time import perf_counter
from typing import Any

from smash.planners.astar.compiler import Compiler
from smash.planners.astar.engine import Engine, Move
from smash.planners.astar.pattern_sets import Patterns
from smash.planners.astar.search import BEST, NODES, UPPER, Store
from smash.planners.astar.store import free_memory, grown, make_store, most_nodes
from smash.planners.astar.task import Setting, make_setting
from smash.planners.greedy.shorten import shorten
from smash.problem.model import PlanOptions
from smash.problem.views.numbered import Numbered, Step, cost_of

FIRST_WIDTH = 4
FIRST_NODES = 1 << 10
MOST_MEMORY = 1 << 29
"""The most memory for the states of two layers, and again for the ways back [bytes]."""
WEIGHTS = (2, 3)
"""How much half a unit of the bound on what is left counts beside half a unit spent, from pass to pass of one width."""
TIE_BITS = 20
"""Of the number drawn for a state, which decides between those of equal estimate and cost."""


class BeamSearch:
    """Passes of a beam search for plans cheaper than `upper`; `run` may be called again and again.

    Args:
        problem: the numbered instance.
        options: what a plan may use.
        upper: the cost of a plan that is known.
        seed: for the choice among equals. The same seed finds the same plans, as far as the time allows.
        memory: the most memory to take [bytes]; None: what is free, at most `MOST_MEMORY`.

    Attributes:
        upper: what plans have to be cheaper than.
        ended: why the search is over (`proven`: no plan is cheaper than `upper`), or None.
        width: of the layers of the pass that runs, or ran last.
        patterns: databases that bound the cost in the passes that begin from now on.
    """

    def __init__(
        self, problem: Numbered, options: PlanOptions, upper: int, seed: int = 0, memory: int | None = None
    ) -> None:
        self.problem = problem
        self.upper = upper
        self.ended: str | None = None
        self.width = FIRST_WIDTH
        self._passes = 0
        self._seed = seed
        self._memory = memory
        self.patterns: Patterns | None = None
        self._options = options
        self._setting: Setting | None = None
        self._pass: BeamPass | None = None

    def lower_upper(self, upper: int) -> None:
        """Take over the cost of a better plan that others have found."""
        self.upper = min(self.upper, upper)

    def run(self, deadline: float, most_width: int | None = None) -> list[Step] | None:
        """Search until a better plan is found (returned), the search has ended, or `deadline` [s, `perf_counter`].

        With `most_width` it also pauses where the next pass would have wider layers.
        """
        while self.ended is None:
            running = self._pass or self._begin(deadline)
            if running is None or perf_counter() > deadline or (most_width is not None and self.width > most_width):
                return None
            running.lower_upper(self.upper)
            moves = running.advance()
            if running.over:
                self._finish(running)
            if moves is not None:
                return self._take(running, moves, deadline)
        return None

    def _begin(self, deadline: float) -> BeamPass | None:
        """Begin a pass, once the functions are compiled; None where they are not in time."""
        code = Compiler.code(deadline)
        if code is None:
            return None
        if self._setting is None:
            self._setting = make_setting(self.problem, self._options)
        if self._memory is None:
            self._memory = min(free_memory(), MOST_MEMORY)
        self._pass = BeamPass(
            self._setting,
            code,
            self.upper,
            self.width,
            self._memory,
            self._seed,
            patterns=self.patterns,
            weight=WEIGHTS[self._passes % len(WEIGHTS)],
        )
        self._passes += 1
        return self._pass

    def _finish(self, running: BeamPass) -> None:
        """Prepare the next pass: wider where memory allows, in any case with other choices among equals."""
        self._pass = None
        if not running.truncated:
            self.ended = "proven"
        elif not running.cramped and 2 * self.width <= self._widest():
            self.width *= 2
        self._seed += 1

    def _widest(self) -> int:
        """Return how wide layers may be for the ways back to fit: 12 bytes a state, at most a layer an action."""
        assert self._memory is not None
        return self._memory // (12 * max(1, self.upper))

    def _take(self, running: BeamPass, moves: list[Move], deadline: float) -> list[Step]:
        """Return the steps of a plan found, shortened where that is possible."""
        steps = shorten(running.engine.steps(self.problem, moves), deadline)
        self.upper = min(self.upper, cost_of(steps))
        return steps


class BeamPass:
    """One pass: a layer, the store that takes the next one, and the moves of all layers before.

    Args:
        setting: the problem's numbers.
        code: the compiled functions.
        upper: what plans have to be cheaper than.
        width: most states of a layer.
        memory: the most to take for states [bytes].
        seed: for the choice among equals.
        patterns: databases that bound the cost too.
        weight: of the bound on what is left, in halves: 2 where it counts as much as what is spent.

    Attributes:
        expanded: states expanded.
        over: whether there is no further layer.
        truncated: whether a state was left out that might have led to a better plan.
        cramped: whether that was for want of memory.
    """

    def __init__(
        self,
        setting: Setting,
        code: Any,
        upper: int,
        width: int,
        memory: int,
        seed: int,
        *,
        patterns: Patterns | None = None,
        weight: int = WEIGHTS[0],
    ) -> None:
        import numpy as np

        self.expanded = 0
        self.engine = Engine(setting, code, compiled=True)
        self.over = self.truncated = self.cramped = False
        self._width = width
        self._weight = weight
        self._most = most_nodes(setting.task.width * setting.task.blocks, memory)
        self._draw = np.random.default_rng(seed)
        self._store: Store = make_store(setting.task, True, min(FIRST_NODES, self._most), upper, upper, patterns)
        self.engine.unpack_start()
        code.file_node(setting.task, self.engine.cells, self._store, -1, 0, -1, 0, 0)
        self._rows: Any = np.zeros(0, dtype="u1")
        self._costs: Any = np.zeros(0, dtype="i8")
        self._estimates: Any = self._costs
        self._expanded = 0
        self._history: list[tuple[Any, Any, Any]] = []
        """Per layer, of each state: the parent's place in the layer before, and the move; -1 for the start."""

    def lower_upper(self, upper: int) -> None:
        """Take over the cost of a better plan."""
        counters = self._store.counters
        counters[UPPER] = min(counters[UPPER], upper)

    def advance(self) -> list[Move] | None:
        """Expand a share of the layer; return the moves to a better plan if one was found.

        Before the first layer there is none to expand: the store holds the start.
        """
        engine, counters = self.engine, self._store.counters
        end = min(len(self._costs), self._expanded + engine.share)
        engine.allow()
        self._expanded = engine.code.expand_layer(
            engine.task, engine.cells, self._rows, self._costs, self._estimates, self._store, self._expanded, end
        )
        best = int(counters[BEST])
        moves = None if best < 0 else self._moves(best)
        counters[BEST] = -1
        full = int(counters[NODES]) == int(self._store.shape[2])
        if self._expanded < end and full and not self._grow():
            self.truncated = self.cramped = True
            self._expanded = len(self._costs)
            engine.cells[engine.task.resumed] = -1  # no state of the next layer was broken off
        if self._expanded == len(self._costs):
            self._next_layer()
        return moves

    def _grow(self) -> bool:
        """Make room for more nodes; False where memory ends."""
        nodes = int(self._store.shape[2])
        if nodes == self._most:
            return False
        engine = self.engine
        self._store = grown(engine.task, self._store, min(2 * nodes, self._most), engine.code, True)
        return True

    def _next_layer(self) -> None:
        """Take the best of the nodes as the next layer, and empty the store."""
        store: Any = self._store
        chosen = self._chosen()
        self._history.append((store.parent[chosen], store.moved[chosen], store.code[chosen]))
        self._rows = store.states.reshape(int(store.shape[2]), -1)[chosen].reshape(-1)
        self._costs, self._estimates = store.cost[chosen].astype("i8"), store.estimate[chosen].astype("i8")
        self.expanded += self._expanded
        self._expanded = 0
        store.counters[NODES] = 0
        store.table[:] = 0
        self.over = len(chosen) == 0

    def _chosen(self) -> Any:
        """Return the nodes of the next layer, best first."""
        import numpy as np

        store: Any = self._store
        count = int(store.counters[NODES])
        open_ = (store.stale[:count] == 0) & (store.estimate[:count] < store.counters[UPPER])
        nodes = np.flatnonzero(open_)
        if len(nodes) <= self._width:
            return nodes
        self.truncated = True
        width = int(store.counters[UPPER]) + 1
        spent = store.cost[nodes].astype("i8")
        key = 2 * spent + self._weight * (store.estimate[nodes] - spent)
        key = key * width + (width - spent)
        key = (key << TIE_BITS) + self._draw.integers(0, 1 << TIE_BITS, len(nodes))
        best = np.argpartition(key, self._width)[: self._width]
        return nodes[best[np.argsort(key[best])]]

    def _moves(self, node: int) -> list[Move]:
        """Return the moves from the start to a node, without the direct ones."""
        moves: list[Move] = []
        for parents, moved, codes in ((self._store.parent, self._store.moved, self._store.code), *self._history[::-1]):
            if parents[node] >= 0:
                moves.append((int(moved[node]), int(codes[node])))
            node = int(parents[node])
        return moves[::-1]
