"""The rows of a hitting set in HiGHS: solved as a linear program or with whole choices, rows added and dropped.

HiGHS 1.15 can hang in a warm-started LP after new rows (seen at 200 blocks), so the solver's state is cleared before
each re-solve. A linear program then begins from the basis of the one before, as a program that HiGHS has not seen: on
1,000 blocks that takes a tenth of the time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from time import perf_counter
from typing import Any

import highspy
import numpy as np

from smash.planners.milp.solvers import highs
from smash.planners.precedence.graph import Floats

Row = frozenset[int]


class Relaxation:
    """Rows over 0/1 columns, each asking for so many of its columns; the cheapest columns that fulfil all.

    Attributes:
        values: of the last solution, one per column.
        objective: its cost.
    """

    def __init__(self, costs: Floats, threads: int) -> None:
        self.values: Floats = np.zeros(len(costs))
        self.objective = 0.0
        self._sent: list[tuple[Row, int]] = []
        self._asked: dict[Row, int] = {}
        self._fresh: dict[Row, int] = {}
        self._model = highspy.Highs()
        self._model.silent()
        self._model.setOptionValue("threads", threads)
        self._model.setOptionValue("random_seed", 1)
        count = len(costs)
        if count:
            self._model.addCols(count, costs, np.zeros(count), np.ones(count), 0, [], [], [])

    def add(self, row: Row, needed: int = 1) -> bool:
        """Ask for `needed` of the columns of a row from the next solve on; whether that was not asked for yet."""
        if max(self._asked.get(row, 0), self._fresh.get(row, 0)) >= needed:
            return False
        self._fresh[row] = needed
        return True

    @property
    def waiting(self) -> bool:
        """Whether rows were added since the last solve."""
        return bool(self._fresh)

    def tight(self, slack: float, longest: int) -> list[Row]:
        """Return the rows of at most `longest` columns that the values exceed by less than `slack`."""
        return [row for row, needed in self._sent if len(row) <= longest and self._excess(row, needed) < slack]

    def drop_slack(self, slack: float) -> None:
        """Drop the rows that the values exceed by more than `slack`."""
        kept = [self._excess(row, needed) <= slack for row, needed in self._sent]
        dropped = np.flatnonzero(~np.array(kept, dtype=bool))
        if len(dropped):
            self._model.deleteRows(len(dropped), dropped.astype(np.int32))
            self._sent = [asked for asked, keep in zip(self._sent, kept, strict=True) if keep]
            self._asked = {}
            self._note(self._sent)

    def _excess(self, row: Row, needed: int) -> float:
        return float(self.values[list(row)].sum()) - needed

    def solve(self, deadline: float) -> bool:
        """Solve the linear program; whether it ended with an optimum before `deadline` [s, `time.perf_counter`]."""
        self._set_kind(highspy.HighsVarType.kContinuous)
        if not self._run(deadline):
            return False
        self.values = np.array(self._model.getSolution().col_value)
        self.objective = float(self._model.getInfo().objective_function_value)
        return True

    def solve_whole(
        self, deadline: float, known: Iterable[int], gap: float, on_bound: Callable[[float], object]
    ) -> Floats | None:
        """Solve with whole columns, from a `known` solution.

        Args:
            deadline: when to stop, in seconds of `time.perf_counter`.
            known: columns that fulfil all rows.
            gap: a bound and a cost this near prove an optimum.
            on_bound: called with bounds on the cost as they rise.

        Returns:
            The optimum's values, or None where the solver was stopped before.
        """
        self._set_kind(highspy.HighsVarType.kInteger)
        self._model.setOptionValue("mip_abs_gap", gap)
        self._model.setOptionValue("mip_rel_gap", 0.0)

        def watch(event: Any) -> None:
            on_bound(float(event.data_out.mip_dual_bound))

        self._model.cbMipInterrupt += watch
        try:
            ended = self._run(deadline, set(known))
        finally:
            self._model.cbMipInterrupt -= watch
        info = self._model.getInfo()
        on_bound(float(info.mip_dual_bound))
        if not ended or info.primal_solution_status != highs.FEASIBLE_POINT:
            return None
        return np.round(np.array(self._model.getSolution().col_value))

    def _set_kind(self, kind: highspy.HighsVarType) -> None:
        count = len(self.values)
        self._model.changeColsIntegrality(count, np.arange(count, dtype=np.int32), np.full(count, kind))

    def _run(self, deadline: float, known: set[int] | None = None) -> bool:
        left = deadline - perf_counter()
        if left <= 0:
            return False
        self._send()
        basis = self._model.getBasis()
        self._model.clearSolver()
        if known is None and basis.valid:
            self._model.setBasis(basis)
        # HiGHS counts the runs of an object together.
        self._model.setOptionValue("time_limit", left + self._model.getRunTime())
        if known is not None:
            solution = highspy.HighsSolution()
            solution.col_value = [float(column in known) for column in range(len(self.values))]
            self._model.setSolution(solution)
        highs.run(self._model)
        return bool(self._model.getModelStatus() == highspy.HighsModelStatus.kOptimal)

    def _send(self) -> None:
        if not self._fresh:
            return
        fresh = [(sorted(row), needed) for row, needed in self._fresh.items()]
        starts = np.concatenate(([0], np.cumsum([len(row) for row, _ in fresh])[:-1])).astype(np.int32)
        columns = np.array([column for row, _ in fresh for column in row], dtype=np.int32)
        needed = np.array([needed for _, needed in fresh], dtype=float)
        infinity = np.full(len(fresh), highspy.kHighsInf)
        self._model.addRows(len(fresh), needed, infinity, len(columns), starts, columns, np.ones(len(columns)))
        self._sent.extend(self._fresh.items())
        self._note(self._fresh.items())
        self._fresh = {}

    def _note(self, asked: Iterable[tuple[Row, int]]) -> None:
        for row, needed in asked:
            self._asked[row] = max(needed, self._asked.get(row, 0))
