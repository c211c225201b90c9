"""The two models of positions: exact within their horizon, and one where both take the problem."""

import pytest
from hypothesis import assume, given, settings

from smash.planners.layered.network.positions import build_network_positions
from smash.planners.layered.plain_positions import build_plain_positions
from smash.planners.layered.positions import read_positions
from smash.problem import Carrier, Carry, Costs, IllegalAction, Lift, OnGoal, PlanOptions, PositionsGoal
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.planners.layered.made import NO_TOPPLE, optimum, problem, reversal, solved
from tests.strategies import instances, plan_options

BOTH = pytest.mark.parametrize("build", [build_plain_positions, build_network_positions])


@BOTH
@pytest.mark.parametrize(
    ("options", "horizon", "cost"), [(None, 3, 5), (None, 2, None), (NO_TOPPLE, 4, 8), (NO_TOPPLE, 3, None)]
)
def test_a_pile_is_turned_over_where_the_horizon_holds_it(build, options, horizon, cost):
    made = reversal(options=options)
    model = build(made, horizon, 0, None)
    assert optimum(model) == cost
    if cost:
        assert made.law.check(read_positions(made, model, solved(model).vector)).cost == cost


@BOTH
@pytest.mark.parametrize(("cap", "cost"), [(None, 3), (1, 4)])
def test_a_cap_costs_further_topples(build, cap, cost):
    made = problem({"s": "tab"}, PositionsGoal({"t": ("t", 1)}), options=PlanOptions(max_topple=cap))
    assert optimum(build(made, 3, 0, None)) == cost


@BOTH
def test_the_relations_of_an_on_goal_hold_at_any_location(build):
    made = problem({"s": "ab", "t": "c"}, OnGoal({"c": "b"}), options=NO_TOPPLE)
    model = build(made, 2, 0, None)
    assert optimum(model) == 2
    assert made.law.check(read_positions(made, model, solved(model).vector)).accepted


@BOTH
def test_the_rows_of_the_cost_keep_out_what_is_too_cheap_or_no_better(build):
    assert optimum(build(reversal(), 3, 0, 5)) is None
    assert optimum(build(reversal(), 3, 0, 6)) == 5
    assert optimum(build(reversal(), 3, 6, None)) > 5


@BOTH
def test_a_block_moves_three_times_where_buffers_are_few(build):
    made = problem({"s": "abc"}, {"t": "acb"}, "s t", "u", NO_TOPPLE)
    assert optimum(build(made, 6, 0, None)) == cheapest_plan(made.instance, made.options)[0]


@settings(max_examples=15, deadline=None)
@given(instances(min_blocks=1, max_blocks=3, max_stacks=2, max_buffers=1), plan_options())
def test_both_row_sets_have_one_optimum_and_it_is_a_plans(instance, options):
    made = Problem(instance, options)
    assume(not made.solved)
    plain, network = (build(made, 4, 0, None) for build in (build_plain_positions, build_network_positions))
    assert optimum(plain) == optimum(network)
    for model in (plain, network):
        vector = solved(model).vector
        if vector is not None:
            assert made.law.check(read_positions(made, model, vector)).cost == optimum(plain)


def test_a_solution_of_another_problem_is_refused():
    made = reversal()
    model = build_plain_positions(made, 3, 0, None)
    with pytest.raises(IllegalAction):
        read_positions(reversal(options=NO_TOPPLE), model, solved(model).vector)


TRAY = Carrier("tray", ("near", "far"), "near", 2)


def test_a_carry_is_paid_once_for_all_that_it_holds():
    # two blocks over 10 m: by hand 2 (2 + 10), by the tray 2 (2 + 0) twice and one carry of 1 + 10
    at = {"s": (0.0, 0.0), "near": (0.0, 0.0), "t": (10.0, 0.0), "far": (10.0, 0.0), "table": (0.0, 0.0)}
    made = problem({"s": "ab"}, {"t": "ba"}, options=NO_TOPPLE, carriers=(TRAY,), costs=Costs(travel=1.0, positions=at))
    model = build_network_positions(made, 5, 0, None)
    assert optimum(model) == 19
    assert Carry("tray", "far") in read_positions(made, model, solved(model).vector)


@pytest.mark.parametrize(("price", "cost"), [(2, 6), (9, 8)])
def test_prices_decide_between_a_topple_and_detours(price, cost):
    made = problem({"s": "ab"}, {"s": "ba"}, "s", "u v", costs=Costs({"topple": price}))
    assert optimum(build_network_positions(made, 4, 0, None)) == cost


def test_a_lift_moves_a_tower_in_its_order():
    made = problem({"s": "abc"}, PositionsGoal({"b": ("t", 1), "c": ("t", 2)}), capacities={"lift": 2})
    model = build_network_positions(made, 1, 0, None)
    assert read_positions(made, model, solved(model).vector) == (Lift("s", 2, "t"),)
