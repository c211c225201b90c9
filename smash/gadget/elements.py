"""What a gadget is made of (paper, section "Method").

Nodes have a kind and a capacity, edges a kind, a cost and a capacity. *Tokens* are things that move themselves, and
without which some nodes are not there; *aggregates* are the places where one action moves several pebbles at once. An
aggregating action is a part over these four notions.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from smash.problem.model import Aggregating, State


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

    Pebbles are gathered in one of four ways. With `locks`, they are staged in the gathering node before (v_{T_s});
    with `token`, they are those in the gathering node when the token leaves it, none included; with `gather` alone,
    they are all in the gathering node, whose token stays; without it they are the top of a pile, in place: `edges` are
    then rungs from the top node downward, and a rung is taken only together with the ones above it, so that order and
    coherence are kept.

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


class PartReading(Protocol):
    """How activations of a part's aggregates and actions of the law are read from one another."""

    @property
    def name(self) -> str:
        """The action's name, unique in a gadget, as in `smash.problem.actions.registry`."""
        ...

    @property
    def stacks_several(self) -> bool:
        """Whether an activation puts blocks on a pile (one that takes what is in place, and keeps its order)."""
        ...

    def action(self, aggregate: Aggregate, blocks: Collection[str], state: State) -> Aggregating:
        """Return the action that an activation of `aggregate` with `blocks` stands for, in the state before it."""
        ...

    def at(self, action: Aggregating, state: State) -> tuple[str, ...] | None:
        """Return the `at` of the aggregate that `action` activates in the state before it; None: not this part's."""
        ...
