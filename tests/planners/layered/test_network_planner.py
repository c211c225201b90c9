"""The layered models on the network of places: their proofs are those of uniform-cost search."""

from pathlib import Path

import pytest
from hypothesis import given, settings

from smash.planners.layered import LayeredPlanner
from smash.planners.layered.network.moving import Moving
from smash.planners.layered.network.relaxed import build_relaxed
from smash.planners.milp.solvers import highs
from smash.planners.protocol import Settings, SolveOptions, why_refused
from smash.problem import (
    Carry,
    Costs,
    Law,
    Lift,
    OnGoal,
    Place,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    make_instance,
)
from smash.problem.files.instances import read_instance
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.strategies import family_instances, family_options

SCOOP = Path(__file__).parents[3] / "examples" / "scoop.json"


def solve(instance, options, budget=20.0, **more):
    settings = SolveOptions(options.topple, options.max_topple, without=options.without, **more)
    return LayeredPlanner().solve(instance, settings, budget)


def judge(instance, options, result):
    """Hold a result to uniform-cost search."""
    found = cheapest_plan(instance, options)
    if result.actions is not None:
        assert Law(instance, options).check(result.actions).cost == result.cost
        assert result.cost >= found[0]
    if result.status == "optimal":
        assert result.cost == found[0]
    if result.status == "infeasible":
        assert found is None
    elif found is not None and result.lower_bound is not None:
        assert result.lower_bound <= found[0]


@settings(max_examples=15, deadline=None)
@given(family_instances(max_blocks=2, max_stacks=2), family_options())
def test_what_is_proven_is_true(instance, options):
    judge(instance, options, solve(instance, options, budget=1.0))


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(family_instances(max_blocks=4), family_options())
def test_what_is_proven_is_true_for_many(instance, options):
    judge(instance, options, solve(instance, options, budget=3.0))


@pytest.mark.slow
@pytest.mark.parametrize("ordered", [False, True])
@settings(max_examples=100, deadline=None)
@given(family_instances(max_blocks=4), family_options())
def test_the_relaxation_holds_the_cheapest_plan(ordered, instance, options):
    problem, found = Problem(instance, options), cheapest_plan(instance, options)
    if found is None or problem.demands.met:
        return
    layers = sum(not isinstance(action, Place) for action in found[1])
    model = build_relaxed(problem, Moving.of(problem), layers, upper_bound=found[0] + 1, ordered=ordered)
    result = highs.solve(model.milp, time_limit=10.0)
    assert result.status != "infeasible"
    assert result.bound <= found[0] + 0.5


SMALL = make_instance(
    name="small",
    blocks=["a", "b", "c"],
    stacks=["s", "g"],
    start={"s": ["a", "b", "c"]},
    goal=PositionsGoal({"b": ("g", 1), "c": ("g", 2)}),
    capacities={"lift": 2},
)


def test_a_lift_moves_a_tower_at_once():
    result = solve(SMALL, PlanOptions())
    assert (result.status, result.actions) == ("optimal", (Lift("s", 2, "g"),))


@pytest.mark.parametrize("goal", [StacksGoal({"g": ("b", "a")}), OnGoal({"a": "b"}), PositionsGoal({"a": ("g", 1)})])
@pytest.mark.parametrize("topple", [True, False])
def test_every_kind_of_goal_is_solved_to_its_optimum(goal, topple):
    instance = make_instance(
        name="two", blocks=["a", "b"], stacks=["s", "g"], start={"s": ["a", "b"]}, goal=goal, costs=Costs({"pick": 3})
    )
    result = solve(instance, PlanOptions(topple), budget=60.0)
    judge(instance, PlanOptions(topple), result)
    assert result.status in ("optimal", "infeasible")


@pytest.mark.parametrize(
    ("topple", "without", "carries"),
    [
        (False, ("carry", "lift"), False),
        (True, ("carry", "lift"), False),
        (False, ("lift",), True),
        (True, ("lift",), True),
    ],
)
def test_the_scoop_demonstration_is_solved_to_its_optimum(topple, without, carries):
    result = solve(read_instance(SCOOP), PlanOptions(topple, without=without), budget=60.0)
    assert result.status == "optimal"
    assert any(isinstance(action, Carry) for action in result.actions) == carries


def test_where_no_block_can_reach_its_goal_the_flow_proves_it():
    instance = make_instance(
        name="stuck",
        blocks=["a", "b"],
        stacks=["s"],
        start={"s": ["a", "b"]},
        goal=StacksGoal({"s": ("b", "a")}),
        capacities={"lift": 2},
    )
    result = solve(instance, PlanOptions(topple=False))
    assert (result.status, result.bound_origin) == ("infeasible", "layered flow without order")


def test_a_horizon_that_is_too_short_proves_nothing():
    result = solve(read_instance(SCOOP), PlanOptions(), budget=2.0, horizon=1)
    assert result.status == "unknown"


def test_it_takes_the_whole_family():
    assert why_refused(LayeredPlanner(), Problem(read_instance(SCOOP)), Settings()) is None
