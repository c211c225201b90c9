"""The precedence bound that other planners build on: it holds, its plan is legal, and it is told at once."""

import math
from time import perf_counter

import pytest
from hypothesis import assume, given, settings

from smash.planners.precedence.bound import precedence_bound
from smash.planners.precedence.emptying import places_decide
from smash.planners.precedence.waiting import waits_decide
from smash.problem import Law, PlanOptions
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4), plan_options())
def test_the_bound_holds_and_its_plan_costs_what_the_cheapest_choices_say(instance, options):
    best = optimal_cost(instance, options)
    assume(best is not None)
    bound = precedence_bound(Problem(instance, options), math.inf)
    assert bound.relaxed_cost <= bound.bound <= best
    beyond = places_decide(Problem(instance, options)) or waits_decide(Problem(instance, options))
    assert bound.bound == bound.relaxed_cost or beyond
    if bound.actions is not None:
        assert Law(instance, options).check(bound.actions).accepted
        assert len(bound.actions) >= best
        assert len(bound.actions) == bound.relaxed_cost == best or beyond
    assert bound.settled == (bound.actions is not None and len(bound.actions) == bound.bound == best)


def test_bounds_and_plans_are_told_as_they_are_found():
    instance, options = wide(40, 5, seed=4, buffers=40), PlanOptions(topple=False)
    bounds, costs = [], []
    bound = precedence_bound(
        Problem(instance, options), math.inf, on_plan=lambda plan: costs.append(len(plan)), on_bound=bounds.append
    )
    assert bounds == sorted(set(bounds))
    assert costs == sorted(set(costs), reverse=True)
    assert bounds[-1] == bound.bound == costs[-1]


@pytest.mark.parametrize("topple", [True, False])
def test_past_the_deadline_the_bound_still_holds(topple):
    instance, options = wide(30, 4, seed=2, buffers=30), PlanOptions(topple)
    late, whole = (
        precedence_bound(Problem(instance, options), -math.inf),
        precedence_bound(Problem(instance, options), math.inf),
    )
    assert late.bound <= whole.bound <= late.relaxed_cost


def test_choices_that_do_not_fit_the_locations_are_told_once():
    told = []
    problem = Problem(wide(30, 3, seed=2), PlanOptions(topple=False))
    precedence_bound(problem, perf_counter() + 0.3, on_no_plan=lambda: told.append(True))
    assert told == [True]
