"""Costs: a count for each action, more for some kinds and for blocks that travel far."""

import pytest

from smash.problem import Costs


def test_by_default_every_action_costs_one_and_ways_cost_nothing():
    costs = Costs()
    assert costs.plain
    assert costs.of("topple") == 1
    assert costs.distance("s1", "s2") == 0


@pytest.mark.parametrize("costs", [Costs({"topple": 3}), Costs(travel=1.0, positions={"s1": (0, 0)})])
def test_costs_that_are_not_one_each_are_not_plain(costs):
    assert not costs.plain


def test_a_kind_that_is_said_to_cost_one_changes_nothing():
    assert Costs({"pick": 1}).plain


def test_a_kind_costs_what_is_said_and_the_others_one():
    costs = Costs({"topple": 3})
    assert (costs.of("topple"), costs.of("pick")) == (3, 1)


def test_a_way_costs_its_length_in_whole_numbers():
    costs = Costs(travel=2.5, positions={"s1": (0.0, 0.0), "s2": (3.0, 4.0), "u1": (0.0, 0.3)})
    assert costs.distance("s1", "s2") == costs.distance("s2", "s1") == 12  # 12.5, to the even one
    assert costs.distance("s1", "u1") == 1  # 0.75
    assert costs.distance("s1", "s1") == 0
