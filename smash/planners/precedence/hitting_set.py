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

from smash.planners.precedence.cycles import CycleFinder
from smash.planners.precedence.dive import dive, hits_all
from smash.planners.precedence.graph import Floats, PrecedenceGraph

TOLERANCE = 1e-6
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
    """Branch-and-cut for one graph; `solve` may be stopped at any time and then returns a valid bound."""

    def __init__(self, graph: PrecedenceGraph, threads: int = 1) -> None:
        self.graph = graph
        self.finder = CycleFinder(graph)
        self._costs = graph.costs
        costs = [choice.cost for choice in graph.choices]
        self._unit = math.gcd(*costs) if costs else 1
        self._threads = threads
        self._known: dict[Row, tuple[int, ...]] = {}
        self._rows_sent = 0
        self.state = HittingSet(0, set())
        self._model = self._new_model()
        for block in graph.must_free:
            self._add_row((block,))

    def solve(self, deadline: float, on_choice: Callable[[set[int]], None] | None = None) -> HittingSet:
        """Find the cheapest hitting set, or stop at `deadline` (`time.perf_counter` seconds)."""
        self._report = on_choice
        self._offer(dive(self.graph))
        if self._proven():
            return self.state
        values = self._relax(deadline)
        if values is not None and not self._proven():
            self._integrate(deadline)
        return self.state

    def cost(self, chosen: set[int]) -> int:
        """Cost of a hitting set, on top of the base cost."""
        return sum(self.graph.choices[choice].cost for choice in chosen)

    def _proven(self) -> bool:
        return self.state.bound >= self.cost(self.state.chosen)

    def _offer(self, chosen: set[int]) -> None:
        if not self.state.chosen or self.cost(chosen) < self.cost(self.state.chosen):
            self.state.chosen = chosen
            if self._report is not None:
                self._report(chosen)

    def _raise_bound(self, value: float) -> None:
        units = math.ceil(value / self._unit - TOLERANCE)
        self.state.bound = max(self.state.bound, units * self._unit)

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

    def _run(self, deadline: float) -> bool:
        """Solve the model as it stands; whether the solver ended with an optimum."""
        left = deadline - perf_counter()
        if left <= 0:
            return False
        self._model.clearSolver()
        self._model.setOptionValue("time_limit", left)
        self._model.run()
        return bool(self._model.getModelStatus() == highspy.HighsModelStatus.kOptimal)

    def _relax(self, deadline: float) -> Floats | None:
        """Cut the LP relaxation until no cycle is violated; the LP's solution, or None where time ran out."""
        values = np.zeros(len(self._costs))
        while perf_counter() < deadline:
            cycles = self.finder.violated(self.graph.freedom(values), 1.0 - 1e-3)
            if sum([self._add_row(cycle) for cycle in cycles]) == 0 and self._rows_sent == len(self.state.rows):
                return values
            self._send_rows()
            if not self._run(deadline):
                return None
            self.state.rounds["lp"] += 1
            values = np.array(self._model.getSolution().col_value)
            self._raise_bound(self._model.getInfo().objective_function_value)
            self._offer(dive(self.graph, values))
            if self._proven():
                return values
        return None

    def _integrate(self, deadline: float) -> None:
        """Solve with integer choices, adding the cycles that each solution leaves, until it leaves none."""
        count = len(self._costs)
        kinds = np.full(count, highspy.HighsVarType.kInteger)
        self._model.changeColsIntegrality(count, np.arange(count, dtype=np.int32), kinds)
        self._model.setOptionValue("mip_abs_gap", self._unit - 0.001)
        self._model.setOptionValue("mip_rel_gap", 0.0)
        while perf_counter() < deadline:
            self._send_rows()
            ended = self._run(deadline)
            self.state.rounds["mip"] += 1
            info = self._model.getInfo()
            if math.isfinite(info.mip_dual_bound):
                self._raise_bound(info.mip_dual_bound)
            if not ended or info.primal_solution_status != 2:
                return
            values = np.round(np.array(self._model.getSolution().col_value))
            chosen = {int(choice) for choice in np.flatnonzero(values)}
            if hits_all(self.graph, chosen):
                self._offer(chosen)
                return
            self._offer(dive(self.graph, values))
            if self._proven():
                return
            cycles = self.finder.violated(self.graph.freedom(values), 0.5)
            if sum([self._add_row(cycle) for cycle in cycles]) == 0:
                raise AssertionError("a choice that leaves a cycle violates no row")
