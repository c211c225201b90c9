"""`precedence`: its bound holds for every plan, and where its plan fits it is the optimum."""

import pytest
from hypothesis import given, settings

from smash.planners.precedence import PrecedencePlanner
from smash.planners.protocol import SolveOptions
from smash.problem import Law, OnGoal, PlanOptions, PositionsGoal, StacksGoal, check_plan, make_instance
from smash.problem.sets.generators import generate
from tests.arrangements import wide
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options


def solve(instance, options=None, budget=20.0):
    options = options or PlanOptions()
    result = PrecedencePlanner().solve(instance, SolveOptions(options.topple, options.max_topple), budget)
    if result.actions is not None:
        assert check_plan(instance, result.as_plan(instance, "precedence", options)).accepted
    return result


@settings(max_examples=120, deadline=None)
@given(instances(max_blocks=4), plan_options())
def test_the_bound_holds_and_optimal_means_optimal(instance, options):
    result, best = solve(instance, options), optimal_cost(instance, options)
    if best is None:
        assert result.status == "infeasible"
        return
    assert result.lower_bound <= best <= result.cost
    assert result.status == ("optimal" if result.cost == best == result.lower_bound else "feasible")


def test_where_a_pile_has_to_be_emptied_the_plan_comes_from_what_is_emptied():
    """Moving b1 alone costs 2, but no place is free for it: the pile is toppled whole, then b1 is placed."""
    instance = make_instance(
        blocks=("b1", "b2", "b3"),
        stacks=("s1",),
        buffers=("u1",),
        start={"s1": ("b2", "b1"), "u1": ("b3",)},
        goal=OnGoal({}, bottom=("b1",)),
    )
    assert optimal_cost(instance, PlanOptions()) == 3
    result = solve(instance)
    assert (result.status, result.cost, result.lower_bound) == ("optimal", 3, 3)


@settings(max_examples=80, deadline=None)
@given(
    instances(max_blocks=4, max_stacks=3, max_buffers=1, kinds=("stacks", "positions"), buffer_start=False),
    plan_options().filter(lambda options: options.topple),
)
def test_with_topple_and_empty_buffers_every_optimum_is_proven(instance, options):
    assert solve(instance, options).status == "optimal"


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4, max_stacks=4, max_buffers=0, odd_names=True), plan_options())
def test_with_as_many_buffers_as_blocks_every_optimum_is_proven(instance, options):
    roomy = make_instance(
        name=instance.name,
        blocks=instance.blocks,
        stacks=instance.stacks,
        buffers=[f"buffer {number}" for number in range(len(instance.blocks))],
        start=instance.start,
        table=instance.table,
        goal=instance.goal,
    )
    assert solve(roomy, options).status == "optimal"


@pytest.mark.parametrize("topple", [True, False])
@pytest.mark.parametrize("buffers", [0, 1, 12])
def test_the_papers_sizes_are_solved_at_once(topple, buffers):
    for instance in generate("multi", 9, buffers=buffers, count=5, seed=7):
        result = solve(instance, PlanOptions(topple))
        assert result.lower_bound <= result.cost
        if topple or buffers == 12:
            assert result.status == "optimal"


@pytest.mark.parametrize("topple", [True, False])
def test_a_single_goal_costs_two_or_three_with_topple_and_twice_its_depth_without(topple):
    for instance in generate("single", 6, count=20, seed=3):
        ((target, _),) = instance.goal.positions.items()
        pile = next(pile for pile in instance.start.values() if target in pile)
        depth = len(pile) - pile.index(target)
        expected = min(depth + 1, 3) if topple else 2 * depth
        assert solve(instance, PlanOptions(topple)).cost == expected


def test_a_hundred_blocks_are_proven_with_and_without_topple():
    instance = wide(100, 10, seed=1, buffers=100)
    with_topple, without = solve(instance), solve(instance, PlanOptions(topple=False))
    assert with_topple.status == without.status == "optimal"
    assert with_topple.cost < without.cost


def test_too_few_buffers_leave_a_bound_and_a_plan():
    result = solve(wide(60, 3, seed=2), PlanOptions(topple=False), budget=5.0)
    assert result.lower_bound <= result.cost
    assert result.status == "optimal" or "0 buffers" in result.details["reason"]


def test_a_short_budget_still_gives_a_bound_and_a_plan():
    result = solve(wide(150, 15, seed=3, buffers=150), PlanOptions(topple=False), budget=0.2)
    assert result.lower_bound <= result.cost


def test_incumbents_are_reported_at_once():
    seen = []
    instance = wide(40, 5, seed=4, buffers=40)
    result = PrecedencePlanner().solve(
        instance, SolveOptions(topple=False), 10.0, lambda seconds, cost, actions: seen.append((cost, tuple(actions)))
    )
    assert [cost for cost, _ in seen] == [entry.cost for entry in result.incumbents]
    assert seen[-1][1] == result.actions
    assert Law(instance).check(seen[0][1]).accepted


@pytest.mark.parametrize("goal", [StacksGoal({}), PositionsGoal({}), OnGoal({})])
def test_no_blocks_need_no_actions(goal):
    result = solve(make_instance(name="x", blocks=[], stacks=["s1"], start={}, goal=goal))
    assert (result.status, result.cost, result.lower_bound) == ("optimal", 0, 0)


@pytest.mark.parametrize("topple", [True, False])
def test_with_less_time_than_a_schedule_takes_there_is_a_greedy_plan_first(topple):
    instance = generate("multi", 600, stacks=20, buffers=4, seed=5)[0]
    result = PrecedencePlanner().solve(instance, SolveOptions(topple), 0.01)
    assert result.incumbents[0].origin == "greedy"
    assert Law(instance, PlanOptions(topple)).check(result.actions).accepted
    assert result.lower_bound is not None
