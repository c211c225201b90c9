"""Where blocks wait: the bound holds for all goals of positions, and a solution that leaves no block free is a plan."""

import math
from time import perf_counter

import pytest
from hypothesis import assume, given, settings

from smash.planners.precedence import waiting
from smash.planners.precedence.bound import precedence_bound
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.hitting_set import HittingSetSolver
from smash.planners.precedence.waiting import waiting_bound, waits_decide
from smash.problem import OnGoal, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.problem import Problem
from tests.oracle import optimal_cost
from tests.strategies import instances

SOLVERS = [False, True]
PICK_AND_PLACE = PlanOptions(topple=False)


def bound_and_plan(problem, maxsat=False):
    """Return the bound of the model, and the plan that its solution is, or None."""
    told, plans = [], []
    bound = waiting_bound(problem, math.inf, told.append, on_plan=plans.append, maxsat=maxsat)
    assert told == sorted(set(told))
    assert bound == told[-1]
    return bound, plans[0] if plans else None


def agrees_with_search(problem, maxsat):
    """Say that the bound is no more than the optimum, no less than that of the cycles, and met by the plan."""
    graph = build_graph(problem)
    cycles = graph.base_cost + HittingSetSolver(graph).solve(math.inf).bound
    bound, plan = bound_and_plan(problem, maxsat)
    assert cycles <= bound <= optimal_cost(problem.instance, problem.options)
    if plan is not None:
        assert len(plan) == bound
        assert problem.law.check(plan).accepted


def takes(instance):
    """Return the problem where the model is one for it."""
    problem = Problem(instance, PICK_AND_PLACE)
    assume(problem.infeasible is None and waits_decide(problem))
    return problem


@settings(max_examples=15, deadline=None)
@given(instances(max_blocks=3, kinds=("stacks", "positions")))
def test_no_plan_is_cheaper_and_it_is_no_weaker_than_the_cycles(instance):
    agrees_with_search(takes(instance), maxsat=False)


@settings(max_examples=25, deadline=None)
@given(instances(max_blocks=4, kinds=("stacks", "positions")))
def test_no_plan_is_cheaper_by_maxsat(instance):
    agrees_with_search(takes(instance), maxsat=True)


@pytest.mark.slow
@settings(max_examples=500, deadline=None)
@given(instances(min_blocks=3, max_blocks=5, kinds=("stacks", "positions")))
def test_no_plan_of_hundreds_of_larger_problems_is_cheaper(instance):
    agrees_with_search(takes(instance), maxsat=True)


def swapped():
    """Return two blocks in one pile that change places, with two free locations."""
    goal = StacksGoal({"s1": ("b", "a")})
    return Problem(
        make_instance({"s1": "ab"}, goal, name="x", blocks="ab", stacks=["s1"], buffers=["u1", "u2"]), PICK_AND_PLACE
    )


@pytest.mark.parametrize("maxsat", SOLVERS)
def test_of_two_blocks_that_wait_in_one_pile_the_upper_one_goes_first(maxsat):
    """Wherever c waits for a to leave, a or b is in its way: the cycles see one block put aside, not the place."""
    goal = StacksGoal({"s1": ("c", "a"), "s2": ("b",)})
    piles = {"s2": "a", "u1": "cb"}
    instance = make_instance(piles, goal, name="x", blocks="abc", stacks=["s1", "s2"], buffers=["u1"])
    agrees_with_search(Problem(instance, PICK_AND_PLACE), maxsat)
    assert bound_and_plan(Problem(instance, PICK_AND_PLACE), maxsat)[0] == 10


@pytest.mark.parametrize("maxsat", SOLVERS)
def test_what_the_goal_does_not_name_is_in_the_way_of_what_waits(maxsat):
    """The cycles alone cost 10: that c has to lie somewhere while d and a change their piles costs 4 more."""
    goal = PositionsGoal({"a": ("s1", 1), "b": ("s2", 1), "d": ("s2", 2)})
    piles = {"s1": "d", "s2": "a", "u1": "bc"}
    instance = make_instance(piles, goal, name="x", blocks="abcd", stacks=["s1", "s2"], buffers=["u1"])
    agrees_with_search(Problem(instance, PICK_AND_PLACE), maxsat)
    assert bound_and_plan(Problem(instance, PICK_AND_PLACE), maxsat)[0] == 14


def test_a_block_that_waits_more_often_than_is_told_apart_is_left_free(monkeypatch):
    monkeypatch.setattr(waiting, "MOST_WAITS", 0)
    assert waiting_bound(swapped(), math.inf, lambda bound: None) == 0


def test_the_plan_of_a_solution_is_the_planners():
    problem = swapped()
    found = precedence_bound(problem, perf_counter() + 10)
    assert found.settled
    assert len(found.actions) == found.bound == optimal_cost(problem.instance, PICK_AND_PLACE)


def test_where_blocks_may_fall_or_piles_are_anywhere_another_model_says_more():
    instance = swapped().instance
    assert waits_decide(swapped())
    assert not waits_decide(Problem(instance, PlanOptions()))
    on = make_instance({"s1": "ab"}, OnGoal({"a": "b"}, ()), name="x", blocks="ab", stacks=["s1", "s2"])
    assert not waits_decide(Problem(on, PICK_AND_PLACE))


def swapped_below_the_table_region(lying):
    """Return three blocks that change their piles, and many that are placed from the table region after them."""
    fallen = [f"t{number}" for number in range(lying)]
    goal = StacksGoal({"s1": ("c", "a", *fallen), "s2": ("b",)})
    piles, blocks = {"s2": "a", "u1": "cb"}, [*"abc", *fallen]
    instance = make_instance(piles, goal, name="x", blocks=blocks, stacks=["s1", "s2"], buffers=["u1"], table=fallen)
    return Problem(instance, PICK_AND_PLACE)


def test_what_is_placed_from_the_table_region_makes_the_model_larger():
    few = swapped_below_the_table_region(40)
    assert bound_and_plan(few, maxsat=True)[0] == 10 + 2 * 40
    assert waits_decide(few)
    model = waiting._Model(few, 1)
    assert len(model.clauses.asked) <= 1.5 * waiting._size(few, 1)
    assert not waits_decide(swapped_below_the_table_region(300))


def test_no_model_is_begun_that_the_time_does_not_allow():
    told = []
    assert waiting_bound(swapped(), perf_counter(), told.append) == 0
    assert not told
