"""The node store: it grows without losing a node, and its hash table stays at most half full."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smash.planners.astar.compiled import INTERPRETED
from smash.planners.astar.engine import StoreEngine
from smash.planners.astar.search import BEST, DROPPED, FLOOR, NODES, UPPER, file_node
from smash.planners.astar.store import NODE_BYTES, grown, make_store, most_nodes, table_size
from smash.planners.astar.task import make_setting
from smash.problem import PlanOptions
from smash.problem.sets.generators import generate
from smash.problem.views.numbered import Numbered

PER_NODE = ("cost", "estimate", "parent", "moved", "code", "following", "stale")
"""What is known of a node beside its state."""


@pytest.fixture
def engine():
    """A search with some nodes in its store."""
    problem = Numbered.of(generate("multi", 7, buffers=0)[0])
    engine = StoreEngine(make_setting(problem, PlanOptions(topple=False)), INTERPRETED, False)
    engine.open(400, engine.first_bound(), 60)
    engine.share = 40
    engine.expand()
    return engine


def entries(engine, store):
    """Return all that is known of each node."""
    blocks = engine.task.blocks
    return [
        (list(store.states[node * blocks : (node + 1) * blocks]), *(getattr(store, name)[node] for name in PER_NODE))
        for node in range(store.counters[NODES])
    ]


def test_growing_keeps_every_node_and_every_counter(engine):
    old = engine.store
    new = grown(engine.task, old, 1000, INTERPRETED, False)
    assert old.counters[NODES] > 10
    assert entries(engine, new) == entries(engine, old)
    assert list(new.counters) == list(old.counters)
    assert list(new.heads) == list(old.heads)
    assert new.shape[2] == 1000
    assert {len(getattr(new, name)) for name in PER_NODE} == {1000}


def test_after_growing_every_state_is_known(engine):
    store = grown(engine.task, engine.store, 1000, INTERPRETED, False)
    count = store.counters[NODES]
    for node in range(count):
        if store.stale[node]:
            continue
        INTERPRETED.unpack(engine.task, engine.cells, store.states, node * engine.task.blocks)
        again = file_node(engine.task, engine.cells, store, -1, store.cost[node], -1, 0, 0)
        assert again == DROPPED
    assert store.counters[NODES] == count


def test_a_new_store_is_empty_and_open_from_the_bound_up_to_the_plan_known(engine):
    store = make_store(engine.task, False, 20, first=7, upper=30)
    assert [store.counters[which] for which in (NODES, FLOOR, UPPER, BEST)] == [0, 7, 30, -1]
    assert set(store.table) == {0}
    assert set(store.heads) == {-1}


@given(st.integers(1, 1 << 20))
def test_a_hash_table_is_a_power_of_two_and_at_most_half_full(nodes):
    size = table_size(nodes)
    assert size & (size - 1) == 0
    assert 2 * nodes <= size <= max(16, 4 * nodes)


@given(st.integers(1, 250), st.integers(0, 1 << 34))
def test_the_nodes_that_fit_take_no_more_than_the_memory(blocks, memory):
    nodes = most_nodes(blocks, memory)
    assert nodes == 1 or nodes * (blocks + NODE_BYTES) <= memory
