"""The order of what rests on one another, which the relaxation alone leaves free."""

import pytest
from hypothesis import assume, given, settings

from smash.planners.layered.network.moving import Moving
from smash.planners.layered.network.relaxed import build_relaxed
from smash.problem import Costs, Place, PositionsGoal
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.planners.layered.made import NO_TOPPLE, optimum, priced, problem
from tests.strategies import family_instances, family_options

ONE_PLACE = {"s": "abc"}, {"t": "acb"}
"""b and c rest on u; b, which came later or lies below, must not leave it first."""


@pytest.mark.parametrize(("ordered", "cost"), [(False, 20), (True, None)])
def test_who_came_first_lies_below_and_leaves_last(ordered, cost):
    made = priced(*ONE_PLACE, buffers="u", options=NO_TOPPLE)
    built = build_relaxed(made, Moving.of(made), 5, ordered=ordered)
    assert optimum(built) == cost


def test_with_more_layers_there_is_a_plan_that_keeps_the_order():
    made = problem({"s": "ab"}, {"s": "ba"}, "s", "u v", NO_TOPPLE)
    assert optimum(build_relaxed(made, Moving.of(made), 4, ordered=True)) == 8


def test_a_lift_keeps_the_order_of_a_pair():
    made = problem({"s": "ab"}, {"t": "ba"}, options=NO_TOPPLE, capacities={"lift": 2})
    assert (
        optimum(build_relaxed(made, Moving.of(made), 2, ordered=True)) == cheapest_plan(made.instance, made.options)[0]
    )
    turned = problem({"s": "abcd"}, {"t": "dcba"}, buffers="u", options=NO_TOPPLE, capacities={"lift": 3})
    assert optimum(build_relaxed(turned, Moving.of(turned), 3, ordered=True)) is None
    same = problem({"s": "ab"}, PositionsGoal({"a": ("t", 1), "b": ("t", 2)}), capacities={"lift": 2})
    assert optimum(build_relaxed(same, Moving.of(same), 1, ordered=True)) == 1


@pytest.mark.parametrize("horizon", [5, 6])
def test_with_the_order_the_least_cost_is_that_of_a_plan(horizon):
    made = priced(*ONE_PLACE, buffers="u", options=NO_TOPPLE)
    costs = [optimum(build_relaxed(made, Moving.of(made), horizon, ordered=ordered)) for ordered in (False, True)]
    assert costs == [20, None if horizon == 5 else cheapest_plan(made.instance, made.options)[0]]


@settings(max_examples=15, deadline=None)
@given(family_instances(max_blocks=3, max_stacks=2, max_carriers=1), family_options())
def test_a_cheapest_plan_keeps_the_order(instance, options):
    made, best = Problem(instance, options), cheapest_plan(instance, options)
    assume(best is not None and best[0] and not made.demands.met)
    layers = sum(not isinstance(action, Place) for action in best[1])
    assume(layers <= 4)
    model = build_relaxed(made, Moving.of(made), layers, 0, best[0] + 1, ordered=True)
    least = optimum(model)
    assert least is not None
    assert least <= best[0]


def test_what_a_lift_brings_lies_above_what_rests_there():
    costs = Costs({"pick": 2})
    made = problem(
        {"t": "cdba"}, {"s": "da", "t": "bc"}, buffers="u", options=NO_TOPPLE, costs=costs, capacities={"lift": 2}
    )
    assert cheapest_plan(made.instance, made.options)[0] == 5
    assert optimum(build_relaxed(made, Moving.of(made), 5, 0, 6, ordered=True)) == 5
