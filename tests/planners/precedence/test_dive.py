"""Dives: choices that hit every cycle, none of them superfluous, cheap where the hint is good."""

import itertools
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smash.planners.precedence.dive import EventOrder, dive
from smash.planners.precedence.graph import build_graph
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.planners.precedence.events import hits_all
from tests.strategies import instances, plan_options


@settings(max_examples=80, deadline=None)
@given(instances(max_blocks=5), plan_options())
def test_events_happen_in_some_order_exactly_where_every_cycle_is_hit(instance, options):
    graph = build_graph(Problem(instance, options))
    order = EventOrder(graph)
    for size in range(len(graph.choices) + 1):
        for chosen in itertools.combinations(range(len(graph.choices)), size):
            assert order.hits_all(chosen) == hits_all(graph, chosen)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 9999), plan_options())
def test_a_dive_hits_every_cycle_and_takes_nothing_superfluous(seed, options):
    draw = random.Random(seed)
    graph = build_graph(Problem(wide(draw.randint(3, 16), draw.randint(2, 5), seed, buffers=2), options))
    hint = None if draw.random() < 0.5 else np.array([draw.random() for _ in graph.choices])
    chosen = dive(graph, hint)
    assert hits_all(graph, chosen)
    assert not any(hits_all(graph, chosen - {choice}) for choice in chosen)


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=5), plan_options())
def test_a_dive_guided_by_a_cheapest_hitting_set_costs_no_more(instance, options):
    graph = build_graph(Problem(instance, options))
    sets = itertools.chain.from_iterable(
        itertools.combinations(range(len(graph.choices)), size) for size in range(len(graph.choices) + 1)
    )
    best = min((chosen for chosen in sets if hits_all(graph, chosen)), key=lambda c: graph.costs[list(c)].sum())
    hint = np.zeros(len(graph.choices))
    hint[list(best)] = 1.0
    assert graph.costs[list(dive(graph, hint))].sum() == graph.costs[list(best)].sum()


@pytest.mark.parametrize("topple", [True, False])
def test_past_the_deadline_the_choices_still_hit_every_cycle(topple):
    graph = build_graph(Problem(wide(40, 4, seed=1), PlanOptions(topple, 2 if topple else None)))
    assert hits_all(graph, dive(graph, deadline=-np.inf))


def test_an_order_of_events_can_be_begun_anew():
    graph = build_graph(Problem(wide(12, 3, seed=2), PlanOptions(topple=False)))
    order = EventOrder(graph)
    first = dive(graph, order=order)
    assert not order.hits_all(())
    assert dive(graph, order=order) == first
