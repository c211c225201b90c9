"""The typed directed graph on which pebbles move (paper, section "Method")."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from smash.gadget.elements import Aggregate, Edge, EdgeKind, Node, NodeKey, NodeKind, PartReading, Token


@dataclass(frozen=True)
class Gadget:
    """A gadget for `locations` of `height` nodes each (the paper's S stacks and l objects). Build it by the library."""

    locations: tuple[str, ...]
    height: int
    nodes: tuple[Node, ...]
    edges: tuple[Edge, ...]
    aggregates: tuple[Aggregate, ...] = ()
    tokens: tuple[Token, ...] = ()
    parts: Mapping[str, PartReading] = field(default_factory=dict)

    @cached_property
    def _number(self) -> dict[NodeKey, int]:
        return {node.key: number for number, node in enumerate(self.nodes)}

    @cached_property
    def _between(self) -> dict[tuple[int, int], int]:
        return {
            (edge.tail, edge.head): number for number, edge in enumerate(self.edges) if number not in self.activations
        }

    @cached_property
    def _aggregate(self) -> dict[tuple[str, tuple[str, ...]], int]:
        return {(aggregate.part, aggregate.at): number for number, aggregate in enumerate(self.aggregates)}

    @cached_property
    def outgoing(self) -> tuple[tuple[int, ...], ...]:
        """Edge numbers that leave each node."""
        lists: list[list[int]] = [[] for _ in self.nodes]
        for number, edge in enumerate(self.edges):
            lists[edge.tail].append(number)
        return tuple(map(tuple, lists))

    @cached_property
    def incoming(self) -> tuple[tuple[int, ...], ...]:
        """Edge numbers that enter each node."""
        lists: list[list[int]] = [[] for _ in self.nodes]
        for number, edge in enumerate(self.edges):
            lists[edge.head].append(number)
        return tuple(map(tuple, lists))

    @cached_property
    def activations(self) -> dict[int, int]:
        """The aggregate's number of each activation edge number."""
        return {edge: number for number, aggregate in enumerate(self.aggregates) for edge in aggregate.edges}

    @cached_property
    def staging(self) -> tuple[int, ...]:
        """The numbers of the aggregates into whose gathering nodes pebbles are staged before."""
        return tuple(number for number, aggregate in enumerate(self.aggregates) if aggregate.locks is not None)

    def node(self, kind: NodeKind, location: str | None = None, index: int = 0) -> int:
        """Return the number of a node.

        Raises:
            KeyError: where the gadget has no such node.
        """
        return self._number[NodeKey(kind, location, index)]

    def stack_node(self, location: str, height: int) -> int:
        """Return the number of v_s^i, s = `location`, i = `height` (1 is the bottom)."""
        return self._number[NodeKey(NodeKind.STACK, location, height)]

    def top(self, location: str) -> int:
        """Return the number of v_s^l, the node through which `location` is entered and left."""
        return self.stack_node(location, self.height)

    def aggregate(self, part: str, at: tuple[str, ...]) -> int:
        """Return the number of an aggregate.

        Raises:
            KeyError: where the gadget has no such aggregate.
        """
        return self._aggregate[part, at]

    def edge(self, tail: int, head: int, active: int | None = None) -> int | None:
        """Return the number of the edge from `tail` to `head`, or None.

        Args:
            tail: node left.
            head: node entered.
            active: number of the aggregate that is active: its edges come first, those of others are none.
        """
        for number in () if active is None else self.aggregates[active].edges:
            if (self.edges[number].tail, self.edges[number].head) == (tail, head):
                return number
        return self._between.get((tail, head))

    def touched(self, edge: int) -> tuple[str, ...]:
        """Return the locations and carriers that a move along `edge` (no activation) enters by the top or leaves."""
        move = self.edges[edge]
        if move.kind is EdgeKind.CHAIN or edge in self.activations:
            return ()
        ends = (self.nodes[move.tail], self.nodes[move.head])
        return tuple(end.location for end in ends if end.kind.has_contents and end.location is not None)

    def counts(self) -> tuple[dict[NodeKind, int], dict[EdgeKind, int]]:
        """Return how many nodes and edges there are of each kind."""
        nodes = {kind: sum(node.kind is kind for node in self.nodes) for kind in NodeKind}
        edges = {kind: sum(edge.kind is kind for edge in self.edges) for kind in EdgeKind}
        return nodes, edges
