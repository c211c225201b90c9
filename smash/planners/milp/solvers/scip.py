"""SCIP behind the same array form: an optional extra."""

from __future__ import annotations

import math
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np

from smash.planners.milp.arrays import Floats, Milp, MilpResult, MilpStatus, OnSolution
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
    """Solve a model; arguments and result as in `highs.solve`. SCIP searches on one thread; its LPs may use more.

    Raises:
        Unsupported: where pyscipopt is not installed.
    """
    require("SCIP", "pyscipopt")
    import pyscipopt

    began = perf_counter()
    program = pyscipopt.Model()
    program.hideOutput()
    columns = _add_columns(program, model)
    _add_rows(pyscipopt, program, columns, model)
    if start is not None:
        solution = program.createSol()
        for column, value in zip(columns, start.tolist(), strict=True):
            program.setSolVal(solution, column, value)
        program.addSol(solution)
    settings = {
        "limits/time": max(0.0, time_limit - (perf_counter() - began)),
        "limits/absgap": absolute_gap,
        "limits/gap": 0.0,
        "lp/threads": threads,
        "randomization/randomseedshift": seed,
        **(options or {}),
    }
    program.setParams(settings)
    handler = _listener(pyscipopt, columns, began, on_solution, should_stop)
    program.includeEventhdlr(handler, "smash", "better solutions, and whether to stop")
    program.optimize()
    return _result(program, columns, perf_counter() - began)


def _add_columns(program: Any, model: Milp) -> list[Any]:
    sides = (part.tolist() for part in (model.lower, model.upper, model.objective, model.integral))
    return [
        program.addVar(
            vtype="I" if integral else "C",
            lb=None if math.isinf(low) else low,
            ub=None if math.isinf(high) else high,
            obj=cost,
        )
        for low, high, cost, integral in zip(*sides, strict=True)
    ]


def _add_rows(pyscipopt: Any, program: Any, columns: list[Any], model: Milp) -> None:
    matrix = model.matrix
    indices, values, bounds = matrix.indices.tolist(), matrix.data.tolist(), matrix.indptr.tolist()
    terms = [pyscipopt.scip.Term(column) for column in columns]
    sides = zip(model.row_lower.tolist(), model.row_upper.tolist(), strict=True)
    for row, (low, high) in enumerate(sides):
        entries = range(bounds[row], bounds[row + 1])
        if not entries:  # SCIP takes no row without a column
            if low > 0 or high < 0:
                program.addCons(columns[0] >= model.upper[0] + 1)
            continue
        expression = pyscipopt.scip.Expr({terms[indices[entry]]: values[entry] for entry in entries})
        below, above = None if math.isinf(low) else low, None if math.isinf(high) else high
        if below is not None or above is not None:
            program.addCons(pyscipopt.scip.ExprCons(expression, below, above))


def _listener(
    pyscipopt: Any,
    columns: list[Any],
    began: float,
    on_solution: OnSolution | None,
    should_stop: Callable[[], bool] | None,
) -> Any:
    types = pyscipopt.SCIP_EVENTTYPE
    asked = types.FIRSTLPSOLVED | types.LPSOLVED | types.NODEFOCUSED
    heard = asked | types.BESTSOLFOUND

    class Listener(pyscipopt.Eventhdlr):  # type: ignore[misc]
        def eventinit(self) -> None:
            self.model.catchEvent(heard, self)

        def eventexit(self) -> None:
            self.model.dropEvent(heard, self)

        def eventexec(self, event: Any) -> None:
            if event.getType() == types.BESTSOLFOUND and on_solution is not None:
                best = self.model.getBestSol()
                vector = np.array([self.model.getSolVal(best, column) for column in columns])
                on_solution(perf_counter() - began, float(self.model.getSolObjVal(best)), vector)
            if should_stop is not None and should_stop():
                self.model.interruptSolve()

    return Listener()


def _result(program: Any, columns: list[Any], seconds: float) -> MilpResult:
    has_point = program.getNSols() > 0
    ended = program.getStatus()
    status: MilpStatus = "feasible" if has_point else "unknown"
    if ended in ("optimal", "gaplimit"):
        status = "optimal"
    elif ended in ("infeasible", "inforunbd"):
        status = "infeasible"
    bound = math.inf if status == "infeasible" else float(program.getDualbound())
    best = program.getBestSol() if has_point else None
    return MilpResult(
        status=status,
        objective=float(program.getSolObjVal(best)) if has_point else None,
        bound=-math.inf if bound <= -program.infinity() else bound,
        vector=np.array([program.getSolVal(best, column) for column in columns]) if has_point else None,
        seconds=seconds,
        nodes=int(program.getNTotalNodes()),
    )
