"""CP-SAT behind the same array form: an optional extra, which takes whole numbers alone."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import contextmanager
from threading import Event, Thread
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from smash.planners.milp.arrays import Floats, Ints, Milp, MilpResult, MilpStatus, OnSolution
from smash.planners.milp.solvers.ortools_library import load_cp_model
from smash.problem.errors import Unsupported

if TYPE_CHECKING:
    from collections.abc import Iterator

LONGEST = 1e9
"""Most seconds of a solve."""
ASKED_EVERY = 0.02
"""Seconds between two questions whether to stop."""
WIDEST = 1 << 40
"""Sides and bounds of columns beyond this are taken as infinite."""


def solve(
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
    """Solve a model; arguments and result as in `highs.solve`, every column taken as a whole number.

    A start need not be feasible: it is a hint.

    Raises:
        Unsupported: where ortools is not installed, or a coefficient is no whole number.
    """
    cp_model = load_cp_model()
    began = perf_counter()
    program = cp_model.CpModel()
    _add_columns(program, model)
    _add_rows(program, model)
    if start is not None:
        program.proto.solution_hint.vars.extend(range(model.columns))
        program.proto.solution_hint.values.extend(np.rint(start).astype(np.int64).tolist())
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = threads
    solver.parameters.random_seed = seed
    for name, value in (options or {}).items():
        setattr(solver.parameters, name, value)
    solver.parameters.max_time_in_seconds = min(LONGEST, max(0.0, time_limit - (perf_counter() - began)))
    callback = None if on_solution is None else _callback(cp_model, began, on_solution)
    with _stopped(solver, should_stop):
        ended = solver.solve(program, callback)
    return _result(cp_model, solver, ended, perf_counter() - began)


def _add_columns(program: Any, model: Milp) -> None:
    lower, upper = _whole("a bound", np.ceil(model.lower)), _whole("a bound", np.floor(model.upper))
    for low, high in zip(lower.tolist(), upper.tolist(), strict=True):
        program.proto.variables.add().domain.extend((low, high) if low <= high else (1, 0))
    chosen = np.flatnonzero(model.objective)
    objective = program.proto.objective
    objective.vars.extend(chosen.tolist())
    objective.coeffs.extend(_whole("a cost", model.objective[chosen]).tolist())


def _add_rows(program: Any, model: Milp) -> None:
    matrix = model.matrix
    indices, values = matrix.indices.tolist(), _whole("a coefficient", matrix.data).tolist()
    bounds = matrix.indptr.tolist()
    lower = _whole("a side", np.ceil(model.row_lower)).tolist()
    upper = _whole("a side", np.floor(model.row_upper)).tolist()
    constraints = program.proto.constraints
    for row in range(model.rows):
        first, last = bounds[row], bounds[row + 1]
        linear = constraints.add().linear
        linear.vars.extend(indices[first:last])
        linear.coeffs.extend(values[first:last])
        linear.domain.extend((lower[row], upper[row]) if lower[row] <= upper[row] else (1, 0))


def _whole(what: str, values: Floats) -> Ints:
    """Return values as integers, infinite ones as the widest.

    Raises:
        Unsupported: where one is no whole number.
    """
    rounded = np.rint(np.clip(values, -WIDEST, WIDEST))
    wrong = np.flatnonzero(np.abs(np.clip(values, -WIDEST, WIDEST) - rounded) > 1e-9)
    if len(wrong):
        raise Unsupported(f"CP-SAT takes whole numbers alone, and {what} of the model is {values[wrong[0]]:g}")
    return rounded.astype(np.int64)


def _callback(cp_model: Any, began: float, on_solution: OnSolution) -> Any:
    class Improved(cp_model.CpSolverSolutionCallback):  # type: ignore[misc]
        def on_solution_callback(self) -> None:
            vector = np.array(list(self.response_proto.solution), dtype=float)
            on_solution(perf_counter() - began, float(self.objective_value), vector)

    return Improved()


@contextmanager
def _stopped(solver: Any, should_stop: Callable[[], bool] | None) -> Iterator[None]:
    """Ask beside a solve whether it should stop, and stop it."""
    if should_stop is None:
        yield
        return
    asked, ended = should_stop, Event()

    def watch() -> None:
        while not ended.wait(ASKED_EVERY):
            if asked():
                solver.stop_search()

    watcher = Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()


def _result(cp_model: Any, solver: Any, ended: Any, seconds: float) -> MilpResult:
    has_point = ended in (cp_model.OPTIMAL, cp_model.FEASIBLE)
    status: MilpStatus = "unknown"
    if ended == cp_model.OPTIMAL:
        status = "optimal"
    elif ended == cp_model.FEASIBLE:
        status = "feasible"
    elif ended == cp_model.INFEASIBLE:
        status = "infeasible"
    elif ended == cp_model.MODEL_INVALID:
        raise Unsupported("CP-SAT: the model's numbers are too large")
    return MilpResult(
        status=status,
        objective=float(solver.objective_value) if has_point else None,
        bound=math.inf if status == "infeasible" else float(solver.best_objective_bound),
        vector=np.array(list(solver.response_proto.solution), dtype=float) if has_point else None,
        seconds=seconds,
        nodes=int(solver.num_branches),
    )
