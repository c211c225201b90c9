"""The contracted gadget with unbounded buffers: its optimum bounds every plan, its edges are those of the gadget."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings

from smash.planners.layered.blocks import MovingBlocks
from smash.planners.layered.events import build_layered, read_events
from smash.planners.layered.horizons import sound_layers
from smash.planners.milp.solvers import highs
from smash.problem import PlanOptions, PositionsGoal
from smash.problem.problem import Problem
from tests.oracle import optimal_cost
from tests.planners.layered.made import NO_TOPPLE, optimum, problem, reversal, solved
from tests.strategies import instances, plan_options


def relaxation(made, horizon=None):
    blocks = MovingBlocks.of(made)
    return build_layered(made, blocks, horizon or sound_layers(blocks))


@pytest.mark.parametrize(("options", "cost"), [(None, 5), (NO_TOPPLE, 8)])
def test_a_pile_is_turned_over_by_a_topple_or_two_detours(options, cost):
    assert optimum(relaxation(reversal(options=options))) == cost


def test_a_direct_move_costs_two_and_a_buried_block_frees_itself_by_the_way_of_what_lies_above():
    assert optimum(relaxation(problem({"s": "a"}, {"t": "a"}))) == 2
    assert optimum(relaxation(problem({"s": "ab"}, PositionsGoal({"a": ("t", 1)}), options=NO_TOPPLE))) == 4


@pytest.mark.parametrize(("cap", "cost"), [(None, 3), (2, 3), (1, 4)])
def test_a_cap_costs_further_topples(cap, cost):
    made = problem({"s": "tab"}, PositionsGoal({"t": ("t", 1)}), options=PlanOptions(max_topple=cap))
    assert optimum(relaxation(made)) == cost


def test_two_blocks_that_wait_for_each_other_do_not_both_move_directly():
    assert optimum(relaxation(problem({"s": "a", "t": "b"}, {"s": "b", "t": "a"}, options=NO_TOPPLE))) == 6


def test_circles_of_waiting_cut_fractional_solutions_off():
    turning = {"s": "a", "t": "b", "v": "c"}, {"s": "c", "t": "a", "v": "b"}
    milp = relaxation(problem(*turning, "s t v", options=NO_TOPPLE)).milp
    fractional = replace(milp, integral=np.zeros(milp.columns, dtype=bool))
    assert highs.solve(fractional, time_limit=10).objective == pytest.approx(8)  # without them 7.2


def test_too_few_layers_hold_no_plan():
    assert optimum(relaxation(reversal(), 2)) is None


def test_what_falls_in_a_layer_is_picked_in_a_later_one():
    made = problem({"s": "ab"}, PositionsGoal({"a": ("t", 1)}))
    assert optimum(relaxation(made, 1)) is None
    assert optimum(relaxation(made, 2)) == 3


def test_a_block_of_the_table_is_picked_and_placed():
    assert optimum(relaxation(problem({}, {"s": "a"}, table=("a",)))) == 2


@settings(max_examples=40, deadline=None)
@given(instances(min_blocks=1, max_blocks=3, max_buffers=1), plan_options())
def test_the_optimum_at_the_sound_horizon_bounds_every_plan(instance, options):
    made, true_cost = Problem(instance, options), optimal_cost(instance, options)
    assume(true_cost)
    assert optimum(relaxation(made)) <= true_cost


def test_events_come_by_layer_and_are_named_after_their_columns():
    made = reversal()
    model = relaxation(made)
    events = read_events(model, solved(model).vector)
    assert [event.kind for event in events] == ["topple", "from_table", "from_table"]
    assert [event.layer for event in events] == sorted(event.layer for event in events)
    assert events[0].location == "s"
    assert model.milp.name(int(model.edges["aside"][0, 1])) == "aside_block0_layer2"
    assert model.milp.name(int(model.topples["s"][0, 0])) == "topple_stack0_cut0_layer1"
