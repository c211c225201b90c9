"""Carry as an aggregating part: carriers that move between stations with all that lies on them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from itertools import permutations
from typing import ClassVar, Self

from smash.gadget.builder import AggregatingPart, GadgetBuilder
from smash.gadget.elements import Aggregate, EdgeKind, NodeKind, Token
from smash.problem.actions.carry import Carry, CarryKind
from smash.problem.actions.kind import allowed
from smash.problem.model import Aggregating, Carrier, Instance, PlanOptions, State


@dataclass(frozen=True, slots=True)
class CarryPart(AggregatingPart):
    """The nodes (C, p) of carrier C at station p, joined to all tops by pick and place, and the edges between them.

    The carrier is a token: blocks are in (C, p) only while it stands there, and take ((C, p), (C, q)) together with
    it.

    Attributes:
        carriers: the carriers.
        moves: whether they can be carried; else blocks are only picked off them.
    """

    name: ClassVar[str] = CarryKind.name
    carriers: tuple[Carrier, ...]
    moves: bool = True

    @classmethod
    def of(cls, instance: Instance, options: PlanOptions) -> Self | None:
        """Return the part of an instance: with carriers that stand still where carrying is not allowed."""
        moves = allowed(CarryKind(), instance, options)
        if not moves and not any(carrier.holds for carrier in instance.carriers):
            return None
        return cls(instance.carriers, moves)

    def extend(self, builder: GadgetBuilder) -> None:
        """Add the carriers with their nodes and edges."""
        for carrier in self.carriers:
            token = builder.next_token
            nodes = {
                station: builder.add_node(
                    NodeKind.CARRIER, carrier.capacity, carrier.name, index, spot=station, token=token
                )
                for index, station in enumerate(carrier.stations, start=1)
                if self.moves or station == carrier.at
            }
            builder.add_token(Token(carrier.name, nodes))
            if builder.height:
                builder.join(list(nodes.values()), placed=self.moves)
            for origin, target in permutations(nodes, 2):
                cost = builder.costs.of(self.name) + builder.costs.distance(origin, target)
                edge = builder.add_edge(nodes[origin], nodes[target], EdgeKind.CARRY, cost, carrier.capacity)
                builder.add_aggregate(
                    Aggregate(
                        self.name, (carrier.name, origin, target), (edge,), cost, carrier.capacity, CarryKind.grounded,
                        gather=nodes[origin], token=token, touches=(carrier.name,),
                    )
                )  # fmt: skip

    def action(self, aggregate: Aggregate, blocks: Collection[str], state: State) -> Carry:
        """Return the carry between the aggregate's stations."""
        carrier, _, target = aggregate.at
        return Carry(carrier, target)

    def at(self, action: Aggregating, state: State) -> tuple[str, ...] | None:
        """Return the carrier, where it stands and where it goes."""
        if not isinstance(action, Carry):
            return None
        return action.carrier, state.stations[action.carrier], action.station
