"""The turn graph: its acyclic sets are the sets of blocks that can move directly."""

import itertools

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.turns import turn_graph
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.planners.precedence.events import hits_all
from tests.strategies import instances


def acyclic(edges, kept):
    """Return whether the vertices `kept` have no cycle: whoever leads to none of those left is taken away."""
    left = set(kept)
    while left:
        ends = {v for v in left if not any(edges[v, w] for w in left)}
        if not ends:
            return False
        left -= ends
    return True


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=5), st.sampled_from([PlanOptions(topple=False), PlanOptions(max_topple=1)]))
def test_choices_hit_every_cycle_exactly_where_the_others_have_none(instance, options):
    graph = build_graph(Problem(instance, options))
    turns = turn_graph(graph)
    if turns is None:  # a block on a buffer cannot be toppled: costs differ
        assert options.topple
        return
    every = range(len(graph.choices))
    assert sorted([*turns.forced, *turns.free.tolist()]) == list(every)
    for size in range(len(graph.choices) + 1):
        for chosen in itertools.combinations(every, size):
            hits = turns.forced.issubset(chosen) and acyclic(turns.edges, set(every) - set(chosen))
            assert hits == hits_all(graph, chosen)


def test_there_is_none_where_one_topple_frees_several_blocks():
    graph = build_graph(Problem(wide(12, 3, seed=0), PlanOptions()))
    assert turn_graph(graph) is None


def test_neighbours_are_listed_from_both_sides():
    turns = turn_graph(build_graph(Problem(wide(12, 3, seed=0), PlanOptions(topple=False))))
    vertices = turns.vertices()
    inner = turns.edges[np.ix_(turns.free, turns.free)]
    for vertex in range(len(turns.free)):
        leads = vertices.to[vertices.to_first[vertex] : vertices.to_first[vertex + 1]]
        comes = vertices.of[vertices.of_first[vertex] : vertices.of_first[vertex + 1]]
        assert set(leads.tolist()) == set(np.flatnonzero(inner[vertex]).tolist())
        assert set(comes.tolist()) == set(np.flatnonzero(inner[:, vertex]).tolist())
