"""The relaxation: three nodes a block; never dearer than a plan, and dear where order and places cost something."""

import pytest
from hypothesis import assume, given, settings

from smash.planners.layered.network.decode import read_relaxed
from smash.planners.layered.network.moving import Moving
from smash.planners.layered.network.relaxed import build_relaxed
from smash.problem import Costs, Place, PlanOptions, PositionsGoal
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.planners.layered.made import NO_TOPPLE, optimum, problem, reversal, solved
from tests.strategies import family_instances, family_options


def relaxed(made, horizon, lower=0, upper=None, **more):
    return build_relaxed(made, Moving.of(made), horizon, lower, upper, **more)


@pytest.mark.parametrize(
    ("options", "horizon", "cost"), [(None, 3, 5), (None, 2, None), (NO_TOPPLE, 4, 8), (NO_TOPPLE, 3, None)]
)
def test_a_pile_is_turned_over_where_the_horizon_holds_it(options, horizon, cost):
    assert optimum(relaxed(reversal(options=options), horizon)) == cost


def test_what_rests_on_a_goal_keeps_it_from_growing():
    # two locations: b would have to rest where a belongs
    made = problem({"s": "ab"}, {"t": "ab"}, options=NO_TOPPLE, costs=Costs({"pick": 2}))
    assert optimum(relaxed(made, 5)) is None
    assert cheapest_plan(made.instance, made.options) is None


def test_a_topple_is_paid_in_full_and_falls_no_more_than_the_cap():
    made = problem({"s": "tab"}, PositionsGoal({"t": ("t", 1)}), costs=Costs({"topple": 3}))
    assert optimum(relaxed(made, 2)) == 5
    capped = problem(
        {"s": "tab"}, PositionsGoal({"t": ("t", 1)}), costs=Costs({"topple": 3}), options=PlanOptions(max_topple=1)
    )
    assert optimum(relaxed(capped, 3)) == 8  # two topples, t


def test_the_rows_of_the_cost_keep_out_what_is_no_better():
    assert optimum(relaxed(reversal(), 3, 0, 5)) is None
    assert optimum(relaxed(reversal(), 3, 0, 6)) == 5


@settings(max_examples=15, deadline=None)
@given(family_instances(max_blocks=2, max_stacks=2), family_options())
def test_it_is_never_dearer_than_a_cheapest_plan_that_its_layers_hold(instance, options):
    made, best = Problem(instance, options), cheapest_plan(instance, options)
    assume(best is not None and best[0] and not made.demands.met)
    layers = sum(not isinstance(action, Place) for action in best[1])
    assert optimum(relaxed(made, layers)) <= best[0]


def test_its_solutions_are_read_as_plans():
    made = reversal(options=NO_TOPPLE)
    model = relaxed(made, 4, ordered=True)
    assert made.law.check(read_relaxed(made, model, solved(model).vector)).cost == 8
