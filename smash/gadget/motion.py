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

from smash.gadget.elements import EdgeKind, NodeKind
from smash.gadget.graph import Gadget
from smash.problem.errors import Unsupported
from smash.problem.model import State


class Move(NamedTuple):
    """Pebble number `pebble` takes edge number `edge`."""

    pebble: int
    edge: int


@dataclass(frozen=True, slots=True)
class PebbleMotion:
    """The pebbles' nodes over time (the flow solution Pi_MAPF of the paper's Algorithm 1).

    Pebbles are the blocks, in order, then the gadget's tokens.

    Attributes:
        gadget: the graph.
        blocks: the blocks, in order.
        layers: node numbers, layers[t][k] for pebble k at layer t; shape (steps + 1, pebbles).
        active: per step the number of the aggregate that is active, or None; steps beyond its end have none.
    """

    gadget: Gadget
    blocks: tuple[str, ...]
    layers: tuple[tuple[int, ...], ...]
    active: tuple[int | None, ...] = ()

    @property
    def steps(self) -> int:
        """Number of steps, one less than there are layers."""
        return len(self.layers) - 1

    def active_in(self, step: int) -> int | None:
        """Return the number of the aggregate that is active in a step, or None."""
        return self.active[step] if step < len(self.active) else None

    def moves(self, step: int) -> Iterator[Move]:
        """Yield the moves of step `step` (from layer `step` to the next).

        Raises:
            KeyError: where a pebble jumps between nodes that no edge joins (or that of an activation that is none).
        """
        active = self.active_in(step)
        for pebble, (tail, head) in enumerate(zip(self.layers[step], self.layers[step + 1], strict=True)):
            if tail != head:
                edge = self.gadget.edge(tail, head, active)
                if edge is None:
                    raise KeyError((tail, head))
                yield Move(pebble, edge)

    @property
    def cost(self) -> int:
        """Cost of all moves: an activation is paid once, every other edge per pebble."""
        gadget = self.gadget
        total = sum(gadget.aggregates[number].cost for number in self.active if number is not None)
        for step in range(self.steps):
            edges = (move.edge for move in self.moves(step))
            total += sum(gadget.edges[edge].cost for edge in edges if edge not in gadget.activations)
        return total

    def padded(self, steps: int) -> PebbleMotion:
        """Return the motion followed by waiting, so that it has at least `steps` steps."""
        layers = self.layers + (self.layers[-1],) * max(0, steps - self.steps)
        active = tuple(self.active_in(step) for step in range(len(layers) - 1))
        return PebbleMotion(self.gadget, self.blocks, layers, active)


def settled(gadget: Gadget, blocks: tuple[str, ...], state: State) -> tuple[int, ...]:
    """Return the node of each pebble in `state` (the paper's GetPebbleState): heights from 1, no holes.

    Raises:
        Unsupported: where a block is in the hand, for which the gadget has no node.
    """
    if state.hand is not None:
        raise Unsupported(f"the gadget has no node for {state.hand!r}, which is in the hand at the start")
    node = {block: gadget.node(NodeKind.TABLE) for block in state.table}
    for location, pile in state.piles.items():
        for height, block in enumerate(pile, start=1):
            node[block] = gadget.stack_node(location, height)
    tokens = tuple(token.nodes[state.stations[token.name]] for token in gadget.tokens)
    for token, at in zip(gadget.tokens, tokens, strict=True):
        node |= dict.fromkeys(state.carried[token.name], at)
    return tuple(node[block] for block in blocks) + tokens


def motion_fault(motion: PebbleMotion) -> str | None:
    """Return which rule the motion breaks, in words, or None where it obeys all of them.

    Per layer: node capacities; a token where a node needs one; one token at a station. Per step: edges exist; no two
    pebbles swap along a chain; a location or carrier is entered or left at most once, an activation that touches it
    included; a locked location is left alone while its gathering node holds pebbles. An activation moves something,
    at most its capacity; it empties its gathering node; the token of an activation moves, and no other; rungs are
    taken from the top one downward. At the end no pebble is in a transient node.
    """
    for layer in range(len(motion.layers)):
        fault = _layer_fault(motion, layer) or _token_fault(motion, layer)
        if fault:
            return f"layer {layer}: {fault}"
    for step in range(motion.steps):
        try:
            moves = list(motion.moves(step))
        except KeyError as error:
            return f"step {step}: no edge joins nodes {error.args[0]}"
        fault = (
            _edge_fault(motion, moves) or _location_fault(motion, moves, step) or _activation_fault(motion, moves, step)
        )
        if fault:
            return f"step {step}: {fault}"
    ends = (motion.gadget.nodes[number] for number in motion.layers[-1])
    return next((f"a pebble ends in {node.key}" for node in ends if node.kind.transient), None)


def _layer_fault(motion: PebbleMotion, layer: int) -> str | None:
    nodes = motion.gadget.nodes
    for number, pebbles in Counter(motion.layers[layer][: len(motion.blocks)]).items():
        if pebbles > nodes[number].capacity:
            return f"{pebbles} pebbles in {nodes[number].key}, capacity {nodes[number].capacity}"
    return None


def _token_fault(motion: PebbleMotion, layer: int) -> str | None:
    nodes, count = motion.gadget.nodes, len(motion.blocks)
    blocks, tokens = motion.layers[layer][:count], motion.layers[layer][count:]
    for number in blocks:
        token = nodes[number].token
        if token is not None and tokens[token] != number:
            return f"pebbles in {nodes[number].key} without its token"
    spots = [nodes[number].spot for number in tokens]
    return "two tokens at one station" if len(set(spots)) < len(spots) else None


def _edge_fault(motion: PebbleMotion, moves: list[Move]) -> str | None:
    gadget = motion.gadget
    used = {move.edge for move in moves if gadget.edges[move.edge].kind is EdgeKind.CHAIN}
    for number in used:
        if gadget.edge(gadget.edges[number].head, gadget.edges[number].tail) in used:
            return "two pebbles swap along a chain"
    return None


def _location_fault(motion: PebbleMotion, moves: list[Move], step: int) -> str | None:
    gadget, active = motion.gadget, motion.active_in(step)
    touched = Counter(() if active is None else gadget.aggregates[active].touches)
    held = set(motion.layers[step]) | set(motion.layers[step + 1])
    locks = {aggregate.locks: aggregate.gather for aggregate in gadget.aggregates if aggregate.gather in held}
    locked = locks.keys() & touched.keys()
    for move in moves:
        for location in gadget.touched(move.edge):
            touched[location] += 1
            if location in locks and gadget.edges[move.edge].head != locks[location]:
                locked = {location}
    for location, times in touched.items():
        if times > 1:
            return f"{location!r} is entered or left {times} times"
    return f"{sorted(map(str, locked))} change while blocks of them are staged" if locked else None


def _activation_fault(motion: PebbleMotion, moves: list[Move], step: int) -> str | None:
    gadget, active = motion.gadget, motion.active_in(step)
    taken = Counter(move.edge for move in moves if move.edge in gadget.activations)
    tokens = {move for move in moves if move.pebble >= len(motion.blocks)}
    if any(move.edge not in gadget.activations for move in tokens):
        return "a token moves without an activation"
    if active is None:
        return None
    aggregate = gadget.aggregates[active]
    if not taken:
        return "an activation moves nothing"
    if {move.pebble - len(motion.blocks) for move in tokens} != ({aggregate.token} - {None}):
        return "an activation moves another token than its own"
    if taken.total() - len(tokens) > aggregate.capacity:
        return f"an activation moves {taken.total() - len(tokens)} pebbles, its capacity is {aggregate.capacity}"
    if aggregate.gather in motion.layers[step + 1][: len(motion.blocks)]:
        return "an activation leaves pebbles in its gathering node"
    if set(aggregate.edges[: len(taken)]) != set(taken):
        return "a rung is taken without the ones above it"
    return None
