"""Planning with the whole family: the exact planners agree with uniform-cost search over the law."""

import pytest
from hypothesis import given, settings

from smash.planners.astar import AStarPlanner
from smash.planners.greedy import GreedyPlanner
from smash.planners.portfolio import SmashPlanner
from smash.planners.precedence.planner import PrecedencePlanner
from smash.planners.protocol import Settings, SolveOptions, why_refused
from smash.problem import Costs, Law, PlanOptions, State
from smash.problem.problem import Problem
from smash.problem.views.distances import Estimate
from tests.cheapest import cheapest_plan
from tests.problem.test_family import scoop
from tests.strategies import EVERY_KIND, family_instances, family_options


def solve_options(options):
    return SolveOptions(options.topple, options.max_topple, without=options.without)


@pytest.mark.parametrize("planner", [SmashPlanner(), AStarPlanner()])
@given(instance=family_instances(kinds=EVERY_KIND, hand=True), options=family_options())
@settings(max_examples=60, deadline=None)
def test_the_optimum_is_that_of_uniform_cost_search(planner, instance, options):
    best = cheapest_plan(instance, options)
    result = planner.solve(instance, solve_options(options), 20.0)
    if best is None:
        assert result.status == "infeasible"
    else:
        assert (result.status, result.cost, result.lower_bound) == ("optimal", best[0], best[0])
        assert Law(instance, options).check(result.actions).cost == best[0]


@given(instance=family_instances(), options=family_options())
@settings(max_examples=60, deadline=None)
def test_the_estimate_is_no_more_than_what_a_cheapest_plan_still_costs(instance, options):
    best = cheapest_plan(instance, options)
    if best is None:
        return
    law, estimate = Law(instance, options), Estimate(Law(instance, options))
    state, left = State.start_of(instance), best[0]
    for action in best[1]:
        if state.hand is None:
            assert estimate.of(state) <= left + 1e-6
        left -= law.cost(state, action)
        law.apply(state, action)


@given(instance=family_instances(), options=family_options())
@settings(max_examples=60, deadline=None)
def test_greedy_plans_are_legal_and_cost_what_they_say(instance, options):
    result = GreedyPlanner().solve(instance, solve_options(options), 1.0)
    if result.actions is not None:
        assert Law(instance, options).check(result.actions).cost == result.cost


def test_a_planner_that_counts_actions_of_three_kinds_says_so():
    def why(instance, options):
        return why_refused(PrecedencePlanner(), Problem(instance, options), Settings())

    left_out = PlanOptions(without=("carry", "lift"))
    assert "does not plan with carry" in why(scoop(), PlanOptions())
    assert "costs are in ms" in why(scoop(), left_out)
    assert why(scoop(costs=Costs()), left_out) is None
    assert Problem(scoop(costs=Costs()), left_out).plain


def test_smash_says_which_of_its_methods_are_exact():
    result = SmashPlanner().solve(scoop(), SolveOptions(), 10.0)
    assert result.status == "optimal"
    assert {"precedence", "search"} <= result.details["left_out"].keys()
    assert {"greedy", "the law's states"} <= result.details["seconds"].keys()
