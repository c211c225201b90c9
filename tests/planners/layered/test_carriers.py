"""Rows of carriers: a load fits, rides along, and leaves where the carrier stands."""

from dataclasses import replace

import pytest

from smash.planners.layered.network.positions import build_network_positions
from smash.planners.layered.positions import read_positions
from smash.problem import Carrier, Carry, PositionsGoal
from tests.planners.layered.made import NO_TOPPLE, optimum, problem, solved


def tray(capacity=1, holds=(), stations=("p", "q"), name="tray"):
    return Carrier(name, stations, stations[0], capacity, holds)


def built(start, goal, horizon, *carriers, stacks="s t"):
    made = problem(start, goal, stacks, options=NO_TOPPLE, carriers=carriers)
    return made, build_network_positions(made, horizon, 0, None)


def with_taken(model, *columns):
    """Return a model in which some edges are taken."""
    lower = model.milp.lower.copy()
    lower[list(columns)] = 1
    return replace(model, milp=replace(model.milp, lower=lower))


@pytest.mark.parametrize(("capacity", "cost"), [(2, 8), (1, None)])
def test_a_pile_is_turned_over_on_a_carrier_that_holds_it(capacity, cost):
    # one location: both blocks have to be on the tray
    _, model = built({"s": "ab"}, {"s": "ba"}, 4, tray(capacity), stacks="s")
    assert optimum(model) == cost


def test_what_starts_on_a_carrier_is_picked_off_it():
    made, model = built({}, {"s": "a"}, 1, tray(holds=("a",)))
    assert made.law.check(read_positions(made, model, solved(model).vector)).cost == 2


def test_a_carrier_moves_to_where_no_carrier_stands():
    _, model = built({"s": "a"}, {"t": "a"}, 2, tray(name="one"), tray(name="two", stations=("q", "r")))
    one_to_q, two_to_r = model.carry[0, 0, 1], model.carry[0, 2, 3]
    assert optimum(with_taken(model, two_to_r)) == 3
    assert optimum(with_taken(model, one_to_q)) is None
    assert optimum(with_taken(model, one_to_q, two_to_r)) is None  # in one layer: in any order


def test_a_carrier_is_not_loaded_in_the_layer_in_which_it_leaves():
    _, model = built({"s": "a"}, PositionsGoal({"a": ("t", 1)}), 3, tray())
    load, leave = model.move[0, 0, 0, model.places.inside][0], model.carry[:, 0, 1]
    assert optimum(with_taken(model, load, leave[0])) is None
    assert optimum(with_taken(model, load, leave[1])) == 2 + 1 + 2


def test_a_load_rides_along():
    made, model = built({"s": "a"}, PositionsGoal({"a": ("t", 1)}), 3, tray())
    load, leave = model.move[0, 0, 0, model.places.inside][0], model.carry[1, 0, 1]
    plan = read_positions(made, model, solved(with_taken(model, load, leave)).vector)
    assert plan[2] == Carry("tray", "q")
    assert made.law.check(plan).accepted
