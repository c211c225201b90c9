"""The array form of a MILP: all solvers give the same optimum, starts are taken, files are written."""

import sys

import numpy as np
import pytest

from smash.planners.milp.arrays import MilpBuilder, SparseRows
from smash.planners.milp.solvers import NEEDS, cpsat, gurobi, highs, load_solver, scip
from smash.planners.protocol import SOLVERS, Settings
from smash.problem import MalformedFile, Unsupported


def cover(seed=0, elements=12, sets=20):
    """Return a random set-cover model."""
    draw = np.random.default_rng(seed)
    builder = MilpBuilder()
    columns = builder.add_columns(sets, cost=draw.integers(1, 5, sets))
    member = draw.random((elements, sets)) < 0.3
    member[:, 0] = True
    rows, where = np.nonzero(member)
    builder.add_rows(rows, columns[where], 1.0, count=elements, lower=1.0)
    return builder.build(name=lambda j: f"take_{j}")


def test_every_better_solution_is_reported_with_its_objective():
    model, seen = cover(3, 40, 80), []
    result = highs.solve(model, time_limit=10, on_solution=lambda t, value, vector: seen.append((t, value, vector)))
    assert seen
    assert all(value == pytest.approx(model.objective @ vector) for _, value, vector in seen)
    assert seen[-1][1] == pytest.approx(result.objective)


def test_a_contradiction_is_infeasible():
    builder = MilpBuilder()
    column = builder.add_columns(1)
    builder.add_row(column, 1.0, lower=0.4, upper=0.6)
    assert highs.solve(builder.build(), time_limit=5).status == "infeasible"


def test_a_model_without_columns_is_solved():
    assert highs.solve(MilpBuilder().build(), time_limit=5).status == "optimal"


def test_a_solve_ends_where_it_is_asked_to():
    asked = []
    result = highs.solve(cover(1, 300, 600), time_limit=100, should_stop=lambda: asked.append(True) or True)
    assert asked
    assert result.status != "optimal"
    assert result.nodes <= 1


@pytest.mark.parametrize("threads", [(1, 2, 1), (2, 2, 3)])
def test_each_solve_may_have_another_number_of_threads(threads):
    assert [highs.solve(cover(), time_limit=10, threads=count).status for count in threads] == ["optimal"] * 3


def test_a_model_is_written_with_the_names_of_its_columns(tmp_path):
    highs.write(cover(), tmp_path / "m.mps")
    assert "take_3" in (tmp_path / "m.mps").read_text()
    with pytest.raises(MalformedFile):
        highs.write(cover(), tmp_path / "m.txt")


def test_a_start_is_taken_and_nothing_worse_is_reported():
    model, seen = cover(3, 40, 80), []
    best = highs.solve(model, time_limit=60)
    again = highs.solve(
        model, time_limit=60, start=best.vector, on_solution=lambda t, value, vector: seen.append(value)
    )
    assert again.objective == pytest.approx(best.objective)
    assert seen == pytest.approx([best.objective] * len(seen))


def test_the_bound_of_a_proven_optimum_is_its_objective():
    result = highs.solve(cover(2), time_limit=60, absolute_gap=1e-6)
    assert (result.status, result.bound) == ("optimal", pytest.approx(result.objective))


def test_without_gurobipy_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "gurobipy", None)
    with pytest.raises(Unsupported, match=r"gurobipy: pip install 'smash-testbed\[gurobi\]'"):
        gurobi.solve(cover(), time_limit=1)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("rows", "columns", "entries"), [(0, 0, 0), (3, 4, 0), (5, 3, 40), (20, 30, 50)])
def test_a_matrix_of_entries_adds_up_what_lies_at_one_place(seed, rows, columns, entries):
    draw = np.random.default_rng(seed)
    at, where = draw.integers(0, max(rows, 1), entries), draw.integers(0, max(columns, 1), entries)
    values, vector = draw.choice([-1.0, 1.0, 2.0], entries), draw.integers(-5, 5, columns).astype(float)
    dense = np.zeros((rows, columns))
    np.add.at(dense, (at, where), values)
    matrix = SparseRows.of_entries(at, where, values, (rows, columns))
    assert np.array_equal(matrix @ vector, dense @ vector)
    spans = [matrix.indices[begin:end] for begin, end in zip(matrix.indptr, matrix.indptr[1:], strict=False)]
    assert all((np.diff(span) > 0).all() for span in spans)
    assert matrix.nnz == len({*zip(at, where, strict=True)}) == len(matrix.indices)


SOLVES = {"highs": highs, "cpsat": cpsat, "scip": scip, "gurobi": gurobi}


@pytest.fixture(params=SOLVES)
def solver(request):
    for module in NEEDS[request.param]:
        pytest.importorskip(module)
    return SOLVES[request.param]


def test_every_solver_that_can_be_named_is_there():
    assert set(SOLVES) == set(NEEDS) == set(SOLVERS)


@pytest.mark.parametrize("seed", range(3))
def test_all_solvers_prove_the_same_optimum(solver, seed):
    model, seen = cover(seed), []
    theirs = solver.solve(model, time_limit=60, seed=seed, on_solution=lambda t, value, vector: seen.append(vector))
    ours = highs.solve(model, time_limit=60)
    assert theirs.status == "optimal"
    assert theirs.objective == pytest.approx(ours.objective)
    assert ours.objective - 0.999 <= theirs.bound <= ours.objective + 1e-6
    assert all(model.violation(vector) < 1e-6 for vector in [theirs.vector, *seen])
    assert min(model.objective @ vector for vector in [theirs.vector, *seen]) == pytest.approx(ours.objective)


def test_all_solvers_take_a_start(solver):
    model = cover(3, 40, 80)
    best = highs.solve(model, time_limit=60)
    assert solver.solve(model, time_limit=60, start=best.vector).objective == pytest.approx(best.objective)


def test_all_solvers_prove_that_there_is_no_solution(solver):
    builder = MilpBuilder()
    column = builder.add_columns(2)
    builder.add_row(column, 1.0, lower=3)
    result = solver.solve(builder.build(), time_limit=60)
    assert (result.status, result.objective, result.vector) == ("infeasible", None, None)


def test_all_solvers_end_where_they_are_asked_to(solver):
    asked = []
    result = solver.solve(cover(1, 300, 600), time_limit=60, should_stop=lambda: asked.append(True) or True)
    assert result.status != "optimal" or solver is gurobi  # which may prove it in its presolve
    assert asked or solver is gurobi


def test_cpsat_takes_whole_numbers_alone():
    pytest.importorskip("ortools")
    builder = MilpBuilder()
    builder.add_row(builder.add_columns(1), 0.5, upper=1)
    with pytest.raises(Unsupported, match=r"whole numbers alone, and a coefficient of the model is 0\.5"):
        cpsat.solve(builder.build(), time_limit=1)


@pytest.mark.parametrize(("solver", "module", "extra"), [("cpsat", "ortools", "cp-sat"), ("scip", "pyscipopt", "scip")])
def test_without_its_package_a_solvers_extra_is_named(monkeypatch, solver, module, extra):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(Unsupported, match=rf"--solver {solver} needs {module}: pip install 'smash-testbed\[{extra}\]'"):
        load_solver(Settings(solver=solver))
