"""Horizons: as many steps as any plan of a cost can need, and costs whose plans all fit into a number of steps."""

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from smash.planners.flow.horizon import step_bound
from smash.planners.flow.scope import scope_of
from smash.planners.flow.warm import motion_of
from smash.problem import PlanOptions, StacksGoal, make_instance
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from tests.cheapest import cheapest_plan
from tests.strategies import instances, plan_options


@settings(max_examples=40, deadline=None)
@given(instances(min_blocks=1, max_blocks=3, max_buffers=1), plan_options())
def test_a_cheapest_plan_fits_the_steps_of_its_cost_and_costs_no_less_than_the_least(instance, options):
    best = cheapest_plan(instance, options)
    assume(best is not None and best[0])
    cost, actions = best
    scope = scope_of(Problem(instance, options))
    bound = step_bound(Problem(instance, options), scope)
    assert motion_of(Problem(instance, options), scope, actions).steps <= bound.steps(cost)
    assert bound.least_cost <= cost


@pytest.mark.parametrize(("blocks", "optimum"), [("ab", 7), ("abc", 11)])
def test_a_pile_on_a_buffer_may_have_to_be_put_on_a_stack_and_toppled(blocks, optimum):
    instance = make_instance(
        name="x",
        blocks=blocks,
        stacks=["s1"],
        buffers=["u1"],
        start={"u1": blocks},
        goal=StacksGoal({"s1": tuple(blocks)}),
    )
    cost, actions = cheapest_plan(instance)
    assert cost == optimum
    scope = scope_of(Problem(instance))
    steps = motion_of(Problem(instance), scope, actions).steps
    assert steps <= bound_of(instance, PlanOptions()).steps(cost)
    assert bound_of(instance, PlanOptions()).fitting_cost(steps - 1, 30) < cost


def bound_of(instance, options):
    problem = Problem(instance, options)
    return step_bound(problem, scope_of(problem))


@pytest.mark.parametrize("topple", [True, False])
def test_more_cost_never_needs_fewer_steps_and_the_fitting_cost_is_the_largest_that_fits(topple):
    for instance in generate("multi", 6, buffers=2, count=4, seed=1):
        bound = bound_of(instance, PlanOptions(topple))
        steps = [bound.steps(cost) for cost in range(30)]
        assert steps == sorted(steps)
        for most in range(0, steps[-1] + 3, 3):
            fitting = bound.fitting_cost(most, 29)
            assert fitting < 0 or steps[fitting] <= most
            assert fitting == 29 or steps[fitting + 1] > most


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 6), st.integers(0, 3))
def test_the_least_cost_is_two_for_each_misplaced_block(blocks, right):
    names = [f"b{number}" for number in range(blocks + right)]
    goal = StacksGoal({"s1": tuple(names[:right]), "s2": tuple(names[right:])})
    instance = make_instance(name="x", blocks=names, stacks=["s1", "s2"], start={"s1": names}, goal=goal)
    assert bound_of(instance, PlanOptions()).least_cost == 2 * blocks


def test_one_block_over_takes_one_step():
    instance = make_instance(
        name="x", blocks="a", stacks=["s1", "s2"], start={"s1": "a"}, goal=StacksGoal({"s2": ("a",)})
    )
    assert bound_of(instance, PlanOptions(topple=False)).steps(2) == 1
    assert bound_of(instance, PlanOptions(topple=False)).least_cost == 2
