"""MILP solvers behind one array form: what a solver is, and the one place that chooses one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from smash.planners.milp.arrays import Floats, Milp, MilpResult, OnSolution
from smash.planners.protocol.settings import Settings


class Solver(Protocol):
    """A solver: `smash.planners.milp.solvers.highs.solve` says what its arguments are."""

    def __call__(
        self,
        model: Milp,
        *,
        time_limit: float,
        threads: int = 1,
        seed: int = 0,
        start: Floats | None = None,
        on_solution: OnSolution | None = None,
        should_stop: Callable[[], bool] | None = None,
        options: dict[str, Any] | None = None,
    ) -> MilpResult:
        """Solve a model."""
        ...


def solver_of(settings: Settings) -> Solver:
    """Return the solver of a solve, which is HiGHS; nothing is loaded before it is asked for."""
    from smash.planners.milp.solvers import highs

    return highs.solve
