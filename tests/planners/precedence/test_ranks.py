"""Rank inequalities: every choice that hits all cycles fulfils them, and the values that they are for do not."""

import itertools

import numpy as np
import pytest

from smash.planners.precedence.compiled import INTERPRETED
from smash.planners.precedence.cycles import CycleFinder
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.ranks import RankFinder
from smash.planners.precedence.turns import turn_graph
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.planners.precedence.test_turns import acyclic

NO_TOPPLE = PlanOptions(topple=False)


def relaxed(graph, draw):
    """Return values that hit every short cycle, most by hardly more than they must, and the rows of those."""
    finder, values = CycleFinder(graph), draw.uniform(0.0, 0.4, len(graph.choices))
    rows = set()
    while cycles := finder.violated(graph.freedom(values), 1.0 - 1e-3):
        for cycle in cycles:
            row = sorted(graph.row(cycle))
            rows.add(frozenset(row))
            values[row] += max(0.0, 1.0 - values[row].sum()) / len(row)
    return np.minimum(values, 1.0), rows


@pytest.mark.parametrize("seed", range(6))
def test_they_hold_for_all_choices_that_hit_every_cycle_and_not_for_the_values(seed):
    graph = build_graph(Problem(wide(16, 4, seed), NO_TOPPLE))
    turns = turn_graph(graph)
    values, rows = relaxed(graph, np.random.default_rng(seed))
    for row, needed in RankFinder(turns, INTERPRETED).violated(values, rows, 7, 0.5):
        assert values[sorted(row)].sum() < needed
        kept = max(
            len(some)
            for size in range(len(row) + 1)
            for some in itertools.combinations(row, size)
            if acyclic(turns.edges, some)
        )
        assert needed == len(row) - kept


def test_of_three_blocks_that_wait_for_each_other_in_pairs_two_must_go():
    edges = np.array([[0, 1, 1], [1, 0, 1], [1, 1, 0]], dtype=np.int8)
    graph = build_graph(Problem(wide(12, 3, seed=0), NO_TOPPLE))
    turns = turn_graph(graph)
    three = type(turns)(edges, frozenset(), np.arange(3))
    pairs = [frozenset(pair) for pair in itertools.combinations(range(3), 2)]
    assert RankFinder(three, INTERPRETED).violated(np.full(3, 0.5), pairs, 5, 0.0) == [(frozenset({0, 1, 2}), 2)]
    assert RankFinder(three, INTERPRETED).violated(np.full(3, 2 / 3), pairs, 5, 0.0) == []


def test_past_the_deadline_no_further_sets_are_grown():
    graph = build_graph(Problem(wide(16, 4, seed=1), NO_TOPPLE))
    values, rows = relaxed(graph, np.random.default_rng(1))
    assert RankFinder(turn_graph(graph), INTERPRETED).violated(values, rows, 7, 0.5, deadline=-np.inf) == []


def test_compiled_and_interpreted_they_are_the_same(kernels):
    graph = build_graph(Problem(wide(16, 4, seed=3), NO_TOPPLE))
    values, rows = relaxed(graph, np.random.default_rng(3))
    found = [RankFinder(turn_graph(graph), code).violated(values, rows, 7, 0.5) for code in (INTERPRETED, kernels)]
    assert found[0] == found[1]
