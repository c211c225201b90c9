"""The search over the law's states: cheapest plans and bounds of uniform-cost search, whatever actions and costs."""

import math

import pytest
from hypothesis import given, settings

from smash.planners.astar import law_search
from smash.planners.astar.law_search import LawSearch
from smash.problem import Carrier, Costs, Law, PlanOptions, PositionsGoal, StacksGoal, State, make_instance
from tests.cheapest import cheapest_plan
from tests.strategies import EVERY_KIND, family_instances, family_options

NO_TOPPLE = PlanOptions(topple=False)


def searched(instance, options, **more):
    """Run a search to its end; return it, its plans and the bounds that it reported."""
    law = Law(instance, options)
    search, plans, bounds = LawSearch(law, **more), [], []
    first = search.bound
    while (plan := search.run(math.inf, bounds.append)) is not None:
        plans.append(plan)
        assert law.check(plan).cost == search.below
    return search, plans, [first, *bounds]


def swap(costs=None, **more):
    """Return the instance of a pile a, b that is to be turned over."""
    return make_instance({"s": ["a", "b"]}, StacksGoal({"s": ("b", "a")}), costs=costs or Costs({"pick": 3}), **more)


EXCHANGE = make_instance(
    {"s": ["a"], "t": ["b"]}, StacksGoal({"s": ("b",), "t": ("a",)}), costs=Costs({"pick": 3}), buffers=2
)
"""Two blocks change places: 8 by the estimate, 12 in truth, for one of them has to be put aside."""


@settings(max_examples=40, deadline=None)
@given(family_instances(max_blocks=3, max_stacks=2, kinds=EVERY_KIND), family_options())
def test_the_first_plan_is_a_cheapest_one_and_the_end_is_its_proof(instance, options):
    best = cheapest_plan(instance, options)
    search, plans, bounds = searched(instance, options)
    assert search.ended == "exhausted"
    assert bounds == sorted(bounds)
    if best is None:
        assert plans == []
    else:
        assert [search.law.check(plan).cost for plan in plans] == [best[0]]
        assert search.bound == bounds[-1] == best[0]


@settings(max_examples=30, deadline=None)
@given(family_instances(max_blocks=3, max_stacks=2, kinds=EVERY_KIND), family_options())
def test_with_a_weight_plans_improve_to_a_cheapest_one_and_only_the_start_bounds(instance, options):
    best = cheapest_plan(instance, options)
    search, plans, bounds = searched(instance, options, weight=4.0)
    assert search.ended == "exhausted"
    assert len(bounds) == 1
    if best is None:
        assert plans == []
    else:
        costs = [search.law.check(plan).cost for plan in plans]
        assert costs == sorted(set(costs), reverse=True)
        assert costs[-1] == best[0]
        assert search.bound <= best[0]


def test_with_a_weight_a_state_that_is_reached_at_less_cost_is_searched_again():
    at = {"s": (3.0, 0.0), "t": (3.0, 0.0), "u1": (0.0, 0.0), "u2": (1.0, 0.0), "table": (0.0, 0.0)}
    costs = Costs({"topple": 5}, travel=1.0, positions=at)
    instance = make_instance(
        {"s": ["c", "b", "a"]}, StacksGoal({"s": ("a", "c", "b")}), stacks=["t"], buffers=2, costs=costs
    )
    search, plans, _ = searched(instance, PlanOptions(), weight=4.0)
    assert search.law.check(plans[-1]).cost == cheapest_plan(instance)[0] == 16


@pytest.mark.parametrize(("weight", "bound"), [(1.0, 12), (4.0, 8)])
def test_only_what_is_cheaper_than_the_plan_known_is_looked_for(weight, bound):
    assert cheapest_plan(EXCHANGE, NO_TOPPLE)[0] == 12
    search, plans, _ = searched(EXCHANGE, NO_TOPPLE, below=12, weight=weight)
    assert (plans, search.ended, search.bound) == ([], "exhausted", bound)
    assert len(searched(EXCHANGE, NO_TOPPLE, below=13, weight=weight)[1]) == 1


def test_where_no_plan_exists_the_end_says_so_and_nothing_is_bounded():
    search, plans, _ = searched(swap(stacks=["t"]), NO_TOPPLE)
    assert (plans, search.ended, search.below) == ([], "exhausted", math.inf)


def test_spent_memory_is_no_end_of_the_search_space(monkeypatch):
    monkeypatch.setattr(law_search, "MOST_OPEN", 1)
    search = LawSearch(Law(EXCHANGE, NO_TOPPLE))
    assert search.run(math.inf) is None
    assert (search.ended, search.bound) == ("memory", 8)


def test_past_its_time_it_pauses_and_goes_on_later():
    search = LawSearch(Law(swap(buffers=2), NO_TOPPLE))
    assert search.run(0.0) is None
    assert (search.ended, search.expanded) == (None, 0)
    assert search.law.check(search.run(math.inf)).cost == cheapest_plan(swap(buffers=2), NO_TOPPLE)[0]


def test_buffers_that_are_alike_are_one_group_and_stacks_never():
    groups = law_search._interchangeable
    assert groups(swap(buffers=3, stacks=["t"])) == [("t",), ("s",), ("u1", "u2", "u3")]
    at = {"s": (0.0, 0.0), "u1": (1.0, 0.0), "u2": (2.0, 0.0), "u3": (1.0, 0.0), "table": (0.0, 0.0)}
    far = swap(Costs(travel=1.0, positions=at), buffers=3)
    assert groups(far) == [("s",), ("u1", "u3"), ("u2",)]


def test_states_that_differ_in_the_names_of_buffers_alone_are_one():
    search = LawSearch(Law(EXCHANGE, NO_TOPPLE))
    first, second = (State({"s": ["b"], "t": [], "u1": one, "u2": two}) for one, two in ((["a"], []), ([], ["a"])))
    assert search._key(first) == search._key(second) != search._key(State.start_of(EXCHANGE))
    assert [target[0] for target in search._targets(State.start_of(EXCHANGE))] == ["s", "t", "u1"]


def test_a_carry_is_paid_once_for_all_that_is_on_the_carrier():
    at = {"s": (0.0, 0.0), "near": (0.0, 0.0), "t": (9.0, 0.0), "far": (9.0, 0.0), "table": (0.0, 0.0)}
    instance = make_instance(
        {"s": ["a", "b"]},
        PositionsGoal({"a": ("t", 2), "b": ("t", 1)}),
        carriers=[Carrier("tray", ("near", "far"), "near", 2)],
        costs=Costs(travel=1.0, positions=at),
    )
    _, plans, bounds = searched(instance, NO_TOPPLE)
    assert bounds[-1] == cheapest_plan(instance, NO_TOPPLE)[0] == 18
    assert sum(type(action).__name__ == "Carry" for action in plans[-1]) == 1
