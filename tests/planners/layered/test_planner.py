"""The layered model: its proofs are exhaustive search's, its plans the law's."""

from math import inf
from time import perf_counter

import pytest
from hypothesis import given, settings

from smash.planners.layered import LayeredPlanner
from smash.planners.layered.blocks import MovingBlocks
from smash.planners.layered.events import build_layered
from smash.planners.layered.plain_positions import build_plain_positions
from smash.planners.layered.resting import build_resting
from smash.planners.milp import solving
from smash.planners.milp.arrays import OutOfTime
from smash.planners.protocol import Settings, SolveLog, SolveOptions
from smash.problem import Costs, Law, StacksGoal, make_instance
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.sets.suites import read_suite
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options


def solve(instance, options, budget=20.0, **settings):
    return LayeredPlanner().solve(instance, SolveOptions(options.topple, options.max_topple, **settings), budget)


def judge(instance, options, result):
    """Hold a result to exhaustive search."""
    optimum = optimal_cost(instance, options)
    if result.actions is not None:
        assert Law(instance, options).check(result.actions).accepted
        assert len(result.actions) >= optimum
    if result.status == "optimal":
        assert len(result.actions) == optimum
    if result.status == "infeasible":
        assert optimum is None
    elif optimum is not None and result.lower_bound is not None:
        assert result.lower_bound <= optimum


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4), plan_options())
def test_what_is_proven_is_true(instance, options):
    judge(instance, options, solve(instance, options))


@pytest.mark.slow
@settings(max_examples=1500, deadline=None)
@given(instances(max_blocks=5, max_stacks=3, max_buffers=3), plan_options())
def test_what_is_proven_is_true_for_many(instance, options):
    judge(instance, options, solve(instance, options))


@pytest.mark.parametrize("horizon", [1, 2])
def test_a_horizon_that_is_too_short_proves_nothing(horizon):
    instance = read_suite("multi-6")[0]
    result = solve(instance, SolveOptions(), horizon=horizon)
    assert result.status == "unknown"
    assert result.lower_bound == 2 * 6


def test_a_warm_start_is_the_first_incumbent():
    instance = read_suite("multi-4")[0]
    result = solve(instance, SolveOptions(), warm_start="greedy")
    assert result.incumbents[0].origin == "greedy"
    assert result.status == "optimal"


@pytest.mark.parametrize("budget", [1e-6, 1e-3])
def test_hardly_any_time_is_no_crash(budget):
    result = solve(read_suite("multi-4")[0], SolveOptions(), budget=budget)
    assert result.lower_bound is None or result.lower_bound >= 0


def test_a_warm_start_by_itself_starts_cold():
    result = solve(read_suite("multi-4")[0], SolveOptions(), warm_start="smash-layered")
    assert result.status == "optimal"


@pytest.mark.parametrize("late", [True, False])
def test_building_stops_at_its_deadline(late):
    problem = Problem(read_suite("multi-6")[0])
    blocks = MovingBlocks.of(problem)
    deadline = perf_counter() if late else inf
    builds = (
        lambda: build_layered(problem, blocks, 8, deadline).milp,
        lambda: build_resting(problem, blocks, 8, 0, None, deadline).milp,
        lambda: build_plain_positions(problem, 8, 0, None, deadline).milp,
    )
    for build in builds:
        if late:
            with pytest.raises(OutOfTime):
                build()
        else:
            assert build().rows > 0


def test_what_takes_too_long_to_build_is_left_out(monkeypatch):
    monkeypatch.setattr(solving, "BUILD_SHARE", 0.0)
    result = solve(read_suite("multi-6")[0], SolveOptions())
    assert {stage["skipped"] for stage in result.details["stages"]} == {"took too long to build"}
    assert (result.status, result.lower_bound) == ("unknown", 2 * 6)


def test_what_would_take_too_long_to_load_is_not_begun():
    result = solve(generate("multi", 40, buffers=2, seed=5)[0], SolveOptions(topple=False), budget=0.5)
    assert "to build" in result.details["stages"][-1]["skipped"]


def test_the_plain_twin_is_planned_cold_for_first_plans():
    asked = []

    class Noting(LayeredPlanner):
        def plan(self, problem, settings, budget, on_incumbent=None):
            asked.append((problem, settings))
            return super().plan(problem, settings, budget, on_incumbent)

    goal = StacksGoal({"s": ("b", "a")})
    instance = make_instance(
        {"s": ["a", "b"]}, goal, stacks=["s", "t"], capacities={"lift": 2}, costs=Costs({"pick": 3})
    )
    made, chosen = Problem(instance), Settings(warm_start="greedy", threads=2, seed=3)
    log = SolveLog(made)
    (twin,) = [method for method in Noting().methods(made, chosen) if method.name == "plain twin"]
    twin.run(made, log, perf_counter() + 20.0)
    assert asked == [(made.twin, Settings(threads=2, seed=3))]
    assert made.law.check(log.best).cost == log.cost
    assert (log.bound, twin.share) == (None, 0.1)


@pytest.mark.parametrize(("horizon", "taken"), [(None, True), (5, False)])
def test_a_chosen_horizon_leaves_the_plain_twin_out(horizon, taken):
    made = Problem(make_instance({"s": ["a", "b"]}, {"s": ["b", "a"]}, buffers=1, costs=Costs({"pick": 3})))
    methods = LayeredPlanner().methods(made, Settings(horizon=horizon))
    (twin,) = [method for method in methods if method.name == "plain twin"]
    assert (twin.takes(made) is None) == taken
