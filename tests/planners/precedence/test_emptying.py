"""Which piles to empty, which tower where: the bound holds for all `on` goals, and sees what cycles alone do not."""

import math

import pytest
from hypothesis import assume, given, settings

from smash.planners.precedence import emptying
from smash.planners.precedence.emptying import bases, emptying_bound, places_decide
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.hitting_set import HittingSetSolver
from smash.problem import OnGoal, PlanOptions, make_instance
from smash.problem.problem import Problem
from smash.problem.views.demands import demands_of
from tests.oracle import optimal_cost
from tests.relations import related
from tests.strategies import instances, plan_options


def bounds(problem, maxsat=False):
    """Return the bound of the cycles alone, and that of the joined model."""
    graph = build_graph(problem)
    found = HittingSetSolver(graph).solve(math.inf)
    told = []
    joined = emptying_bound(problem, graph, found.cycles, math.inf, told.append, maxsat=maxsat)
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
    assert places_decide(problem)
    assert bases(problem) == {"a", "c"}
    cycles, joined = bounds(problem)
    assert cycles == 2
    assert joined == cost == optimal_cost(instance, options)


@pytest.mark.parametrize("maxsat", [False, True])
def test_what_leaves_a_location_is_in_the_way_of_the_tower_that_is_built_there(maxsat):
    """Wherever c and b go with one location free, one of them cannot move directly; no location is short, though."""
    goal = OnGoal({"a": "b"}, ("c",))
    instance = make_instance({"s1": "acb"}, goal, name="x", blocks="abc", stacks=["s1", "s2"])
    problem = Problem(instance, PlanOptions(max_topple=2))
    assert places_decide(problem)
    assert bounds(problem, maxsat) == (6, 7)
    assert optimal_cost(instance, problem.options) == 7


@pytest.mark.parametrize("maxsat", [False, True])
def test_of_two_towers_at_one_location_one_is_whole_before_the_other_is_begun(maxsat):
    """Neither c on d nor a on b has to be at a bottom, and on two locations neither can wait for the other."""
    goal = OnGoal({"c": "d", "a": "b"})
    instance = make_instance({"s1": "c", "u1": "adb"}, goal, name="x", blocks="abcd", stacks=["s1"], buffers=["u1"])
    problem = Problem(instance, PlanOptions())
    assert places_decide(problem)
    assert bounds(problem, maxsat) == (8, 11)
    assert optimal_cost(instance, problem.options) == 11


def three_towers():
    """Return a problem in which three towers are begun anew at the one location there is."""
    goal = OnGoal({"a": "b", "c": "d", "e": "f"})
    return Problem(make_instance({}, goal, name="x", blocks="abcdef", stacks=["s1"], table="abcdef"), PlanOptions())


def test_the_towers_of_a_solution_are_built_in_its_order():
    """Whichever of three towers at one location is the lowest: the places name it first, and the demands build it."""
    problem = three_towers()
    built = []

    def on_places(places):
        chain = demands_of(problem.posed, places.kept, places.at).build["s1"]
        assert [block for block in chain if block in places.at] == list(places.at)
        built.append(chain)

    bound = emptying_bound(problem, build_graph(problem), (), math.inf, lambda bound: None, on_places=on_places)
    assert bound == optimal_cost(problem.instance, problem.options) == 12
    assert sorted(built[-1]) == list("abcdef")


def test_no_three_towers_are_each_below_the_next():
    model = emptying.PlacesModel(three_towers())
    round_about = {model.under[pair] for pair in (("b", "d"), ("d", "f"), ("f", "b"))}
    assert model._cut_off_orders(round_about) == 1
    assert model._cut_off_orders(round_about) == 0
    assert tuple(sorted(-literal for literal in round_about)) in model.clauses.asked


def test_where_too_many_pairs_would_have_to_be_kept_apart_their_order_is_left_open(monkeypatch):
    monkeypatch.setattr(emptying, "MOST_PAIRS", 3)
    assert not emptying.PlacesModel(three_towers()).under


def pairs_exchanged(stacks):
    """Return piles of two blocks, whose lower ones are to carry the next pile's upper one; no tower is at a bottom."""
    piles = {f"s{number}": (f"a{number}", f"b{number}") for number in range(stacks)}
    goal = OnGoal({f"b{number}": f"a{(number + 1) % stacks}" for number in range(stacks)})
    blocks = [block for pile in piles.values() for block in pile]
    return Problem(make_instance(piles, goal, name="x", blocks=blocks, stacks=[*piles]), PlanOptions())


def test_towers_that_may_stand_on_anything_make_the_model_larger_too():
    model = emptying.PlacesModel(pairs_exchanged(20))
    assert len(model.clauses.asked) > 20 * 20 * 19 // 2
    assert not emptying.too_large(pairs_exchanged(20))
    assert emptying.too_large(pairs_exchanged(200))


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4, kinds=("on",)), plan_options())
def test_both_solvers_prove_the_same(instance, options):
    problem = Problem(instance, options)
    assume(problem.infeasible is None)
    assert bounds(problem, maxsat=True) == bounds(problem)


def test_where_places_are_free_the_cycles_decide():
    goal = OnGoal({}, ("a", "b"))
    instance = make_instance({"s1": ("a", "b")}, goal, name="x", blocks="ab", stacks=["s1", "s2"])
    assert not places_decide(Problem(instance, PlanOptions()))
