"""States in hand: filed and taken apart without loss, moved as the law moves them, settled only by right moves."""

import random

from hypothesis import given, settings
from hypothesis import strategies as st

from smash.planners.astar import state as states
from smash.planners.astar.task import TOPPLED
from smash.problem import TABLE, Pick, Place, PlanOptions, StacksGoal, State, Topple, make_instance
from tests.planners.astar.hands import Hand, walked
from tests.strategies import instances, plan_options

seeds = st.integers(0, 9999)


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=5), plan_options(), seeds)
def test_a_filed_state_is_what_was_filed(instance, options, seed):
    hand = Hand(instance, options)
    state = walked(instance, options, random.Random(seed))
    hand.take_up(state)
    assert hand.filed() == hand.row(state)
    states.judge(hand.task, hand.cells)
    assert states.is_goal(hand.task, hand.cells) == (hand.law.goal_shortfall(state) is None)


def end_of(hand, state, action):
    """Return the move that says the same as a legal transfer or topple, and the state after it."""
    number, law = hand.problem.block_number, hand.law
    if isinstance(action, Topple):
        fallen = number[state.piles[action.location][action.height - 1]]
        law.apply(state, action)
        return (fallen, TOPPLED), 1
    (pick, place) = action
    pile = state.piles[place.target] if place.target != pick.source else state.piles[place.target][:-1]
    floor = hand.setting.class_of[hand.instance.locations.index(place.target)]
    code = number[pile[-1]] if pile else hand.task.blocks + floor
    law.apply(state, pick)
    law.apply(state, place)
    return (number[pick.block], code), 2


@settings(max_examples=60, deadline=None)
@given(instances(min_blocks=1, max_blocks=5), plan_options(), seeds)
def test_a_move_leads_where_the_law_leads_at_the_same_cost(instance, options, seed):
    draw, hand = random.Random(seed), Hand(instance, options)
    state = walked(instance, options, draw)
    hand.take_up(state)
    topples = [action for action in hand.law.legal_actions(state) if isinstance(action, Topple)]
    picks = [action for action in hand.law.legal_actions(state) if isinstance(action, Pick)]
    transfers = [(pick, Place(pick.block, to)) for pick in picks for to in instance.locations if to != pick.source]
    if not topples and not transfers:
        return
    move, cost = end_of(hand, state, draw.choice([*topples, *transfers]))
    assert states.apply_move(hand.task, hand.cells, *move) == cost
    assert hand.filed() == hand.row(state)


@settings(max_examples=60, deadline=None)
@given(instances(min_blocks=1, max_blocks=5, kinds=("stacks", "positions")), plan_options(), seeds)
def test_settling_makes_legal_moves_to_final_places_and_leaves_none(instance, options, seed):
    hand = Hand(instance, options)
    state = walked(instance, options, random.Random(seed))
    hand.take_up(state)
    count = states.settle(hand.task, hand.cells)
    wanted = instance.goal.stacks if isinstance(instance.goal, StacksGoal) else instance.goal.stacks()
    home = {block: (at, level) for at, pile in wanted.items() for level, block in enumerate(pile)}
    for block_number, _ in hand.pairs(hand.task.trail, count):
        block = instance.blocks[block_number]
        target, level = home[block]
        source = next((at for at, pile in state.piles.items() if block in pile), TABLE)
        hand.law.apply(state, Pick(block, source))
        assert len(state.piles[target]) == level
        assert list(wanted[target][:level]) == state.piles[target]
        hand.law.apply(state, Place(block, target))
    assert hand.filed() == hand.row(state)
    tops = {pile[-1] for pile in state.piles.values() if pile} | state.table
    for target, pile in wanted.items():
        standing = state.piles[target]
        if standing == list(pile[: len(standing)]) and len(standing) < len(pile):
            assert pile[len(standing)] not in tops


def test_what_is_right_for_good_is_the_common_bottom_part():
    instance = make_instance(
        name="x", blocks="abc", stacks=["s1", "s2"], start={"s1": "abc"}, goal=StacksGoal({"s1": ("a", "c", "b")})
    )
    hand = Hand(instance, PlanOptions())
    hand.take_up(State.start_of(instance))
    states.judge(hand.task, hand.cells)
    assert hand.cells[hand.task.keep] == 1
