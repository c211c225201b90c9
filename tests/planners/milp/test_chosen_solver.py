"""The solver behind a planner's MILPs: chosen by name, refused where there is none, and the same optima from each."""

import pytest

from smash.planners.flow import FlowPlanner
from smash.planners.layered import LayeredPlanner
from smash.planners.milp.solvers import NEEDS
from smash.planners.protocol import SOLVERS, Settings, SolveOptions, why_refused
from smash.planners.registry import COMMAND, get_planner, planner_names
from smash.problem import PlanOptions
from smash.problem.buffers import with_buffers
from smash.problem.errors import Unsupported
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.sets.suites import read_suite
from tests.oracle import optimal_cost
from tests.relations import related

WITH_MILP = {"smash", "smash-flow", "smash-layered"}


@pytest.fixture(params=[solver for solver in SOLVERS if solver != "gurobi"])
def solver(request):
    for module in NEEDS[request.param]:
        pytest.importorskip(module)
    return request.param


@pytest.mark.parametrize("name", sorted({*planner_names()} - {COMMAND}))  # which is nobody without a program
def test_planners_without_a_milp_take_no_solver_and_no_warm_start(name):
    try:
        planner = get_planner(name)
    except Unsupported as error:
        pytest.skip(str(error))
    simple = Problem(read_suite("multi-4")[0])
    for settings, words in (
        (Settings(solver="cpsat"), "it has no MILP that `--solver cpsat` could solve"),
        (Settings(warm_start="greedy"), "it has no MILP that `--warm-start greedy` could start"),
    ):
        assert why_refused(planner, simple, settings) == (None if name in WITH_MILP else words)
    assert why_refused(planner, simple, Settings()) is None


@pytest.mark.parametrize("name", sorted({*planner_names()} - {COMMAND}))
def test_planners_without_a_time_index_take_no_horizon(name):
    try:
        planner = get_planner(name)
    except Unsupported as error:
        pytest.skip(str(error))
    reason = why_refused(planner, Problem(read_suite("multi-4")[0]), Settings(horizon=3))
    words = "it has no model with an index of time that `--horizon 3` could be for"
    assert reason == (None if name in WITH_MILP | {"cp-sat", "clingo"} else words)


@pytest.mark.parametrize("planner", [FlowPlanner(), LayeredPlanner()], ids=["flow", "layered"])
@pytest.mark.parametrize("seed", range(6))
def test_every_solver_gives_the_optimum(planner, solver, seed):
    (instance,) = generate("multi", 4, buffers=seed % 4, count=1, seed=seed)
    options = PlanOptions(topple=seed % 3 > 0, max_topple=2 if seed == 5 else None)
    made = Problem(instance, options)
    planner.load_solver(Settings(solver=solver))
    answer = planner.plan(made, Settings(solver=solver), 60)
    assert (answer.status, answer.cost) == ("optimal", optimal_cost(instance, options))


@pytest.mark.parametrize("planner", [FlowPlanner(), LayeredPlanner()], ids=["flow", "layered"])
@pytest.mark.parametrize("seed", range(12))
def test_cpsat_agrees_with_exhaustive_search_on_relations(planner, seed):
    pytest.importorskip("ortools")
    made = related(seed, most_blocks=3)
    if why_refused(planner, made, Settings(solver="cpsat")) is not None:
        pytest.skip("unsupported")
    answer = planner.plan(made, Settings(solver="cpsat"), 20)
    cost = optimal_cost(made.instance, made.options)
    assert (answer.cost, answer.status) == (cost, "infeasible" if cost is None else "optimal")


def test_a_warm_start_by_a_planner_without_a_milp_leaves_the_solver_to_the_model():
    pytest.importorskip("ortools")
    answer = FlowPlanner().plan(Problem(read_suite("multi-4")[0]), Settings(warm_start="greedy", solver="cpsat"), 30)
    assert answer.status == "optimal"
    assert answer.incumbents[0].origin == "greedy"


@pytest.mark.parametrize("seed", range(4))
def test_the_layered_model_has_a_plan_without_buffers_and_topples_at_nine_blocks(seed):
    made = Problem(with_buffers(read_suite("multi-9")[seed], 0), PlanOptions(topple=False))
    assert LayeredPlanner().solve(made.instance, SolveOptions(topple=False), 2).actions is not None
