"""The contracted gadget with the locations that there are: where a block rests, nothing else happens."""

import pytest

from smash.planners.layered.blocks import MovingBlocks
from smash.planners.layered.horizons import sound_layers
from smash.planners.layered.packing import Packing
from smash.planners.layered.resting import build_resting, read_resting
from tests.planners.layered.made import NO_TOPPLE, optimum, problem, reversal, solved


def resting(made, lower=0, upper=None):
    blocks = MovingBlocks.of(made)
    return build_resting(made, blocks, sound_layers(blocks), lower, upper)


@pytest.mark.parametrize(("buffers", "cost"), [("u v", 8), ("u", None)])
def test_as_many_blocks_rest_as_there_are_places(buffers, cost):
    assert optimum(resting(reversal(buffers, NO_TOPPLE))) == cost


def test_what_rests_on_a_goal_keeps_it_from_growing():
    # b would have to rest on t, and a to come to t below it
    assert optimum(resting(problem({"s": "ab"}, {"s": "b", "t": "a"}, options=NO_TOPPLE))) is None


def test_its_solutions_say_where_blocks_rest_and_are_plans():
    made = reversal(options=NO_TOPPLE)
    model = resting(made)
    events = read_resting(model, made.instance.locations, solved(model).vector)
    assert {event.location for event in events if event.kind == "aside"} == {"u", "v"}
    plan = Packing(made, MovingBlocks.of(made), events).actions()
    assert made.law.check(plan).cost == 8


def test_what_rests_on_one_another_leaves_from_the_top():
    # c above b above a, all three to t in that order from the bottom: c, b, a; one spare place turns two over
    made = problem({"s": "abc"}, {"t": "abc"}, "s t", "u", NO_TOPPLE)
    assert optimum(resting(made)) == 10
    turned = problem({"s": "abc"}, {"t": "acb"}, "s t", "u", NO_TOPPLE)
    assert optimum(resting(turned)) is None


def test_the_rows_of_the_cost_keep_out_what_is_too_cheap_or_no_better():
    made = reversal(options=NO_TOPPLE)
    assert optimum(resting(made, upper=8)) is None
    assert optimum(resting(made, upper=9)) == 8
    assert optimum(resting(made, lower=9)) is None
