"""The bound of a state: never above the optimum from there, and the optimum where little is in the way."""

import random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from smash.planners.astar import state as states
from smash.planners.astar.bound import lower_bound
from smash.problem import PlanOptions, PositionsGoal, StacksGoal, State, make_instance
from tests.oracle import optimal_cost
from tests.planners.astar.hands import Hand, begun_at, walked
from tests.strategies import EVERY_KIND, instances, plan_options


def bound_of(instance, options, state=None):
    """Return what the direct moves of a state cost and the bound after them."""
    hand = Hand(instance, options)
    hand.take_up(state or State.start_of(instance))
    return 2 * states.settle(hand.task, hand.cells) + lower_bound(hand.task, hand.cells)


@settings(max_examples=80, deadline=None)
@given(instances(max_blocks=4, kinds=EVERY_KIND), plan_options(), st.integers(0, 9999))
def test_no_state_has_a_bound_above_its_optimum(instance, options, seed):
    state = walked(instance, options, random.Random(seed))
    best = optimal_cost(begun_at(instance, state), options)
    assume(best is not None)
    assert bound_of(instance, options, state) <= best


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=5, kinds=("stacks",)), plan_options())
def test_each_misplaced_block_counts_two(instance, options):
    misplaced = len(instance.table)
    for location, pile in instance.start.items():
        wanted = instance.goal.stacks.get(location, ())
        right = next((h for h, pair in enumerate(zip(pile, wanted, strict=False)) if pair[0] != pair[1]), None)
        misplaced += len(pile) - (min(len(pile), len(wanted)) if right is None else right)
    assert bound_of(instance, options) >= 2 * misplaced


def swap_of(piles, goal, topple):
    blocks = sorted("".join(piles.values()))
    instance = make_instance(
        name="x", blocks=blocks, stacks=["s1", "s2", "s3"], buffers=["u1", "u2"], start=piles, goal=goal
    )
    return bound_of(instance, PlanOptions(topple))


@pytest.mark.parametrize(("topple", "cost"), [(True, 5), (False, 6)])
def test_two_swapped_blocks_cost_a_topple_or_a_put_aside_more(topple, cost):
    assert swap_of({"s1": "a", "s2": "b"}, StacksGoal({"s1": ("b",), "s2": ("a",)}), topple) == cost


@pytest.mark.parametrize(("topple", "cost"), [(True, 7), (False, 8)])
def test_a_rotation_of_three_tops_is_one_cycle(topple, cost):
    goal = StacksGoal({"s1": ("c",), "s2": ("a",), "s3": ("b",)})
    assert swap_of({"s1": "a", "s2": "b", "s3": "c"}, goal, topple) == cost


@pytest.mark.parametrize(("topple", "cost"), [(True, 3), (False, 6)])
def test_two_blocks_above_a_target_cost_one_topple_or_two_moves(topple, cost):
    assert swap_of({"s1": "abc"}, PositionsGoal({"a": ("s2", 1)}), topple) == cost


def test_the_goal_costs_nothing():
    assert swap_of({"s1": "ab"}, StacksGoal({"s1": ("a", "b")}), True) == 0
