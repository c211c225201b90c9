"""Shortening: never longer, legal, the same end; a needless put-aside is taken out."""

import random

from hypothesis import given, settings
from hypothesis import strategies as st

from smash.planners.greedy.shorten import shorten
from smash.problem import PlanOptions, PositionsGoal, State, make_instance
from smash.problem.rules import Law
from smash.problem.views.numbered import ON_TABLE, TOPPLE, Numbered, cost_of
from tests.strategies import instances


def steps_drawn(problem, draw, count):
    """Draw legal steps from the start, topples among them."""
    piles, table, steps = [list(pile) for pile in problem.start], list(problem.table), []
    for _ in range(count):
        full = [q for q, pile in enumerate(piles) if pile]
        stacks = [q for q in full if q < problem.stacks]
        if stacks and draw.random() < 0.15:
            location = draw.choice(stacks)
            falling = draw.randint(1, len(piles[location]))
            steps.append((TOPPLE, location, falling))
            table += piles[location][-falling:]
            del piles[location][-falling:]
            continue
        sources = [*full, *([ON_TABLE] * bool(table))]
        if not sources:
            break
        source = draw.choice(sources)
        targets = [q for q in range(len(piles)) if q != source]
        if not targets:
            break
        target = draw.choice(targets)
        block = table.pop(draw.randrange(len(table))) if source == ON_TABLE else piles[source].pop()
        piles[target].append(block)
        steps.append((block, source, target))
    return steps


def end_of(problem, steps):
    """Return the state that legal steps lead to."""
    law, state = Law(problem.instance, PlanOptions()), State.start_of(problem.instance)
    for action in problem.actions(steps):
        law.apply(state, action)
    return state.key()


@settings(max_examples=250, deadline=None)
@given(instances(max_blocks=5, max_buffers=2), st.integers(0, 9999), st.integers(0, 25))
def test_a_shortened_plan_is_legal_and_no_longer_and_ends_alike(instance, seed, count):
    problem = Numbered.of(instance)
    steps = steps_drawn(problem, random.Random(seed), count)
    shorter = shorten(steps)
    assert cost_of(shorter) <= cost_of(steps)
    assert end_of(problem, shorter) == end_of(problem, steps)


def test_a_block_put_aside_for_nothing_goes_straight():
    assert shorten([(0, 0, 1), (0, 1, 2)]) == [(0, 0, 2)]


def test_a_block_that_comes_back_before_anything_happened_is_not_moved():
    assert shorten([(0, 0, 1), (0, 1, 0)]) == []


def test_a_block_goes_later_where_its_place_is_not_ready_before():
    # 1 lies in the way at location 2 and leaves it after 0 was put aside
    assert shorten([(0, 0, 1), (1, 2, 3), (0, 1, 2)]) == [(1, 2, 3), (0, 0, 2)]


def test_a_put_aside_that_is_needed_stays():
    # 1 lies under 0 and has to go first to where 0 goes
    steps = [(0, 0, 1), (1, 0, 2), (0, 1, 2)]
    assert shorten(steps) == steps


def test_a_block_that_falls_in_between_is_moved_twice():
    steps = [(0, 0, 1), (TOPPLE, 1, 1), (0, ON_TABLE, 2)]
    instance = make_instance(name="x", blocks="a", stacks=["p", "q", "r"], start={"p": "a"}, goal=PositionsGoal({}))
    assert end_of(Numbered.of(instance), shorten(steps)) == end_of(Numbered.of(instance), steps)
    assert shorten(steps) == steps


def test_a_block_that_came_back_has_earlier_transfers_still():
    steps = [(3, 1, 2), (1, 0, 2), (1, 2, 1), (0, 0, 2), (1, 1, 2)]
    steps += [(1, 2, 0), (0, 2, 1), (1, 0, 1), (1, 1, 0), (3, 2, 0)]
    assert shorten(steps) == [(1, 0, 1), (0, 0, 2), (1, 1, 0), (3, 1, 0), (0, 2, 1)]
