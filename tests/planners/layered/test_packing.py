"""Packing gives every block that is put aside a place where nothing happens until it has left."""

import pytest

from smash.planners.layered.blocks import MovingBlocks
from smash.planners.layered.events import Event
from smash.planners.layered.packing import Packing
from smash.problem import IllegalAction, OnGoal, Pick, Place, Topple
from smash.problem.model import TABLE
from tests.planners.layered.made import NO_TOPPLE, problem, reversal


def packed(made, *events):
    blocks = MovingBlocks.of(made)
    number = {name: index for index, name in enumerate(blocks.names)}
    listed = [
        Event(layer, kind, subject if kind == "topple" else number[subject], *location)
        for layer, (kind, subject, *location) in enumerate(events)
    ]
    return Packing(made, blocks, listed).actions()


def test_a_toppled_pile_is_built_up_from_the_table():
    plan = packed(reversal(), ("topple", 0, "s"), ("from_table", "b"), ("from_table", "a"))
    assert plan == (Topple("s", 1), Pick("b", TABLE), Place("b", "s"), Pick("a", TABLE), Place("a", "s"))


def test_blocks_that_are_put_aside_get_a_buffer_each_where_the_lower_one_is_needed_first():
    made = reversal(options=NO_TOPPLE)
    plan = packed(made, ("aside", "b"), ("aside", "a"), ("from_aside", "b"), ("from_aside", "a"))
    assert made.law.check(plan).cost == 8
    assert plan[1].target != plan[3].target


def test_without_a_free_place_a_block_is_moved_once_more():
    tall = problem({"s": "ab", "t": "cd"}, {"s": "dc", "t": "ba"}, "s t", "u", NO_TOPPLE)
    events = [("aside", at) for at in "bdac"] + [("from_aside", at) for at in "dcba"]
    assert tall.law.check(packed(tall, *events)).accepted
    assert len(packed(tall, *events)) > 2 * len(events)


def test_where_no_pile_is_left_there_is_no_plan():
    made = problem({"s": "ab"}, {"s": "ba"}, "s t", "", NO_TOPPLE)
    assert packed(made, ("aside", "b"), ("aside", "a"), ("from_aside", "b"), ("from_aside", "a")) is None


def test_one_place_serves_blocks_that_leave_in_the_order_of_the_pile():
    made = problem({"s": "ab"}, {"t": "ab"}, buffers="u", options=NO_TOPPLE)
    plan = packed(made, ("aside", "b"), ("direct", "a"), ("from_aside", "b"))
    assert plan == (Pick("b", "s"), Place("b", "u"), Pick("a", "s"), Place("a", "t"), Pick("b", "u"), Place("b", "t"))


def test_a_floating_tower_is_built_where_nothing_happens_later():
    made = problem({"s": "ab", "t": "c"}, OnGoal({"a": "b"}, ("b",)), "s t", "u", NO_TOPPLE)
    plan = packed(made, ("direct", "b"), ("direct", "a"))
    assert made.law.check(plan).accepted
    assert plan[1] == Place("b", "u")


def test_events_that_no_law_allows_are_refused_by_it():
    with pytest.raises(IllegalAction):
        packed(reversal(options=NO_TOPPLE), ("topple", 0, "s"), ("from_table", "b"))
