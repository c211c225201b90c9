"""Moves worth trying: each is legal, and an optimum is among what they lead to."""

import heapq
import random

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from smash.planners.astar import state as states
from smash.planners.astar.moves import list_moves
from smash.planners.astar.task import TOPPLED
from smash.problem import OnGoal, PlanOptions, StacksGoal, State, make_instance
from tests.oracle import optimal_cost
from tests.planners.astar.hands import Hand, walked
from tests.strategies import instances, plan_options


def moves_in(hand):
    return hand.pairs(hand.task.moves, list_moves(hand.task, hand.cells))


@settings(max_examples=60, deadline=None)
@given(instances(min_blocks=1, max_blocks=5), plan_options(), st.integers(0, 9999))
def test_moves_take_accessible_blocks_to_tops_and_free_floors_and_topple_what_may_fall(instance, options, seed):
    hand = Hand(instance, options)
    state = walked(instance, options, random.Random(seed))
    hand.take_up(state)
    if states.settle(hand.task, hand.cells):
        return
    number = hand.problem.block_number
    piles = {at: [number[block] for block in pile] for at, pile in state.piles.items()}
    loose = {number[block] for block in state.table}
    tops = {pile[-1] for pile in piles.values() if pile}
    floors = {
        hand.task.blocks + kind
        for at, kind in zip(instance.locations, hand.setting.class_of, strict=True)
        if not piles[at]
    }
    moves = moves_in(hand)
    assert len(set(moves)) == len(moves)
    for block, code in moves:
        if code == TOPPLED:
            at, pile = next((at, pile) for at, pile in piles.items() if block in pile)
            assert options.topple
            assert at in instance.stacks
            assert len(pile) - pile.index(block) <= (options.max_topple or len(pile))
        else:
            assert block in tops | loose
            assert code != block
            assert code in tops | floors


def cheapest_by_moves(hand, most):
    """Return the least cost of reaching the goal by direct moves and `list_moves` alone; None beyond `most`."""
    task, cells = hand.task, hand.cells
    hand.take_up(State.start_of(hand.instance))
    queue, seen = [(2 * states.settle(task, cells), hand.filed())], set()
    while queue:
        cost, row = heapq.heappop(queue)
        if tuple(row) in seen or cost > most:
            continue
        seen.add(tuple(row))
        states.unpack(task, cells, row, 0)
        states.settle(task, cells)
        if states.is_goal(task, cells):
            return cost
        for block, code in moves_in(hand):
            states.unpack(task, cells, row, 0)
            after = cost + states.apply_move(task, cells, block, code)
            after += 2 * states.settle(task, cells)
            heapq.heappush(queue, (after, hand.filed()))
    return None


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4), plan_options())
def test_the_moves_left_out_are_needed_by_no_optimum(instance, options):
    best = optimal_cost(instance, options)
    assume(best is not None)
    assert cheapest_by_moves(Hand(instance, options), best) == best


def test_where_relations_leave_few_locations_blocks_may_fall_one_by_one_or_all_at_once():
    instance = make_instance(
        name="x", blocks="abcd", stacks=["s1", "s2"], start={"s1": "abc", "s2": "d"}, goal=OnGoal({"a": "d"})
    )
    hand = Hand(instance, PlanOptions())
    hand.take_up(State.start_of(instance))
    states.settle(hand.task, hand.cells)
    assert {(1, TOPPLED), (2, TOPPLED)} <= set(moves_in(hand))
    assert cheapest_by_moves(hand, 9) == 3


def test_a_stack_is_toppled_from_the_lowest_block_that_must_leave():
    instance = make_instance(
        name="x", blocks="abc", stacks=["s1", "s2"], start={"s1": "abc"}, goal=StacksGoal({"s1": ("a", "c", "b")})
    )
    hand = Hand(instance, PlanOptions())
    hand.take_up(State.start_of(instance))
    states.settle(hand.task, hand.cells)
    assert moves_in(hand) == [(1, TOPPLED)]
