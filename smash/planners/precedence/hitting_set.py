"""The cheapest choices that hit every cycle: cuts on the LP relaxation, then on integer solutions (HiGHS).

Rows are added as cycles are found violated. HiGHS 1.15 can hang in a warm-started LP after new rows
(seen at 200 blocks), so the solver's state is cleared before each re-solve; the LPs are small.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from time import perf_counter

import highspy
import numpy as np

from smash.planners.milp.solvers import highs
from smash.planners.precedence.cycles import CycleFinder
from smash.planners.precedence.dive import EventOrder, dive
from smash.planners.precedence.graph import Floats, PrecedenceGraph

TOLERANCE = 1e-6
DIVE_SECONDS = 0.3
"""Longest time for making one feasible choice cheaper."""
ROUNDINGS = 40
"""Random roundings of the LP solution from which rows are taken before the integer solves."""
Row = frozenset[int]


@dataclass(slots=True)
class HittingSet:
    """What is known of the cheapest hitting set.

    Attributes:
        bound: no hitting set costs less (actions on top of the graph's base cost).
        chosen: the cheapest hitting set found.
        rows: the cycles (and forced topples) found, as sets of choices of which one must be taken.
        cycles: for each row the blocks of its back edges (a single loose block for a forced topple).
        rounds: LP and MIP solves.
    """

    bound: int
    chosen: set[int]
    rows: list[Row] = field(default_factory=list)
    cycles: list[tuple[int, ...]] = field(default_factory=list)
    rounds: dict[str, int] = field(default_factory=lambda: {"lp": 0, "mip": 0})


class HittingSetSolver:
    """Branch-and-cut for one graph; `solve` may be stopped at any time and then returns a valid bound.

    `on_bound` is called at once with every better bound.
    """

    def __init__(
        self, graph: PrecedenceGraph, threads: int = 1, on_bound: Callable[[int], object] | None = None
    ) -> None:
        self.graph = graph
        self._on_bound = on_bound
        self.finder = CycleFinder(graph)
        self._order = EventOrder(graph)
        self._costs = graph.costs
        costs = [choice.cost for choice in graph.choices]
        self._unit = math.gcd(*costs) if costs else 1
        self._threads = threads
        self._uses = np.zeros(len(costs))
        self._known: dict[Row, tuple[int, ...]] = {}
        self._rows_sent = 0
        self._started = False
        self._report: Callable[[set[int]], None] | None = None
        self.state = HittingSet(0, set())
        self._model = self._new_model()
        for block in graph.must_free:
            self._add_row((block,))

    def start(self, deadline: float) -> set[int]:
        """Return a first hitting set, at once; `deadline` cuts its improvement short (`time.perf_counter` seconds)."""
        self._started = True
        self._offer(self._dive(None, deadline))
        return self.state.chosen

    def solve(self, deadline: float, on_choice: Callable[[set[int]], None] | None = None) -> HittingSet:
        """Find the cheapest hitting set, or stop at `deadline` (`time.perf_counter` seconds)."""
        self._report = on_choice
        if not self._started:
            self.start(deadline)
        if self._proven():
            return self.state
        values = self._relax(deadline)
        if values is not None and not self._proven():
            self._round(values, deadline)
            self._integrate(deadline)
        return self.state

    def cost(self, chosen: set[int]) -> int:
        """Cost of a hitting set, on top of the base cost."""
        return sum(self.graph.choices[choice].cost for choice in chosen)

    def _dive(self, values: Floats | None, deadline: float) -> set[int]:
        return dive(self.graph, values, self._order, min(deadline, perf_counter() + DIVE_SECONDS))

    def _proven(self) -> bool:
        return self.state.bound >= self.cost(self.state.chosen)

    def _offer(self, chosen: set[int]) -> None:
        if not self.state.chosen or self.cost(chosen) < self.cost(self.state.chosen):
            self.state.chosen = chosen
            if self._report is not None:
                self._report(chosen)

    def _raise_bound(self, value: float) -> None:
        units = math.ceil(value / self._unit - TOLERANCE)
        if units * self._unit > self.state.bound:
            self.state.bound = units * self._unit
            if self._on_bound is not None:
                self._on_bound(self.state.bound)

    def _new_model(self) -> highspy.Highs:
        model = highspy.Highs()
        model.silent()
        model.setOptionValue("threads", self._threads)
        model.setOptionValue("random_seed", 1)
        count = len(self._costs)
        if count:
            model.addCols(count, self._costs, np.zeros(count), np.ones(count), 0, [], [], [])
        return model

    def _add_row(self, cycle: tuple[int, ...]) -> bool:
        row = self.graph.row(cycle)
        if row in self._known:
            return False
        self._known[row] = cycle
        self._uses[list(row)] += 1
        self.state.rows.append(row)
        self.state.cycles.append(cycle)
        return True

    def _send_rows(self) -> None:
        fresh = self.state.rows[self._rows_sent :]
        if not fresh:
            return
        lengths = [len(row) for row in fresh]
        starts = np.concatenate(([0], np.cumsum(lengths)[:-1])).astype(np.int32)
        columns = np.array([column for row in fresh for column in sorted(row)], dtype=np.int32)
        count = len(fresh)
        infinity = np.full(count, highspy.kHighsInf)
        self._model.addRows(count, np.ones(count), infinity, len(columns), starts, columns, np.ones(len(columns)))
        self._rows_sent = len(self.state.rows)

    def _run(self, deadline: float, known: set[int] | None = None) -> bool:
        """Solve the model as it stands, from a `known` hitting set; whether the solver ended with an optimum."""
        left = deadline - perf_counter()
        if left <= 0:
            return False
        self._model.clearSolver()
        self._model.setOptionValue("time_limit", left)
        if known is not None:
            solution = highspy.HighsSolution()
            solution.col_value = [float(choice in known) for choice in range(len(self._costs))]
            self._model.setSolution(solution)
        highs.run(self._model)
        return bool(self._model.getModelStatus() == highspy.HighsModelStatus.kOptimal)

    def _relax(self, deadline: float) -> Floats | None:
        """Cut the LP relaxation until no cycle is violated; the LP's solution, or None where time ran out."""
        values = np.zeros(len(self._costs))
        while perf_counter() < deadline:
            cycles = self.finder.violated(self.graph.freedom(values), 1.0 - 1e-3, deadline)
            if sum([self._add_row(cycle) for cycle in cycles]) == 0 and self._rows_sent == len(self.state.rows):
                return values
            self._send_rows()
            if not self._run(deadline):
                return None
            self.state.rounds["lp"] += 1
            values = np.array(self._model.getSolution().col_value)
            self._raise_bound(self._model.getInfo().objective_function_value)
            self._offer(self._dive(values, deadline))
            if self._proven():
                return values
        return None

    def _round(self, values: Floats, deadline: float) -> None:
        """Add the cycles that roundings of the LP solution leave: integer solves would ask for them one by one."""
        draw = np.random.default_rng(0)
        for _ in range(ROUNDINGS):
            self._cut_off((values > draw.uniform(0.0, 1.0, len(values))).astype(float), deadline)

    def _integrate(self, deadline: float) -> None:
        """Solve with integer choices, adding the cycles that each solution leaves, until it leaves none."""
        count = len(self._costs)
        kinds = np.full(count, highspy.HighsVarType.kInteger)
        self._model.changeColsIntegrality(count, np.arange(count, dtype=np.int32), kinds)
        self._model.setOptionValue("mip_abs_gap", self._unit - 0.001)
        self._model.setOptionValue("mip_rel_gap", 0.0)
        while perf_counter() < deadline:
            self._send_rows()
            ended = self._run(deadline, self.state.chosen)
            self.state.rounds["mip"] += 1
            info = self._model.getInfo()
            if math.isfinite(info.mip_dual_bound):
                self._raise_bound(info.mip_dual_bound)
            if self._proven() or not ended or info.primal_solution_status != 2:
                return
            values = np.round(np.array(self._model.getSolution().col_value))
            self._offer(self._dive(values, deadline))
            if self._proven() or not self._cut_off(values, deadline):
                return

    def _cut_off(self, values: Floats, deadline: float) -> int:
        """Add the cycles that an integer solution leaves, then those that are left when these are hit, and so on."""
        added = 0
        values = values.copy()
        while perf_counter() < deadline:
            cycles = self.finder.violated(self.graph.freedom(values), 0.5, deadline)
            if not cycles:
                break
            for cycle in cycles:
                added += self._add_row(cycle)
                row = list(self.graph.row(cycle))
                if not values[row].any():
                    values[min(row, key=lambda choice: (self._costs[choice], -self._uses[choice], choice))] = 1.0
        return added
