"""How a gadget is put together: locations first, then a part an aggregating action."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Sequence
from typing import ClassVar, Self

from smash.gadget.elements import Aggregate, Edge, EdgeKind, Node, NodeKey, NodeKind, Token
from smash.gadget.graph import Gadget
from smash.problem.costs import UNIT_COSTS, Costs
from smash.problem.model import Aggregating, Instance, PlanOptions, State


class AggregatingPart(ABC):
    """One aggregating action (topple, …) as a part of a gadget. Each lives in one small file.

    The part says where the action gathers objects, how many, what it costs, what it locks and touches, and whether
    its outcome is grounded (all in `Aggregate`), and which action of the law an activation stands for. Models, the
    motion rules, encoding, decoding and drawing ask nothing else.

    Attributes:
        name: the action's name, as in `smash.problem.actions.registry`.
        stacks_several: whether an activation puts blocks on a pile (one that takes what is in place, in its order).
    """

    name: ClassVar[str]
    stacks_several: ClassVar[bool] = False

    @classmethod
    @abstractmethod
    def of(cls, instance: Instance, options: PlanOptions) -> Self | None:
        """Return the part of an instance's gadget; None: the gadget does without."""

    @abstractmethod
    def extend(self, builder: GadgetBuilder) -> None:
        """Add the part's nodes, edges, tokens and aggregates."""

    @abstractmethod
    def action(self, aggregate: Aggregate, blocks: Collection[str], state: State) -> Aggregating:
        """Return the action that an activation of `aggregate` with `blocks` stands for, in the state before it."""

    @abstractmethod
    def at(self, action: Aggregating, state: State) -> tuple[str, ...] | None:
        """Return the `at` of the aggregate that `action` activates in the state before it; None: not this part's."""


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

    def has(self, kind: NodeKind, location: str | None = None, index: int = 0) -> bool:
        """Return whether a node is there already."""
        return NodeKey(kind, location, index) in self._numbers

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
