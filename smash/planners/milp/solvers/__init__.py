"""MILP solvers behind one array form: what a solver is, and the one place that chooses one."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any, Protocol

from smash.planners.milp.arrays import Floats, Milp, MilpResult, OnSolution
from smash.planners.protocol.settings import HIGHS, Settings
from smash.problem.extras import require

NEEDS = {"highs": ("highspy",), "cpsat": ("ortools",), "scip": ("pyscipopt",), "gurobi": ("gurobipy", "scipy")}
"""Solver -> the modules that it needs."""


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
    """Return the solver of a solve; nothing is loaded before it is asked for."""
    solve: Solver = import_module(f"{__name__}.{settings.solver}").solve
    return solve


def require_solver(name: str) -> None:
    """Refuse a solver that is not installed.

    Raises:
        MissingExtra: with the line that installs it.
    """
    if name != HIGHS:  # it comes with the package
        require(f"--solver {name}", *NEEDS[name])


def load_solver(settings: Settings) -> None:
    """Import a solver's library, so that no import is counted as planning.

    Raises:
        MissingExtra: where it is not installed.
    """
    require_solver(settings.solver)
    solver_of(settings)
    if settings.solver == "cpsat":
        from smash.planners.milp.solvers.ortools_library import load_cp_model

        load_cp_model()
    else:
        import_module(NEEDS[settings.solver][0])
