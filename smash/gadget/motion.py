"""Pebble motions on a gadget, and the rules that make one a plan.

A motion says at which node each pebble is at each *layer* of time; between two layers lies a *step*, in which
every pebble waits or takes one edge. The paper asks for capacities and one active TOPPLE node; that is not
enough to read actions off a motion at their cost, so the rules below are DESIGN's "what one step may hold".
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from smash.gadget.graph import Gadget, NodeKind
from smash.problem.model import State


class Move(NamedTuple):
    """Pebble number `pebble` takes edge number `edge`."""

    pebble: int
    edge: int


@dataclass(frozen=True, slots=True)
class PebbleMotion:
    """The pebbles' nodes over time (the flow solution Pi_MAPF of the paper's Algorithm 1).

    Attributes:
        gadget: the graph.
        blocks: the pebbles, in order.
        layers: node numbers, layers[t][k] for pebble k at layer t; shape (steps + 1, pebbles).
    """

    gadget: Gadget
    blocks: tuple[str, ...]
    layers: tuple[tuple[int, ...], ...]

    @property
    def steps(self) -> int:
        """Number of steps, one less than there are layers."""
        return len(self.layers) - 1

    def moves(self, step: int) -> Iterator[Move]:
        """Yield the moves of step `step` (from layer `step` to the next).

        Raises:
            KeyError: where a pebble jumps between nodes that no edge joins.
        """
        for pebble, (tail, head) in enumerate(zip(self.layers[step], self.layers[step + 1], strict=True)):
            if tail != head:
                edge = self.gadget.edge(tail, head)
                if edge is None:
                    raise KeyError((tail, head))
                yield Move(pebble, edge)

    @property
    def cost(self) -> int:
        """Cost of all moves: an activation is paid once a step, every other edge per pebble."""
        total = 0
        for step in range(self.steps):
            edges = [move.edge for move in self.moves(step)]
            paid = [edge for edge in edges if edge not in self.gadget.activations]
            paid += set(edges) & self.gadget.activations.keys()
            total += sum(self.gadget.edges[edge].cost for edge in paid)
        return total

    def padded(self, steps: int) -> PebbleMotion:
        """Return the motion followed by waiting, so that it has at least `steps` steps."""
        return PebbleMotion(self.gadget, self.blocks, self.layers + (self.layers[-1],) * max(0, steps - self.steps))


def settled(gadget: Gadget, blocks: tuple[str, ...], state: State) -> tuple[int, ...]:
    """Return the node of each block in `state` (the paper's GetPebbleState): heights from 1, no holes."""
    node = {block: gadget.node(NodeKind.TABLE) for block in state.table}
    for location, pile in state.piles.items():
        for height, block in enumerate(pile, start=1):
            node[block] = gadget.stack_node(location, height)
    return tuple(node[block] for block in blocks)


def motion_fault(motion: PebbleMotion) -> str | None:
    """Return which rule the motion breaks, in words, or None where it obeys all of them.

    Per layer: node capacities. Per step: edges exist and keep their capacities; no two pebbles swap along a
    chain; a location is entered or left by its top at most once; at most one activation, which empties its
    gathering node; a locked location is left alone while its gathering node holds pebbles. At the end no pebble
    is in a gathering or interface node.
    """
    for layer in range(len(motion.layers)):
        fault = _layer_fault(motion, layer)
        if fault:
            return f"layer {layer}: {fault}"
    for step in range(motion.steps):
        try:
            moves = list(motion.moves(step))
        except KeyError as error:
            return f"step {step}: no edge joins nodes {error.args[0]}"
        fault = _edge_fault(motion, moves) or _location_fault(motion, moves, step) or _activation_fault(motion, step)
        if fault:
            return f"step {step}: {fault}"
    return None


def _layer_fault(motion: PebbleMotion, layer: int) -> str | None:
    nodes = motion.gadget.nodes
    for number, pebbles in Counter(motion.layers[layer]).items():
        if pebbles > nodes[number].capacity:
            return f"{pebbles} pebbles in {nodes[number].key}, capacity {nodes[number].capacity}"
        if layer == motion.steps and nodes[number].kind in (NodeKind.TOPPLE, NodeKind.INTERFACE):
            return f"a pebble ends in {nodes[number].key}"
    return None


def _edge_fault(motion: PebbleMotion, moves: list[Move]) -> str | None:
    gadget = motion.gadget
    used = Counter(move.edge for move in moves)
    for number, pebbles in used.items():
        edge = gadget.edges[number]
        if pebbles > edge.capacity:
            return f"{pebbles} pebbles take a {edge.kind} edge of capacity {edge.capacity}"
        if gadget.edge(edge.head, edge.tail) in used:
            return f"two pebbles swap along a {edge.kind} edge"
    return None


def _location_fault(motion: PebbleMotion, moves: list[Move], step: int) -> str | None:
    gadget = motion.gadget
    touched = Counter(location for move in moves for location in gadget.touched(move.edge))
    for location, times in touched.items():
        if times > 1:
            return f"location {location!r} is entered or left {times} times"
    held = set(motion.layers[step]) | set(motion.layers[step + 1])
    locked = {aggregate.locks for aggregate in gadget.aggregates if aggregate.gather in held}
    for move in moves:
        into_gathering = gadget.nodes[gadget.edges[move.edge].head].kind is NodeKind.TOPPLE
        if not into_gathering and locked.intersection(gadget.touched(move.edge)):
            return f"location {gadget.touched(move.edge)} changes while blocks of it are staged"
    return None


def _activation_fault(motion: PebbleMotion, step: int) -> str | None:
    active = {move.edge for move in motion.moves(step)} & motion.gadget.activations.keys()
    if len(active) > 1:
        return f"{len(active)} activations"
    for edge in active:
        if motion.gadget.activations[edge].gather in motion.layers[step + 1]:
            return "an activation leaves pebbles in its gathering node"
    return None
