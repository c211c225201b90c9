"""Topple as an aggregating part: G^+_SMASH of the paper's definition "SMASH Gadget"."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import ClassVar, Self

from smash.gadget.builder import AggregatingPart, GadgetBuilder
from smash.gadget.elements import Aggregate, EdgeKind, NodeKind
from smash.problem.actions.kind import allowed
from smash.problem.actions.topple import Topple, ToppleKind
from smash.problem.model import TABLE, Aggregating, Instance, PlanOptions, State


@dataclass(frozen=True, slots=True)
class TopplePart(AggregatingPart):
    """V^+_SMASH and E^+_SMASH: the TOPPLE nodes v_{T_s}, the TABLE node v_T, the interface nodes v_T^i.

    Attributes:
        stacks: locations with a topple region beside them, hence with a TOPPLE node.
        most: most blocks of one topple (the paper's l; `max_topple` where that is smaller).
    """

    name: ClassVar[str] = ToppleKind.name
    stacks: tuple[str, ...]
    most: int

    @classmethod
    def of(cls, instance: Instance, options: PlanOptions) -> Self | None:
        """Return the part of an instance: without TOPPLE nodes where only the table region is needed, to pick from."""
        may = allowed(ToppleKind(), instance, options)
        if not may and not instance.table:
            return None
        height = len(instance.blocks)
        most = height if options.max_topple is None else min(height, options.max_topple)
        return cls(instance.stacks if may else (), most)

    def extend(self, builder: GadgetBuilder) -> None:
        """Add the nodes and edges of G^+_SMASH."""
        blocks = builder.height
        staging = [builder.add_node(NodeKind.TOPPLE, self.most, stack) for stack in self.stacks]
        table = builder.add_node(NodeKind.TABLE, blocks, spot=TABLE)
        interfaces = [
            builder.add_node(NodeKind.INTERFACE, 1, index=index, spot=TABLE) for index in range(1, blocks + 1)
        ]
        if not blocks:
            return
        for stack, node in zip(self.stacks, staging, strict=True):
            builder.add_edge(builder.top(stack), node, EdgeKind.STAGE, 0, 1)
        cost = builder.costs.of(self.name)
        for stack, node in zip(self.stacks, staging, strict=True):
            edge = builder.add_edge(node, table, EdgeKind.TOPPLE, cost, self.most)
            builder.add_aggregate(
                Aggregate(self.name, (stack,), (edge,), cost, self.most, ToppleKind.grounded, gather=node, locks=stack)
            )
        for interface in interfaces:
            builder.add_edge(table, interface, EdgeKind.EXPOSE, 0, 1)
        builder.join(interfaces, placed=False)

    def action(self, aggregate: Aggregate, blocks: Collection[str], state: State) -> Topple:
        """Return the topple that brings `blocks`, the topmost ones of a stack, down."""
        (location,) = aggregate.at
        return Topple(location, len(state.piles[location]) - len(blocks) + 1)

    def at(self, action: Aggregating, state: State) -> tuple[str, ...] | None:
        """Return the stack that a topple brings down."""
        return (action.location,) if isinstance(action, Topple) else None
