"""Instances from a start and a goal: what follows from them, what is refused, and in which words."""

import pytest
from hypothesis import given

import smash
from smash.problem import Carrier, Costs, MalformedFile, OnGoal, PositionsGoal, StacksGoal
from tests.strategies import instances

START, GOAL = {"s1": ["a", "b"], "s2": ["c"]}, {"s2": ["c", "a", "b"]}


def test_a_start_and_a_goal_are_enough():
    instance = smash.make_instance(START, GOAL)
    assert (instance.name, instance.blocks) == ("instance", ("a", "b", "c"))
    assert (instance.stacks, instance.buffers) == (("s1", "s2"), ())
    assert instance.goal == StacksGoal({"s2": ("c", "a", "b")})
    assert instance == smash.make_instance(start=START, goal=StacksGoal(GOAL))


def test_locations_that_only_the_goal_names_are_stacks():
    assert smash.make_instance({"s1": ["a"]}, {"t": ["a"]}).stacks == ("s1", "t")
    assert smash.make_instance({"s1": ["a"]}, PositionsGoal({"a": ("t", 1)})).stacks == ("s1", "t")


def test_names_come_first_and_what_start_and_goal_name_beside_them_follows():
    instance = smash.make_instance({"b": ["x"], "u": ["y"]}, {"c": ["x", "y"]}, stacks=["a", "b"], buffers=["u", "v"])
    assert (instance.stacks, instance.buffers) == (("a", "b", "c"), ("u", "v"))
    assert instance.start == {"a": (), "b": ("x",), "c": (), "u": ("y",), "v": ()}


def test_numbers_add_fresh_names():
    instance = smash.make_instance({"s2": ["a"], "u1": ["b"]}, {"s2": ["a", "b"]}, stacks=2, buffers=2)
    assert instance.stacks == ("s2", "u1", "s1", "s3")
    assert instance.buffers == ("u2", "u3")


def test_blocks_of_the_table_and_of_carriers_count():
    tray = Carrier("tray", ("left", "right"), "left", 2, ("c",))
    instance = smash.make_instance({"s1": ["a"]}, OnGoal({"a": "b"}), table=["b"], carriers=[tray])
    assert instance.blocks == ("a", "b", "c")


@pytest.mark.parametrize(
    ("start", "goal", "more", "words"),
    [
        (START, "s2", {}, "`goal`: 's2' is no goal; a mapping of locations to lists of blocks, a StacksGoal"),
        (START, None, {}, "None is no goal"),
        (START, ["c", "a", "b"], {}, "is no goal"),
        (START, {"s2": "cab"}, {}, "`goal.s2`: 'cab' is one name; a list of blocks is allowed"),
        ({"s1": "ab"}, {"s1": ["a", "b"]}, {}, "`start.s1`: 'ab' is one name"),
        (START, {"s2": ["c", "a"]}, {}, "block 'b' is nowhere"),
        (START, {"s2": ["c", "a", "b", "d"]}, {}, "'d' is not one of `blocks` ('a', 'b', 'c')"),
        (START, {"u": ["c", "a", "b"]}, {"buffers": ["u"]}, "'u' is not a location of stacks"),
        (START, PositionsGoal({"a": "s2"}), {}, "`goal.positions.a`: 's2' is not allowed; (location, height) is"),
        (START, PositionsGoal({"a": ("s2", 2)}), {}, "floats"),
        (START, PositionsGoal(["a"]), {}, "`goal.positions`: ['a'] is not allowed; a mapping of blocks"),
        (START, OnGoal(["a"]), {}, "`goal.on`: ['a'] is not allowed; a mapping of blocks"),
        (START, OnGoal({"a": ["b"]}), {}, "`goal.on.a`: ['b'] is no name; a string is one"),
        (START, OnGoal({}, bottom=None), {}, "`goal.bottom`: None is not allowed; a list of names is"),
        (START, OnGoal({}, ontable=3), {}, "`goal.ontable`: 3 is not allowed; a list of names is"),
        (START, OnGoal({}, clear=[["a"]]), {}, "`goal.clear`: ['a'] is no name; a string is one"),
        (START, OnGoal({}), {"hand": ["d"]}, "`hand`: ['d'] is no name; a string is one"),
        (START, OnGoal({}), {"hand": "a"}, "`start, table and hand`: 'a' stands twice"),
        (["a"], GOAL, {}, "`start`: ['a'] is not allowed; a mapping of locations to lists of blocks is"),
        ({"s1": [1]}, {"s1": [1]}, {}, "`start.s1`: 1 is no name; a string is one"),
        ({"s1": 3}, GOAL, {}, "`start.s1`: 3 is not allowed; a list of names is"),
        (START, GOAL, {"buffers": -1}, "`buffers`: -1 is not allowed; names, or a number from 0"),
        (START, GOAL, {"stacks": "s1"}, "`stacks`: 's1' is not allowed; a list of names is"),
        (START, GOAL, {"where": "here", "stacks": ["s1", "s1"]}, "here: `stacks`: 's1' stands twice"),
    ],
)
def test_what_contradicts_itself_is_refused_in_one_line(start, goal, more, words):
    with pytest.raises(MalformedFile) as refused:
        smash.make_instance(start, goal, **more)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


@given(instance=instances())
def test_an_instance_is_made_again_from_its_parts(instance):
    again = smash.make_instance(
        name=instance.name,
        blocks=list(instance.blocks),
        stacks=list(instance.stacks),
        buffers=list(instance.buffers),
        start={location: list(pile) for location, pile in instance.start.items()},
        goal=instance.goal,
        table=list(instance.table),
        carriers=instance.carriers,
        capacities=instance.capacities,
        costs=instance.costs,
    )
    assert again == instance
    assert hash(again) == hash(instance)
    assert len({instance, again}) == 1


def test_costs_of_equal_value_have_equal_hashes():
    first, second = Costs({"pick": 2, "place": 3}), Costs({"place": 3, "pick": 2})
    assert first == second
    assert hash(first) == hash(second)
