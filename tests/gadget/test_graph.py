"""The gadgets: counts against the paper's printed definitions, and what is corrected."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smash.gadget import EdgeKind, NodeKind, gadget_of, pick_and_place_gadget, smash_gadget
from smash.problem import Carrier, Costs, PlanOptions, StacksGoal, make_instance

SIZES = given(stacks=st.integers(1, 7), blocks=st.integers(1, 9))


def names(count):
    return [f"s{number}" for number in range(1, count + 1)]


@SIZES
def test_the_literal_pick_and_place_gadget_has_the_printed_counts(stacks, blocks):
    gadget = pick_and_place_gadget(names(stacks), blocks, literal=True)
    assert len(gadget.nodes) == stacks * blocks
    assert len(gadget.edges) == stacks * (blocks - 1) + stacks * (stacks - 1)
    assert {edge.cost for edge in gadget.edges if edge.kind is EdgeKind.TRANSFER} <= {1}


@SIZES
def test_the_literal_smash_gadget_has_the_printed_counts(stacks, blocks):
    base = pick_and_place_gadget(names(stacks), blocks, literal=True)
    gadget = smash_gadget(names(stacks), blocks, literal=True)
    assert len(gadget.nodes) - len(base.nodes) == stacks + 1 + blocks
    assert len(gadget.edges) - len(base.edges) == stacks + stacks + blocks + blocks * stacks


@SIZES
def test_the_built_gadget_has_chains_both_ways_and_topple_nodes_for_stacks_alone(stacks, blocks):
    buffers = ["u1", "u2"]
    locations = stacks + len(buffers)
    gadget = smash_gadget(names(stacks) + buffers, blocks, stacks=names(stacks))
    nodes, edges = gadget.counts()
    assert nodes == {
        NodeKind.STACK: locations * blocks,
        NodeKind.TOPPLE: stacks,
        NodeKind.TABLE: 1,
        NodeKind.INTERFACE: blocks,
        NodeKind.CARRIER: 0,
    }
    assert edges == {
        EdgeKind.CHAIN: 2 * locations * (blocks - 1),
        EdgeKind.TRANSFER: locations * (locations - 1),
        EdgeKind.STAGE: stacks,
        EdgeKind.TOPPLE: stacks,
        EdgeKind.EXPOSE: blocks,
        EdgeKind.RETURN: blocks * locations,
        EdgeKind.CARRY: 0,
        EdgeKind.LIFT: 0,
    }


def test_costs_count_actions():
    gadget = smash_gadget(names(3), 4)
    kinds = {edge.kind for edge in gadget.edges}
    costs = {kind: {edge.cost for edge in gadget.edges if edge.kind is kind} for kind in kinds}
    assert costs == {
        EdgeKind.CHAIN: {0},
        EdgeKind.TRANSFER: {2},
        EdgeKind.STAGE: {0},
        EdgeKind.TOPPLE: {1},
        EdgeKind.EXPOSE: {0},
        EdgeKind.RETURN: {2},
    }


def test_capacities_are_those_of_the_definition():
    gadget = smash_gadget(names(3), 4)
    kinds = {node.kind for node in gadget.nodes}
    capacities = {kind: {node.capacity for node in gadget.nodes if node.kind is kind} for kind in kinds}
    assert capacities == {NodeKind.STACK: {1}, NodeKind.TOPPLE: {4}, NodeKind.TABLE: {4}, NodeKind.INTERFACE: {1}}
    topple = {edge.capacity for edge in gadget.edges if edge.kind is EdgeKind.TOPPLE}
    assert topple == {4}
    assert {edge.capacity for edge in gadget.edges if edge.kind is not EdgeKind.TOPPLE} == {1}


def test_a_cap_is_the_capacity_of_the_topple():
    gadget = smash_gadget(names(2), 5, max_topple=2)
    assert {aggregate.capacity for aggregate in gadget.aggregates} == {2}
    assert {gadget.nodes[aggregate.gather].capacity for aggregate in gadget.aggregates} == {2}


def test_each_topple_is_an_ungrounded_aggregate_that_locks_its_stack():
    gadget = smash_gadget(["s1", "s2", "u1"], 3, stacks=["s1", "s2"])
    assert [aggregate.locks for aggregate in gadget.aggregates] == ["s1", "s2"]
    assert not any(aggregate.grounded for aggregate in gadget.aggregates)


@pytest.mark.parametrize("blocks", [[], ["a"], ["a", "b"]])
@pytest.mark.parametrize("topple", [True, False])
def test_every_instance_has_a_gadget(blocks, topple):
    instance = make_instance(
        name="x", blocks=blocks, stacks=["s 1"], buffers=["a"], start={"s 1": blocks}, goal=StacksGoal({"s 1": blocks})
    )
    gadget = gadget_of(instance, PlanOptions(topple=topple))
    assert len(gadget.outgoing) == len(gadget.incoming) == len(gadget.nodes)
    assert any(node.kind is NodeKind.TABLE for node in gadget.nodes) is topple


def test_without_topple_blocks_on_the_table_keep_their_region():
    instance = make_instance(
        name="x", blocks=["a"], stacks=["s1"], start={}, table=["a"], goal=StacksGoal({"s1": ["a"]})
    )
    nodes, edges = gadget_of(instance, PlanOptions(topple=False)).counts()
    assert (nodes[NodeKind.TABLE], nodes[NodeKind.TOPPLE], edges[EdgeKind.RETURN]) == (1, 0, 1)


@pytest.fixture
def combined():
    """Return an instance with a tray for two, lifts of two, and costs."""
    return make_instance(
        name="x",
        blocks=["a", "b", "c"],
        stacks=["s1", "s2"],
        start={"s1": ["a", "b", "c"]},
        goal=StacksGoal({"s1": ["a", "b", "c"]}),
        carriers=[Carrier("tray", ("left", "right"), "left", 2)],
        capacities={"lift": 2},
        costs=Costs({"pick": 3, "place": 4, "topple": 5, "carry": 6, "lift": 8}),
    )


def test_each_action_is_a_part_whose_costs_are_the_instances(combined):
    gadget = gadget_of(combined)
    assert list(gadget.parts) == ["topple", "carry", "lift"]
    assert {(aggregate.part, aggregate.cost) for aggregate in gadget.aggregates} == {
        ("topple", 5),
        ("carry", 6),
        ("lift", 8),
    }
    assert {edge.cost for edge in gadget.edges if edge.kind.picks} == {7}


def test_aggregates_gather_in_three_ways(combined):
    gadget = gadget_of(combined)
    ways = {
        aggregate.part: (aggregate.locks is not None, aggregate.token is not None, len(aggregate.edges))
        for aggregate in gadget.aggregates
    }
    assert ways == {"topple": (True, False, 1), "carry": (False, True, 1), "lift": (False, False, 2)}


def test_what_is_not_allowed_is_no_part_of_the_gadget(combined):
    gadget = gadget_of(combined, PlanOptions(topple=False, without=("carry", "lift")))
    assert (gadget.aggregates, gadget.tokens, dict(gadget.parts)) == ((), (), {})


def test_travel_is_part_of_the_cost_of_every_way(combined):
    places = {"s1": (0, 0), "s2": (3, 4), "table": (0, 1), "left": (0, 2), "right": (0, 4)}
    gadget = gadget_of(replace(combined, costs=Costs(travel=10.0, positions=places)))
    assert gadget.edges[gadget.edge(gadget.top("s1"), gadget.top("s2"))].cost == 2 + 50
    assert gadget.edges[gadget.edge(gadget.top("s1"), gadget.tokens[0].nodes["right"])].cost == 2 + 40
    assert gadget.aggregates[gadget.aggregate("carry", ("tray", "left", "right"))].cost == 1 + 20
    assert gadget.aggregates[gadget.aggregate("lift", ("s1", "s2"))].cost == 1 + 50
    assert gadget.aggregates[gadget.aggregate("topple", ("s1",))].cost == 1
