"""HiGHS behind the array form of a MILP: anytime, interruptible, one thread by default."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from threading import TIMEOUT_MAX, Event, Thread
from time import perf_counter
from typing import Any

import numpy as np

from smash.planners.milp.arrays import Floats, Milp, MilpResult, MilpStatus, OnSolution
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import replacing

LARGE = 100_000
"""Nonzeros from which on HiGHS may overlook its time limit for long."""
LATE = 0.1
"""Seconds that it has to come to its end."""
FEASIBLE_POINT = 2
"""`primal_solution_status` of a result that holds a feasible point, whatever ended the solve."""


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
    cutoff: float | None = None,
    options: dict[str, Any] | None = None,
) -> MilpResult:
    """Solve a model.

    Args:
        model: the model.
        time_limit: wall time [s], handing over the model included.
        threads: threads of HiGHS.
        seed: its random seed.
        start: a feasible vector, shape (n,), to start from.
        on_solution: called with each better solution, the start excepted.
        should_stop: asked often; the solve ends where it returns True.
        absolute_gap: bound and best objective this near prove optimality; 0.999 is sound for integer objectives.
        cutoff: solutions that are not below it are of no interest.
        options: further options of HiGHS by name.
    """
    began, over = perf_counter(), Event()
    solver = _loaded(model)
    settings = {
        "time_limit": max(0.0, time_limit - (perf_counter() - began)),
        "threads": threads,
        "random_seed": seed,
        "mip_abs_gap": absolute_gap,
        "mip_rel_gap": 0.0,
        **({} if cutoff is None else {"objective_bound": cutoff}),
        **(options or {}),
    }
    for name, value in settings.items():
        solver.setOptionValue(name, value)
    if start is not None:
        _set_start(solver, start)
    _listen(solver, began, over, on_solution, should_stop)
    if len(model.matrix.data) <= LARGE:
        run(solver)
    elif not _run_until(solver, began + time_limit + LATE):
        over.set()
        return MilpResult("unknown", None, -np.inf, None, perf_counter() - began, 0)
    return _result(solver, model, perf_counter() - began)


def _listen(
    solver: Any,
    began: float,
    over: Event,
    on_solution: OnSolution | None,
    should_stop: Callable[[], bool] | None,
) -> None:
    """Have HiGHS tell of better solutions, and ask whether to go on; once it is `over`, neither."""
    if on_solution is not None:
        report = on_solution

        def improved(event: Any) -> None:
            if not over.is_set():
                found = event.data_out
                report(perf_counter() - began, found.objective_function_value, np.array(found.mip_solution))

        solver.cbMipImprovingSolution += improved
    if should_stop is not None:
        asked = should_stop

        def interrupt(event: Any) -> None:
            if over.is_set() or asked():
                event.interrupt()

        solver.cbMipInterrupt += interrupt


def _run_until(solver: Any, end: float) -> bool:
    """Run HiGHS on a large model, and leave it where it does not end in time; whether it has ended.

    Its presolve looks at the clock between rules alone, which on large models is seconds apart. What is left runs to
    its next look, where its own time limit ends it.
    """
    raised: list[BaseException] = []

    def go() -> None:
        try:
            run(solver)
        except BaseException as error:
            raised.append(error)

    running = Thread(target=go, daemon=True)
    running.start()
    running.join(min(TIMEOUT_MAX, max(0.0, end - perf_counter())))
    for error in raised:
        raise error
    return not running.is_alive()


def run(solver: Any) -> None:
    """Run HiGHS, with whatever number of threads it ran before.

    It keeps the threads of the first run, and refuses to run with another number of them until they are given up.
    """
    import highspy

    refused = solver.run() == highspy.HighsStatus.kError
    if refused and solver.getModelStatus() == highspy.HighsModelStatus.kNotset:
        highspy.Highs.resetGlobalScheduler(True)
        solver.run()


def write(model: Milp, path: Path) -> None:
    """Write a model to a file that any solver reads (`.mps` or `.lp`), with the names of its columns.

    Raises:
        MalformedFile: where the suffix is neither, or the file cannot be written.
    """
    import highspy

    if path.suffix not in (".mps", ".lp"):
        raise MalformedFile(str(path), "a model file ends in .mps or .lp")
    solver = _loaded(model)
    for column in range(model.columns):
        solver.passColName(column, model.name(column))
    with replacing(path) as whole:
        whole.touch()  # HiGHS ends the process where it cannot open a file
        if solver.writeModel(str(whole)) == highspy.HighsStatus.kError:
            raise MalformedFile(str(path), "cannot be written")


def _loaded(model: Milp) -> Any:
    import highspy

    solver = highspy.Highs()
    solver.silent()
    program = highspy.HighsLp()
    program.num_col_ = model.columns
    program.num_row_ = model.rows
    program.col_cost_ = model.objective
    program.col_lower_ = model.lower
    program.col_upper_ = model.upper
    program.row_lower_ = model.row_lower
    program.row_upper_ = model.row_upper
    program.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    program.a_matrix_.start_ = model.matrix.indptr
    program.a_matrix_.index_ = model.matrix.indices
    program.a_matrix_.value_ = model.matrix.data
    kinds = (highspy.HighsVarType.kContinuous, highspy.HighsVarType.kInteger)
    program.integrality_ = [kinds[int(flag)] for flag in model.integral]
    solver.passModel(program)
    return solver


def _set_start(solver: Any, start: Floats) -> None:
    import highspy

    point = highspy.HighsSolution()
    point.col_value = list(start)
    solver.setSolution(point)


def _result(solver: Any, model: Milp, seconds: float) -> MilpResult:
    import highspy

    info = solver.getInfo()
    ended = solver.getModelStatus()
    has_point = info.primal_solution_status == FEASIBLE_POINT and model.columns > 0
    if model.columns == 0:
        feasible = bool((model.row_lower <= 0).all() and (model.row_upper >= 0).all())
        empty = np.zeros(0)
        return MilpResult("optimal" if feasible else "infeasible", 0.0 if feasible else None, 0.0, empty, seconds, 0)
    status: MilpStatus
    if ended == highspy.HighsModelStatus.kOptimal:
        status = "optimal"
    elif ended in (highspy.HighsModelStatus.kInfeasible, highspy.HighsModelStatus.kUnboundedOrInfeasible):
        status = "infeasible"
    else:
        status = "feasible" if has_point else "unknown"
    bound = float(info.mip_dual_bound) if model.integral.any() else float(info.objective_function_value)
    return MilpResult(
        status=status,
        objective=float(info.objective_function_value) if has_point else None,
        bound=bound,
        vector=np.array(solver.getSolution().col_value) if has_point else None,
        seconds=seconds,
        nodes=max(0, int(info.mip_node_count)),
    )
