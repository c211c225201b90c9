"""Gurobi behind the same array form: an optional extra, whose free licence takes models up to 2,000 x 2,000."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np

from smash.planners.milp.arrays import Floats, Milp, MilpResult, MilpStatus, OnSolution
from smash.problem.errors import Unsupported
from smash.problem.extras import require


def solve(
    model: Milp,
    *,
    time_limit: float,
    threads: int = 1,
    seed: int = 0,
    start: Floats | None = None,
    on_solution: OnSolution | None = None,
    should_stop: Callable[[], bool] | None = None,
    absolute_gap: float = 0.999,
    options: dict[str, Any] | None = None,
) -> MilpResult:
    """Solve a model; arguments and result as in `highs.solve`.

    Raises:
        Unsupported: where gurobipy is not installed, or its licence does not take a model of this size.
    """
    require("Gurobi", "gurobipy", "scipy")
    import gurobipy
    import scipy.sparse  # noqa: F401 - gurobipy takes its matrices

    began = perf_counter()
    try:
        with gurobipy.Env(params={"OutputFlag": 0}) as environment, gurobipy.Model(env=environment) as program:
            settings = {"TimeLimit": max(0.0, time_limit), "Threads": threads, "Seed": seed, "MIPGapAbs": absolute_gap}
            for name, value in {**settings, "MIPGap": 0.0, **(options or {})}.items():
                program.setParam(name, value)
            kinds: Any = ["I" if flag else "C" for flag in model.integral]
            columns: Any = program.addMVar(
                model.columns, lb=model.lower, ub=model.upper, obj=model.objective, vtype=kinds
            )
            _add_rows(program, columns, model)
            if start is not None:
                columns.Start = start
            program.optimize(_callback(columns, began, on_solution, should_stop))
            return _result(program, columns, perf_counter() - began)
    except gurobipy.GurobiError as error:
        raise Unsupported(f"Gurobi: {error}") from None


def _add_rows(program: Any, columns: Any, model: Milp) -> None:
    from scipy.sparse import csr_array

    compressed = (model.matrix.data, model.matrix.indices, model.matrix.indptr)
    matrix = csr_array(compressed, shape=(model.rows, model.columns))
    equal = model.row_lower == model.row_upper
    below = ~equal & np.isfinite(model.row_upper)
    above = ~equal & np.isfinite(model.row_lower)
    for chosen, sense, side in (
        (equal, "=", model.row_upper),
        (below, "<", model.row_upper),
        (above, ">", model.row_lower),
    ):
        if chosen.any():
            program.addMConstr(matrix[chosen], columns, sense, side[chosen])


def _callback(
    columns: Any, began: float, on_solution: OnSolution | None, should_stop: Callable[[], bool] | None
) -> Callable[[Any, int], None]:
    from gurobipy import GRB

    def called(program: Any, where: int) -> None:
        if where == GRB.Callback.MIPSOL and on_solution is not None:
            value = program.cbGet(GRB.Callback.MIPSOL_OBJ)
            on_solution(perf_counter() - began, value, np.array(program.cbGetSolution(columns)))
        if should_stop is not None and should_stop():
            program.terminate()

    return called


def _result(program: Any, columns: Any, seconds: float) -> MilpResult:
    from gurobipy import GRB

    has_point = program.SolCount > 0
    status: MilpStatus
    if program.Status == GRB.OPTIMAL:
        status = "optimal"
    elif program.Status in (GRB.INFEASIBLE, GRB.INF_OR_UNBD):
        status = "infeasible"
    else:
        status = "feasible" if has_point else "unknown"
    return MilpResult(
        status=status,
        objective=float(program.ObjVal) if has_point else None,
        bound=float(program.ObjBound) if status != "infeasible" else float("inf"),
        vector=np.array(columns.X) if has_point else None,
        seconds=seconds,
        nodes=int(program.NodeCount),
    )
