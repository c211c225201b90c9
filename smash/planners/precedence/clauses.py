"""Choices of the least cost that fulfil clauses: by core-guided MaxSAT, or by HiGHS.

A literal is a variable's number, from 1 on, negative where the variable must be false; a clause asks for one of its
literals. Variables have costs, which count where they are true.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from smash.planners.milp.arrays import MilpBuilder, OutOfTime
from smash.planners.milp.solvers import highs
from smash.planners.precedence.graph import Floats

if TYPE_CHECKING:
    from smash.planners.precedence.maxsat import MaxSat

Clause = tuple[int, ...]


@dataclass(slots=True)
class Clauses:
    """The variables' costs, the clauses, and rows that ask for so many of their variables.

    Attributes:
        costs: per variable, in whole units.
        asked: the clauses.
        counts: pairs of variables and how many of them must be true.
    """

    costs: list[int] = field(default_factory=list)
    asked: dict[Clause, None] = field(default_factory=dict)
    counts: list[tuple[Clause, int]] = field(default_factory=list)

    def variable(self, cost: int = 0) -> int:
        """Add a variable and return its literal."""
        self.costs.append(cost)
        return len(self.costs)

    def ask(self, literals: Iterable[int]) -> bool:
        """Add a clause; whether it is new."""
        clause = tuple(sorted(set(literals)))
        known = clause in self.asked
        self.asked[clause] = None
        return not known


class Cheapest:
    """Finds the cheapest variables for clauses that become more and more.

    Args:
        clauses: those known at first; further ones are looked for at each `solve`.
        on_bound: called at once with every better bound on the cost; says whether to go on.
        threads: HiGHS' threads.
        maxsat: whether core-guided MaxSAT solves them, or HiGHS.
    """

    def __init__(
        self, clauses: Clauses, on_bound: Callable[[int], bool], threads: int = 1, maxsat: bool = True
    ) -> None:
        self._clauses = clauses
        self._on_bound = on_bound
        self._threads = threads
        self._bound = 0
        self._sent = 0
        self._core_guided: MaxSat | None = None
        self._unit = math.gcd(*clauses.costs) or 1
        if maxsat:
            from smash.planners.precedence.maxsat import MaxSat

            weights = [cost // self._unit for cost in clauses.costs]
            self._core_guided = MaxSat(weights, clauses.asked, clauses.counts, self._raise_bound)
            self._sent = len(clauses.asked)

    def solve(self, deadline: float) -> Floats | None:
        """Return values of the variables that fulfil all clauses for the least cost, None where stopped before.

        Args:
            deadline: when to stop [s, `perf_counter`]; not to be called again once it was stopped.
        """
        if self._core_guided is None:
            return self._integrate(deadline)
        for clause in list(self._clauses.asked)[self._sent :]:
            self._core_guided.add(clause)
        self._sent = len(self._clauses.asked)
        return self._core_guided.solve(deadline)

    def close(self) -> None:
        """Free the solver's memory."""
        if self._core_guided is not None:
            self._core_guided.close()

    def _raise_bound(self, units: int) -> bool:
        self._bound = max(self._bound, units * self._unit)
        return self._on_bound(self._bound)

    def _integrate(self, deadline: float) -> Floats | None:
        try:
            builder = MilpBuilder(deadline)
            builder.add_columns(len(self._clauses.costs), cost=np.array(self._clauses.costs, dtype=float))
            for clause in self._clauses.asked:
                self._row(builder, clause, 1)
            for variables, count in self._clauses.counts:
                self._row(builder, variables, count)
            milp = builder.build()
        except OutOfTime:
            return None
        left = deadline - perf_counter()
        solved = highs.solve(milp, time_limit=left, threads=self._threads, seed=1, absolute_gap=self._unit - 0.001)
        if math.isfinite(solved.bound):
            self._raise_bound(math.ceil(solved.bound / self._unit - 1e-6))
        return np.round(solved.vector) if solved.status == "optimal" and solved.vector is not None else None

    def _row(self, builder: MilpBuilder, clause: Sequence[int], count: int) -> None:
        signs = [1.0 if literal > 0 else -1.0 for literal in clause]
        columns = [abs(literal) - 1 for literal in clause]
        needed = count - sum(literal < 0 for literal in clause)
        builder.add_rows([0] * len(clause), columns, signs, count=1, lower=needed)
