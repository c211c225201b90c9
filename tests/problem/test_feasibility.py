"""Which problems have a plan: the rule agrees with exhaustive search wherever that can look."""

import itertools
import random

import pytest
from hypothesis import given, settings

from smash.problem import OnGoal, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.family_strategies import family_instances
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options

NO_TOPPLE = PlanOptions(topple=False)


def agree(instance, options):
    assert (Problem(instance, options).infeasible is None) == (optimal_cost(instance, options) is not None)


@settings(max_examples=150, deadline=None)
@given(instances(max_blocks=4), plan_options())
def test_the_rule_agrees_with_exhaustive_search(instance, options):
    agree(instance, options)


@settings(max_examples=300, deadline=None)
@given(instances(max_blocks=5, max_stacks=2, max_buffers=0))
def test_the_rule_agrees_without_topple_on_one_and_two_locations(instance):
    agree(instance, NO_TOPPLE)


def random_relations(seed):
    """Draw an `on` goal with any number of bottoms on one or two locations, many blocks on the table."""
    draw = random.Random(seed)
    blocks = [f"b{number}" for number in range(draw.randint(0, 5))]
    draw.shuffle(blocks)
    locations = ["s1", "s2"][: draw.randint(1, 2)]
    places = {block: draw.choice([*locations, *locations, None]) for block in blocks}
    start = {location: [b for b in blocks if places[b] == location] for location in locations}
    table = [b for b in blocks if places[b] is None]
    draw.shuffle(blocks)
    on = {upper: under for under, upper in itertools.pairwise(blocks) if draw.random() < 0.45}
    bottom = [b for b in blocks if b not in on and draw.random() < 0.5]
    return make_instance(
        name="drawn", blocks=blocks, stacks=locations, start=start, table=table, goal=OnGoal(on, tuple(bottom))
    )


@pytest.mark.parametrize("topple", [True, False])
def test_relations_with_any_number_of_bottoms_agree_with_exhaustive_search(topple):
    for seed in range(400):
        agree(random_relations(seed), PlanOptions(topple=topple, max_topple=1 if topple else None))


@settings(max_examples=150, deadline=None)
@given(family_instances(max_blocks=3, max_stacks=2, max_buffers=0))
def test_blocks_on_a_carrier_that_stays_where_it_is_can_be_put_anywhere(instance):
    options = PlanOptions(topple=False, without=("carry", "lift"))
    assert (Problem(instance, options).infeasible is None) == (cheapest_plan(instance, options) is not None)


def test_two_locations_without_topple_keep_their_line():
    def problem(goal):
        return make_instance(name="x", blocks="abc", stacks=["s1", "s2"], start={"s1": "ab", "s2": "c"}, goal=goal)

    assert Problem(problem(StacksGoal({"s2": tuple("cba")})), NO_TOPPLE).infeasible is None
    swapped = problem(StacksGoal({"s1": tuple("ba"), "s2": ("c",)}))
    assert "two locations" in Problem(swapped, NO_TOPPLE).infeasible
    assert Problem(swapped, PlanOptions()).infeasible is None


def test_more_bottoms_than_locations_is_infeasible_even_with_topple():
    instance = make_instance(name="x", blocks="ab", stacks=["s1"], start={"s1": "ab"}, goal=OnGoal({}, ("a", "b")))
    assert "there is 1 location" in Problem(instance, PlanOptions()).infeasible


def test_nothing_to_do_is_feasible():
    for goal in (StacksGoal({}), PositionsGoal({}), OnGoal({})):
        assert (
            Problem(make_instance(name="x", blocks=[], stacks=["s1"], start={}, goal=goal), NO_TOPPLE).infeasible
            is None
        )
