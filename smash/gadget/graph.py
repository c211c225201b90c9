"""The typed directed graph on which pebbles move (paper, section "Method").

A gadget is made of nodes with a kind and a capacity, edges with a kind, a cost and a capacity, *tokens* (things that
move themselves, and without which some nodes are not there) and *aggregates*: the places where one action moves
several pebbles at once. An aggregating action is a part over these four notions.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING

from smash.problem.costs import UNIT_COSTS, Costs

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
    CARRIER = "carrier"
    """(C, p): what lies on carrier C while it stands at station p."""

    @property
    def transient(self) -> bool:
        """Whether no pebble may be there at the end: what it stands for is the middle of an action."""
        return self in (NodeKind.TOPPLE, NodeKind.INTERFACE)

    @property
    def has_contents(self) -> bool:
        """Whether it is part of something that blocks are placed on: a pile or a carrier."""
        return self in (NodeKind.STACK, NodeKind.CARRIER)


class EdgeKind(StrEnum):
    """What a move along an edge means."""

    CHAIN = "chain"
    """(v_s^i, v_s^{i±1}): a shift within a stack; no action."""
    TRANSFER = "transfer"
    """(v_u^l, v_w^l): pick from the top of one location, place on the top of another; or from or on a carrier."""
    STAGE = "stage"
    """(v_s^l, v_{T_s}): select a block for the next topple of s; no action."""
    TOPPLE = "topple"
    """(v_{T_s}, v_T): the topple, one action for all the pebbles that take it in one step."""
    EXPOSE = "expose"
    """(v_T, v_T^i): make a toppled block ready to be picked; no action."""
    RETURN = "return"
    """(v_T^i, v_s^l): pick from the table region, place on the top of a location, or on a carrier."""
    CARRY = "carry"
    """((C, p), (C, q)): the carry, one action for the carrier and all the pebbles on it."""
    LIFT = "lift"
    """(v_u^i, v_w^i): a rung of the lift from u to w, one action for all the pebbles that take a rung in one step."""

    @property
    def picks(self) -> bool:
        """Whether a move is a pick and a place."""
        return self in (EdgeKind.TRANSFER, EdgeKind.RETURN)


@dataclass(frozen=True, slots=True)
class NodeKey:
    """A node's name: its kind, its location or carrier (None: neither), its index (height, i of v_T^i, station)."""

    kind: NodeKind
    location: str | None = None
    index: int = 0


@dataclass(frozen=True, slots=True)
class Node:
    """A node.

    Attributes:
        key: its name.
        capacity: most pebbles in it, tokens apart.
        spot: the point in space that it stands for, None where it stands for none.
        token: number of the token that has to be there while pebbles are, None where it needs none.
    """

    key: NodeKey
    capacity: int
    spot: str | None = None
    token: int | None = None

    @property
    def kind(self) -> NodeKind:
        """What the node stands for."""
        return self.key.kind

    @property
    def location(self) -> str | None:
        """The location or the carrier that the node belongs to, if any."""
        return self.key.location


@dataclass(frozen=True, slots=True)
class Edge:
    """A directed edge between node numbers `tail` and `head`.

    `cost` is in the instance's unit (actions). It is paid per pebble, but for the edges of an `Aggregate`, where it
    is paid once for all the pebbles that take them in one step. `capacity` is in pebbles per step.
    """

    tail: int
    head: int
    kind: EdgeKind
    cost: int
    capacity: int


@dataclass(frozen=True, slots=True)
class Token:
    """A thing that stands at one of its nodes and moves by activations alone (a carrier).

    Attributes:
        name: the carrier's name.
        nodes: its node at each station; two tokens never stand at the same one.
    """

    name: str
    nodes: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class Aggregate:
    """One place of an aggregating action: what one activation moves at once, and what holds meanwhile.

    Pebbles are gathered in one of three ways. With `locks`, they are staged in the gathering node before (v_{T_s});
    with `token`, they are those in the gathering node when the token leaves it, none included; with neither, they are
    the top of a pile, in place: `edges` are then rungs from the top node downward, and a rung is taken only together
    with the ones above it, so that order and coherence are kept.

    Attributes:
        part: name of the part that added it (`topple`).
        at: the names that tell it from the part's other aggregates (the stack; carrier and stations; two locations).
        edges: numbers of the activation edges; an activation leaves no pebble behind in the gathering node.
        cost: cost of one activation.
        capacity: most pebbles of one activation.
        grounded: whether the poses after the action are known to the planner (paper, "Partial grounding").
        gather: number of the gathering node (v_{T_s}), None: pebbles are gathered in place.
        locks: the location that nothing else may enter or leave while the gathering node holds pebbles, or None.
        token: number of the token that an activation moves, or None.
        touches: the locations and carriers that nothing else may enter or leave in the step of an activation.
    """

    part: str
    at: tuple[str, ...]
    edges: tuple[int, ...]
    cost: int
    capacity: int
    grounded: bool
    gather: int | None = None
    locks: str | None = None
    token: int | None = None
    touches: tuple[str, ...] = ()

    @property
    def in_place(self) -> bool:
        """Whether it moves the top of a pile, in its order."""
        return self.gather is None


@dataclass(frozen=True)
class Gadget:
    """A gadget for `locations` of `height` nodes each (the paper's S stacks and l objects). Build it by the library."""

    locations: tuple[str, ...]
    height: int
    nodes: tuple[Node, ...]
    edges: tuple[Edge, ...]
    aggregates: tuple[Aggregate, ...] = ()
    tokens: tuple[Token, ...] = ()
    parts: Mapping[str, AggregatingPart] = field(default_factory=dict)

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


class GadgetBuilder:
    """Collects nodes, edges, tokens and aggregates; parts extend it, `build` closes it."""

    def __init__(
        self, locations: Iterable[str], height: int, costs: Costs = UNIT_COSTS, *, literal: bool = False
    ) -> None:
        """Begin a gadget.

        Args:
            locations: the stack locations.
            height: nodes of each.
            costs: what actions cost.
            literal: the paper's printed cost, 1 for a pick and a place together.
        """
        self.locations = tuple(locations)
        self.height = height
        self.costs = costs
        self._literal = literal
        self._nodes: list[Node] = []
        self._numbers: dict[NodeKey, int] = {}
        self._edges: list[Edge] = []
        self._aggregates: list[Aggregate] = []
        self._tokens: list[Token] = []
        self._sources: list[int] = []
        self._targets: list[int] = []
        self._parts: dict[str, AggregatingPart] = {}

    def add_node(
        self,
        kind: NodeKind,
        capacity: int,
        location: str | None = None,
        index: int = 0,
        *,
        spot: str | None = None,
        token: int | None = None,
    ) -> int:
        """Add a node and return its number."""
        key = NodeKey(kind, location, index)
        number = self._numbers[key] = len(self._numbers)
        self._nodes.append(Node(key, capacity, spot, token))
        return number

    def add_edge(self, tail: int, head: int, kind: EdgeKind, cost: int, capacity: int) -> int:
        """Add an edge between two node numbers and return its number."""
        self._edges.append(Edge(tail, head, kind, cost, capacity))
        return len(self._edges) - 1

    def add_aggregate(self, aggregate: Aggregate) -> None:
        """Add one place of an aggregating action."""
        self._aggregates.append(aggregate)

    @property
    def next_token(self) -> int:
        """The number that the next token will have."""
        return len(self._tokens)

    def add_token(self, token: Token) -> None:
        """Add a token, whose nodes are there already."""
        self._tokens.append(token)

    def add_part(self, part: AggregatingPart) -> None:
        """Let an aggregating action add its nodes, edges, tokens and aggregates."""
        part.extend(self)
        self._parts[part.name] = part

    def join(self, nodes: Sequence[int], *, picked: bool = True, placed: bool = True) -> None:
        """Add the pick-and-place edges between `nodes`, and between them and all that were joined before.

        Args:
            nodes: node numbers.
            picked: whether blocks are picked from them.
            placed: whether blocks are placed on them.
        """
        for source in nodes if picked else ():
            self._join_to(source, self._targets)
        new = list(nodes) if placed else []
        for source in [*self._sources, *(nodes if picked else ())]:
            self._join_to(source, new)
        self._sources.extend(nodes if picked else ())
        self._targets.extend(new)

    def _join_to(self, source: int, targets: Iterable[int]) -> None:
        tail = self._nodes[source]
        kind = EdgeKind.RETURN if tail.kind is NodeKind.INTERFACE else EdgeKind.TRANSFER
        for target in targets:
            head = self._nodes[target]
            if tail.location is None or tail.location != head.location:
                self.add_edge(source, target, kind, self._pick_and_place(tail, head), 1)

    def _pick_and_place(self, tail: Node, head: Node) -> int:
        if self._literal:
            return 1
        assert tail.spot is not None
        assert head.spot is not None
        return self.costs.of("pick") + self.costs.of("place") + self.costs.distance(tail.spot, head.spot)

    def node(self, kind: NodeKind, location: str | None = None, index: int = 0) -> int:
        """Return the number of a node that is there already."""
        return self._numbers[NodeKey(kind, location, index)]

    def top(self, location: str) -> int:
        """Return the number of v_s^l of `location`."""
        return self.node(NodeKind.STACK, location, self.height)

    def build(self) -> Gadget:
        """Return the finished gadget."""
        return Gadget(
            locations=self.locations,
            height=self.height,
            nodes=tuple(self._nodes),
            edges=tuple(self._edges),
            aggregates=tuple(self._aggregates),
            tokens=tuple(self._tokens),
            parts=dict(self._parts),
        )
