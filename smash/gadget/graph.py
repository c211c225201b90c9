"""The typed directed graph on which pebbles move (paper, section "Method").

A gadget is made of nodes with a kind and a capacity, edges with a kind, a cost and a capacity, and
*aggregates*: the places where one action moves several pebbles at once (topple; any further aggregating
action is another part over the same three notions).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from smash.gadget.parts import AggregatingPart


class NodeKind(StrEnum):
    """What a node stands for, with the paper's symbol."""

    STACK = "stack"
    """v_s^i: height i of location s."""
    TOPPLE = "topple"
    """v_{T_s}: the TOPPLE staging node of stack s."""
    TABLE = "table"
    """v_T: the TABLE node, the paper's region T_a."""
    INTERFACE = "interface"
    """v_T^i: a unit node through which one block is picked from the table region."""


class EdgeKind(StrEnum):
    """What a move along an edge means."""

    CHAIN = "chain"
    """(v_s^i, v_s^{i±1}): a shift within a stack; no action."""
    TRANSFER = "transfer"
    """(v_u^l, v_w^l): pick from the top of one location, place on the top of another."""
    STAGE = "stage"
    """(v_s^l, v_{T_s}): select a block for the next topple of s; no action."""
    TOPPLE = "topple"
    """(v_{T_s}, v_T): the topple, one action for all the pebbles that take it in one step."""
    EXPOSE = "expose"
    """(v_T, v_T^i): make a toppled block ready to be picked; no action."""
    RETURN = "return"
    """(v_T^i, v_s^l): pick from the table region, place on the top of a location."""


@dataclass(frozen=True, slots=True)
class NodeKey:
    """A node's name: its kind, its location (None where it has none) and its index (height, or i of v_T^i)."""

    kind: NodeKind
    location: str | None = None
    index: int = 0


@dataclass(frozen=True, slots=True)
class Node:
    """A node and its capacity, in pebbles."""

    key: NodeKey
    capacity: int

    @property
    def kind(self) -> NodeKind:
        """What the node stands for."""
        return self.key.kind

    @property
    def location(self) -> str | None:
        """The location that the node belongs to, if any."""
        return self.key.location


@dataclass(frozen=True, slots=True)
class Edge:
    """A directed edge between node numbers `tail` and `head`.

    `cost` is in actions. It is paid per pebble, but for the activation edge of an `Aggregate`, where it is
    paid once for all the pebbles that take it in one step. `capacity` is in pebbles per step.
    """

    tail: int
    head: int
    kind: EdgeKind
    cost: int
    capacity: int


@dataclass(frozen=True, slots=True)
class Aggregate:
    """One place of an aggregating action: a node that gathers pebbles, and the edge that moves them at once.

    Attributes:
        part: name of the part that added it (`topple`).
        gather: number of the gathering node (v_{T_s}).
        edge: number of the activation edge (v_{T_s}, v_T); an activation empties the gathering node.
        capacity: most pebbles of one activation.
        locks: the location that nothing else may enter or leave while the gathering node holds pebbles, or None.
        grounded: whether the poses after the action are known to the planner (paper, "Partial grounding").
    """

    part: str
    gather: int
    edge: int
    capacity: int
    locks: str | None
    grounded: bool


@dataclass(frozen=True)
class Gadget:
    """A gadget for `locations` of `height` nodes each (the paper's S stacks and l objects). Build it by the library."""

    locations: tuple[str, ...]
    height: int
    nodes: tuple[Node, ...]
    edges: tuple[Edge, ...]
    aggregates: tuple[Aggregate, ...] = ()
    parts: Mapping[str, AggregatingPart] = field(default_factory=dict)

    @cached_property
    def _number(self) -> dict[NodeKey, int]:
        return {node.key: number for number, node in enumerate(self.nodes)}

    @cached_property
    def _between(self) -> dict[tuple[int, int], int]:
        return {(edge.tail, edge.head): number for number, edge in enumerate(self.edges)}

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
    def activations(self) -> dict[int, Aggregate]:
        """The aggregate of each activation edge number."""
        return {aggregate.edge: aggregate for aggregate in self.aggregates}

    def has(self, key: NodeKey) -> bool:
        """Return whether there is such a node."""
        return key in self._number

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

    def edge(self, tail: int, head: int) -> int | None:
        """Return the number of the edge from `tail` to `head`, or None."""
        return self._between.get((tail, head))

    def touched(self, edge: int) -> tuple[str, ...]:
        """Return the locations whose pile a move along `edge` changes: those that it leaves or enters by the top."""
        move = self.edges[edge]
        if move.kind is EdgeKind.CHAIN:
            return ()
        ends = (self.nodes[move.tail], self.nodes[move.head])
        return tuple(end.location for end in ends if end.kind is NodeKind.STACK and end.location is not None)

    def counts(self) -> tuple[dict[NodeKind, int], dict[EdgeKind, int]]:
        """Return how many nodes and edges there are of each kind."""
        nodes = {kind: sum(node.kind is kind for node in self.nodes) for kind in NodeKind}
        edges = {kind: sum(edge.kind is kind for edge in self.edges) for kind in EdgeKind}
        return nodes, edges


class GadgetBuilder:
    """Collects nodes, edges and aggregates; parts extend it, `build` closes it."""

    def __init__(self, locations: Iterable[str], height: int) -> None:
        self.locations = tuple(locations)
        self.height = height
        self._nodes: dict[NodeKey, Node] = {}
        self._numbers: dict[NodeKey, int] = {}
        self._edges: list[Edge] = []
        self._aggregates: list[Aggregate] = []
        self._parts: dict[str, AggregatingPart] = {}

    def add_node(self, kind: NodeKind, capacity: int, location: str | None = None, index: int = 0) -> int:
        """Add a node and return its number."""
        key = NodeKey(kind, location, index)
        number = self._numbers[key] = len(self._numbers)
        self._nodes[key] = Node(key, capacity)
        return number

    def add_edge(self, tail: int, head: int, kind: EdgeKind, cost: int, capacity: int) -> int:
        """Add an edge between two node numbers and return its number."""
        self._edges.append(Edge(tail, head, kind, cost, capacity))
        return len(self._edges) - 1

    def add_aggregate(self, aggregate: Aggregate) -> None:
        """Add one place of an aggregating action."""
        self._aggregates.append(aggregate)

    def add_part(self, part: AggregatingPart) -> None:
        """Let an aggregating action add its nodes, edges and aggregates."""
        part.extend(self)
        self._parts[part.name] = part

    def top(self, location: str) -> int:
        """Return the number of v_s^l of `location`."""
        return self._numbers[NodeKey(NodeKind.STACK, location, self.height)]

    def build(self) -> Gadget:
        """Return the finished gadget."""
        return Gadget(
            locations=self.locations,
            height=self.height,
            nodes=tuple(self._nodes.values()),
            edges=tuple(self._edges),
            aggregates=tuple(self._aggregates),
            parts=dict(self._parts),
        )
