"""Which piles to empty: the bound holds for all `on` goals, and sees what cycles alone do not."""

import math

import pytest
from hypothesis import assume, given, settings

from smash.planners.precedence.emptying import bases, emptying_bound, piles_decide
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.hitting_set import HittingSetSolver
from smash.problem import OnGoal, PlanOptions, make_instance
from smash.problem.problem import Problem
from tests.oracle import optimal_cost
from tests.relations import related
from tests.strategies import instances, plan_options


def bounds(problem):
    """Return the bound of the cycles alone, and that of the joined model."""
    graph = build_graph(problem)
    found = HittingSetSolver(graph).solve(math.inf)
    told = []
    joined = emptying_bound(problem, graph, found.cycles, math.inf, told.append)
    assert told == sorted(set(told))
    assert joined == (told[-1] if told else 0)
    return graph.base_cost + found.bound, joined


@settings(max_examples=150, deadline=None)
@given(instances(max_blocks=4, kinds=("on",)), plan_options())
def test_no_plan_is_cheaper_and_it_is_no_weaker_than_the_cycles(instance, options):
    problem = Problem(instance, options)
    assume(problem.infeasible is None)
    cycles, joined = bounds(problem)
    assert cycles <= joined <= optimal_cost(instance, options)


@pytest.mark.parametrize("seed", range(120))
def test_no_plan_is_cheaper_with_what_rests_on_the_table_or_is_clear(seed):
    problem = related(seed, hand=0.0)
    if problem.infeasible is None:
        cycles, joined = bounds(problem)
        assert cycles <= joined <= optimal_cost(problem.instance, problem.options)


@pytest.mark.parametrize(("options", "cost"), [(PlanOptions(topple=False), 6), (PlanOptions(), 3)])
def test_a_second_bottom_has_the_lower_pile_emptied(options, cost):
    """To be at a bottom c needs the place of two blocks, or that of three."""
    goal = OnGoal({}, ("a", "c"))
    instance = make_instance(
        {"s1": "abc", "s2": "de", "s3": "fgh"}, goal, name="x", blocks="abcdefgh", stacks=["s1", "s2", "s3"]
    )
    problem = Problem(instance, options)
    assert piles_decide(problem)
    assert bases(problem) == {"a", "c"}
    cycles, joined = bounds(problem)
    assert cycles == 2
    assert joined == cost == optimal_cost(instance, options)


def test_where_places_are_free_the_cycles_decide():
    goal = OnGoal({}, ("a", "b"))
    instance = make_instance({"s1": ("a", "b")}, goal, name="x", blocks="ab", stacks=["s1", "s2"])
    assert not piles_decide(Problem(instance, PlanOptions()))
