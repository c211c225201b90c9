"""A layer of a beam search: its states lead exactly to the states that lie one move away."""

from hypothesis import given, settings

from smash.planners.astar import state as states
from smash.planners.astar.layer import expand_layer
from smash.planners.astar.moves import list_moves
from smash.planners.astar.search import BEST, NODES, UPPER
from smash.planners.astar.store import make_store
from smash.problem import PlanOptions, State
from smash.problem.sets.generators import generate
from tests.planners.astar.hands import Hand
from tests.strategies import instances, plan_options

UP = 60


def layer_of(hand):
    """Return the start, settled, and what its direct moves cost."""
    hand.take_up(State.start_of(hand.instance))
    cost = 2 * states.settle(hand.task, hand.cells)
    return hand.filed(), cost


def filed_in(hand, store):
    size = hand.task.blocks
    return {tuple(store.states[node * size : (node + 1) * size]) for node in range(store.counters[NODES])}


@settings(max_examples=60, deadline=None)
@given(instances(min_blocks=1, max_blocks=5), plan_options())
def test_the_next_layer_is_what_lies_one_move_away(instance, options):
    hand = Hand(instance, options)
    task, cells = hand.task, hand.cells
    row, cost = layer_of(hand)
    expected = set()
    for block, code in hand.pairs(task.moves, list_moves(task, cells)):
        states.unpack(task, cells, row, 0)
        states.apply_move(task, cells, block, code)
        states.settle(task, cells)
        if not states.is_goal(task, cells):
            expected.add(tuple(hand.filed()))
    store = make_store(task, False, 200, UP, UP)
    assert expand_layer(task, cells, row, [cost], [0], store, 0, 1) == 1
    if store.counters[BEST] < 0:
        assert filed_in(hand, store) == expected
    else:  # a goal is one move away: only what may lead to a cheaper plan is filed after it
        assert store.counters[UPPER] < UP
        assert filed_in(hand, store) - goals_in(hand, store) <= expected


def goals_in(hand, store):
    """Return the filed states in which the goal holds."""
    goals = set()
    for row in filed_in(hand, store):
        states.unpack(hand.task, hand.cells, row, 0)
        states.judge(hand.task, hand.cells)
        if states.is_goal(hand.task, hand.cells):
            goals.add(row)
    return goals


def test_where_the_store_is_full_the_state_is_expanded_again():
    hand = Hand(generate("multi", 6, buffers=2, seed=1)[0], PlanOptions(topple=False))
    row, cost = layer_of(hand)
    store = make_store(hand.task, False, 1, UP, UP)
    assert expand_layer(hand.task, hand.cells, [*row, *row], [cost] * 2, [0] * 2, store, 0, 2) == 0
    roomy = make_store(hand.task, False, 100, UP, UP)
    assert expand_layer(hand.task, hand.cells, [*row, *row], [cost] * 2, [0] * 2, roomy, 0, 2) == 2
    assert set(roomy.parent[: roomy.counters[NODES]]) == {0}


def test_with_few_moves_allowed_at_a_time_the_next_layer_is_the_same():
    hand = Hand(generate("multi", 7, buffers=2, seed=1)[0], PlanOptions(topple=False))
    row, cost = layer_of(hand)
    whole, parts = (make_store(hand.task, False, 500, UP, UP) for _ in range(2))
    assert expand_layer(hand.task, hand.cells, row, [cost], [0], whole, 0, 1) == 1
    looks, begun = 0, 0
    while begun < 1:
        hand.cells[hand.task.allowed] = 2
        begun = expand_layer(hand.task, hand.cells, row, [cost], [0], parts, begun, 1)
        looks += 1
    assert looks > 2
    assert filed_in(hand, parts) == filed_in(hand, whole)
    assert parts.counters[NODES] == whole.counters[NODES]
