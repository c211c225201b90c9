"""Rows of lifts: the top of a pile, at most the capacity, in its order, one lift a layer."""

import pytest

from smash.planners.layered.network.positions import build_network_positions
from smash.planners.layered.positions import read_positions
from smash.problem import Lift, PositionsGoal
from tests.cheapest import cheapest_plan
from tests.planners.layered.made import NO_TOPPLE, optimum, problem, solved


@pytest.mark.parametrize(("capacity", "cost"), [(1, 3), (2, 2), (3, 1)])
def test_a_tower_goes_over_in_as_few_lifts_as_the_capacity_allows(capacity, cost):
    # one block a lift: c aside, b over, c over, where a stays; all three: one lift
    goal = {"t": "abc"} if capacity == 3 else PositionsGoal({"b": ("t", 1), "c": ("t", 2)})
    made = problem({"s": "abc"}, goal, buffers="u", options=NO_TOPPLE, capacities={"lift": capacity})
    expected = cheapest_plan(made.instance, made.options)[0]
    assert optimum(build_network_positions(made, 3, 0, None)) == expected
    assert expected <= cost


def test_a_lift_does_not_turn_a_pile_over():
    made = problem({"s": "ab"}, {"t": "ba"}, options=NO_TOPPLE, capacities={"lift": 2})
    assert optimum(build_network_positions(made, 1, 0, None)) is None
    assert optimum(build_network_positions(made, 2, 0, None)) == 2  # b, then a, by a lift each


def test_a_lift_lands_on_what_stands_there():
    made = problem({"s": "bc", "t": "a"}, {"t": "abc"}, options=NO_TOPPLE, capacities={"lift": 2})
    model = build_network_positions(made, 1, 0, None)
    assert read_positions(made, model, solved(model).vector) == (Lift("s", 1, "t"),)


def test_there_is_one_lift_a_layer():
    made = problem({"s": "a", "t": "b"}, {"u": "a", "v": "b"}, "s t u v", options=NO_TOPPLE, capacities={"lift": 1})
    assert optimum(build_network_positions(made, 1, 0, None)) == 3  # a lift, and a pick and a place
    assert optimum(build_network_positions(made, 2, 0, None)) == 2
