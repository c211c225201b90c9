"""Cycles: what is found are cycles of the graph that the values do not hit, and none that is not hit is missed."""

import itertools
import random

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from smash.planners.precedence.cycles import CycleFinder
from smash.planners.precedence.graph import build_graph
from smash.problem import PlanOptions, StacksGoal, make_instance
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.planners.precedence.events import in_order, removed_before_placed
from tests.strategies import instances, plan_options

BELOW = 1.0 - 1e-3
"""A cycle is hit where its blocks are freed by 1 in all, rounding apart."""


def drawn_values(graph, draw, steps):
    return np.array([draw.randint(0, steps) / steps for _ in graph.choices])


def cycles_of(graph):
    """Return every set of blocks with a place in a start pile that cannot all move directly."""
    movable = [b for _, begin, end in graph.piles for b in range(begin, end) if graph.placed[b]]
    sets = itertools.chain.from_iterable(itertools.combinations(movable, size) for size in range(1, len(movable) + 1))
    return [blocks for blocks in sets if not in_order(graph, set(blocks))]


@settings(max_examples=80, deadline=None)
@given(instances(min_blocks=2, max_blocks=5), plan_options(), st.integers(0, 999))
def test_a_cycle_is_found_exactly_where_one_is_not_hit(instance, options, seed):
    graph = build_graph(Problem(instance, options))
    freedom = graph.freedom(drawn_values(graph, random.Random(seed), 4))
    least = min((freedom[list(blocks)].sum() for blocks in cycles_of(graph)), default=np.inf)
    assert bool(CycleFinder(graph).violated(freedom, BELOW)) == (least < BELOW)


@settings(max_examples=120, deadline=None)
@given(st.integers(0, 9999), plan_options(), st.booleans())
def test_the_blocks_of_a_cycle_cannot_all_move_directly_and_are_not_freed_enough(seed, options, buffered):
    draw = random.Random(seed)
    graph = build_graph(Problem(wide(draw.randint(4, 14), draw.randint(2, 5), seed, buffers=3 * buffered), options))
    freedom = graph.freedom(drawn_values(graph, draw, 5))
    cycles = CycleFinder(graph).violated(freedom, BELOW)
    assert len({frozenset(cycle) for cycle in cycles}) == len(cycles)
    for cycle in cycles:
        assert len(set(cycle)) == len(cycle)
        assert not in_order(graph, set(cycle))
        assert freedom[list(cycle)].sum() < BELOW
        for block, following in zip(cycle, (*cycle[1:], cycle[0]), strict=True):
            assert removed_before_placed(graph, block, following)
        piles = [next(p for p, (_, begin, end) in enumerate(graph.piles) if begin <= b < end) for b in cycle]
        assert piles.count(piles[-1]) == 1  # it was followed from a block of this pile, until it came back there


def test_two_swapped_blocks_wait_for_each_other():
    instance = make_instance(
        name="x",
        blocks="ab",
        stacks=["s1", "s2"],
        start={"s1": "a", "s2": "b"},
        goal=StacksGoal({"s1": ("b",), "s2": ("a",)}),
    )
    graph = build_graph(Problem(instance, PlanOptions()))
    (cycle,) = CycleFinder(graph).violated(np.zeros(2), BELOW)
    assert {graph.blocks[block] for block in cycle} == {"a", "b"}
    assert CycleFinder(graph).violated(np.array([0.5, 0.5]), BELOW) == []


def test_a_block_above_what_goes_under_it_waits_for_itself():
    instance = make_instance(
        name="x", blocks="ab", stacks=["s1", "s2"], start={"s1": "ab"}, goal=StacksGoal({"s2": ("a", "b")})
    )
    graph = build_graph(Problem(instance, PlanOptions(topple=False)))
    assert CycleFinder(graph).violated(np.zeros(2), BELOW) == [(graph.blocks.index("b"),)]


def test_a_tower_turned_over_has_no_cycle():
    instance = make_instance(
        name="x", blocks="abc", stacks=["s1", "s2"], start={"s1": "abc"}, goal=StacksGoal({"s2": ("c", "b", "a")})
    )
    graph = build_graph(Problem(instance, PlanOptions(topple=False)))
    assert CycleFinder(graph).violated(np.zeros(3), BELOW) == []


def test_past_the_deadline_no_further_sources_are_followed():
    graph = build_graph(Problem(wide(20, 3, seed=0), PlanOptions()))
    freedom = np.zeros(len(graph.blocks))
    assert CycleFinder(graph).violated(freedom, BELOW)
    assert CycleFinder(graph).violated(freedom, BELOW, deadline=-np.inf) == []
