"""The edges of each block between its start, the places and its home."""

import pytest

from smash.planners.layered.network.moving import Moving
from smash.planners.layered.network.places import NO_EDGE
from smash.problem import Carrier, Costs, OnGoal, PositionsGoal
from tests.planners.layered.made import priced, problem


def test_origins_and_targets_are_locations_by_number():
    tray = Carrier("tray", ("p",), "p", 1, ("z",))
    moving = Moving.of(priced({"s": "ab"}, PositionsGoal({"a": ("t", 1), "z": ("t", 2)}), carriers=(tray,)))
    assert moving.blocks.names == ("a", "b", "z")
    assert moving.piles == ((0, 1), ())
    assert (moving.origin, moving.target) == ((0, 0, NO_EDGE), (1, NO_EDGE, 1))


def test_an_on_goal_is_at_home_anywhere():
    moving = Moving.of(priced({"s": "ab"}, OnGoal({"a": "b"})))
    assert moving.anywhere
    assert set(moving.target) == {NO_EDGE}


def test_a_move_home_costs_what_the_move_to_the_goal_costs():
    at = {"s": (0.0, 0.0), "t": (0.0, 3.0), "u": (0.0, 1.0), "table": (0.0, 0.0)}
    made = problem({"s": "a"}, {"t": "a"}, buffers="u", costs=Costs(travel=1.0, positions=at))
    moving = Moving.of(made)
    table = moving.transfers()
    assert table[0, moving.start, moving.home] == 2 + 3
    assert table[0, 2, moving.home] == 2 + 2
    assert table[0, 1, moving.home] == NO_EDGE


@pytest.mark.parametrize(("block", "placed"), [("a", True), ("b", False)])
def test_only_a_block_without_a_goal_is_forgotten_and_only_after_its_first_move(block, placed):
    moving = Moving.of(priced({"s": "ab"}, PositionsGoal({"a": ("t", 1)})))
    edges = moving.transfers()[moving.blocks.names.index(block)]
    assert (edges[:, moving.home] >= 0).any() == placed
    assert (edges[:, moving.gone] >= 0).any() == (not placed)
    assert edges[moving.start, moving.gone] == NO_EDGE
    assert edges[moving.places.table, moving.gone] == NO_EDGE  # without a goal it may lie


def test_blocks_fall_from_stacks_and_from_where_they_started():
    made = priced({"s": "a", "u": "b"}, {"t": "ab"}, buffers="u")
    falls = Moving.of(made).falls()
    assert falls[0].tolist() == [0, 0, NO_EDGE, 0]
    assert falls[1].tolist() == [0, 0, NO_EDGE, NO_EDGE]


def test_a_lift_brings_a_block_home_but_not_from_home():
    made = problem({"s": "ab", "t": "c"}, {"t": "cab"}, capacities={"lift": 2})
    moving = Moving.of(made)
    lifts = moving.lifts()
    assert lifts[0, 2, 2] == 0  # from the start to home
    assert lifts[0, 1, 2] == NO_EDGE
    assert lifts[0, 0, 3] == NO_EDGE
    without = problem({"s": "ab", "t": "c"}, {"t": "cab"}, costs=Costs({"pick": 2}))
    assert (Moving.of(without).lifts() == NO_EDGE).all()
