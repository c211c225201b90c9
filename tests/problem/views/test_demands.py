"""Demands: who stays, who leaves, who is placed where, for each kind of goal."""

import pytest
from hypothesis import given, settings

from smash.problem import Law, OnGoal, PositionsGoal, StacksGoal, State, make_instance
from smash.problem.views.demands import FloatingChain, demands_of
from tests.strategies import instances


def demands(goal, start=None, table=""):
    start = {"s1": "abc"} if start is None else start
    blocks = sorted({*table}.union(*start.values()))
    return demands_of(make_instance(name="x", blocks=blocks, stacks=["s1", "s2"], start=start, table=table, goal=goal))


def test_the_common_bottom_part_stays_and_the_rest_is_placed():
    asked = demands(StacksGoal({"s1": ("a", "c"), "s2": ("b",)}))
    assert asked.keep == {"s1": 1, "s2": 0}
    assert asked.leaving == {"s1": ("b", "c"), "s2": ()}
    assert asked.build == {"s1": ("c",), "s2": ("b",)}
    assert asked.placed == {"b", "c"}
    assert not asked.loose


def test_blocks_above_a_target_leave_without_a_place():
    asked = demands(PositionsGoal({"a": ("s2", 1)}))
    assert asked.placed == {"a"}
    assert asked.loose == {"b", "c"}


def test_what_the_goal_does_not_name_may_stay_on_a_finished_pile_up_to_the_lowest_wanted_block():
    asked = demands(PositionsGoal({"a": ("s1", 1), "c": ("s2", 1)}))
    assert asked.keep == {"s1": 2, "s2": 0}
    assert (asked.placed, asked.loose) == ({"c"}, set())


def test_a_block_of_the_table_region_is_placed_and_does_not_leave():
    asked = demands(StacksGoal({"s1": ("a", "b")}), {"s1": "a"}, table="b")
    assert (asked.build, asked.leaving["s1"]) == ({"s1": ("b",)}, ())


def test_a_tower_begun_is_built_where_it_stands():
    asked = demands(OnGoal({"c": "a"}), {"s1": "a", "s2": "bc"})
    assert asked.build == {"s1": ("c",)}
    assert asked.keep == {"s1": 1, "s2": 1}


def test_a_tower_of_which_nothing_stays_is_built_anywhere():
    asked = demands(OnGoal({"a": "c", "b": "a"}, ("c",)))
    assert asked.floating == (FloatingChain(("c", "a", "b"), bottom=True),)
    assert asked.leaving["s1"] == ("a", "b", "c")


def test_towers_are_built_where_it_is_said_the_bottom_first_and_above_what_is_begun_there():
    start = {"s1": "ad", "s2": "bce"}
    goal = OnGoal({"e": "a", "c": "d"}, ("b",))
    instance = make_instance(name="x", blocks="abcde", stacks=["s1", "s2"], start=start, goal=goal)
    asked = demands_of(instance, None, {"d": "s1"})
    assert (asked.build, asked.floating) == ({"s1": ("e", "d", "c")}, ())
    assert demands_of(instance, {"s2": 0}, {"b": "s2", "d": "s2"}).build == {"s1": ("e",), "s2": ("b", "d", "c")}


@pytest.mark.parametrize("bottom", [(), ("b",)])
def test_a_block_that_should_be_at_a_bottom_leaves_what_it_stands_on(bottom):
    assert demands(OnGoal({}, bottom)).placed == set(bottom)


@settings(max_examples=120, deadline=None)
@given(instances(max_blocks=5))
def test_nothing_is_asked_exactly_where_the_goal_holds(instance):
    met = Law(instance).goal_shortfall(State.start_of(instance)) is None
    assert demands_of(instance).met == met


@settings(max_examples=120, deadline=None)
@given(instances(max_blocks=5))
def test_every_block_stays_or_leaves_or_lies_on_the_table(instance):
    asked = demands_of(instance)
    for location, pile in instance.start.items():
        assert pile[: asked.keep[location]] + asked.leaving[location] == pile
    leaving = {block for pile in asked.leaving.values() for block in pile}
    assert asked.loose == leaving - asked.placed
    assert asked.placed <= leaving | set(instance.table)
