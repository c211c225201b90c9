"""Topple as an aggregating part: G^+_SMASH of the paper's definition "SMASH Gadget"."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from smash.gadget.graph import Aggregate, EdgeKind, GadgetBuilder, NodeKind
from smash.problem.model import Action, State
from smash.problem.topple import Topple

NAME = "topple"


@dataclass(frozen=True, slots=True)
class TopplePart:
    """V^+_SMASH and E^+_SMASH: the TOPPLE nodes v_{T_s}, the TABLE node v_T, the interface nodes v_T^i.

    Attributes:
        stacks: locations with a topple region beside them, hence with a TOPPLE node.
        most: most blocks of one topple (the paper's l; `max_topple` where that is smaller).
        return_cost: cost of (v_T^i, v_s^l); 2 here, for a pick and a place, 1 in the paper.
    """

    stacks: tuple[str, ...]
    most: int
    return_cost: int = 2

    @property
    def name(self) -> str:
        """The action's name."""
        return NAME

    def extend(self, builder: GadgetBuilder) -> None:
        """Add the nodes and edges of G^+_SMASH."""
        blocks = builder.height
        staging = [builder.add_node(NodeKind.TOPPLE, self.most, stack) for stack in self.stacks]
        table = builder.add_node(NodeKind.TABLE, blocks)
        interfaces = [builder.add_node(NodeKind.INTERFACE, 1, index=index) for index in range(1, blocks + 1)]
        if not blocks:
            return
        for stack, node in zip(self.stacks, staging, strict=True):
            builder.add_edge(builder.top(stack), node, EdgeKind.STAGE, 0, 1)
        for stack, node in zip(self.stacks, staging, strict=True):
            edge = builder.add_edge(node, table, EdgeKind.TOPPLE, 1, self.most)
            builder.add_aggregate(Aggregate(NAME, node, edge, self.most, locks=stack, grounded=False))
        for interface in interfaces:
            builder.add_edge(table, interface, EdgeKind.EXPOSE, 0, 1)
        for interface in interfaces:
            for location in builder.locations:
                builder.add_edge(interface, builder.top(location), EdgeKind.RETURN, self.return_cost, 1)

    def action(self, location: str, blocks: Collection[str], state: State) -> Topple:
        """Return the topple that brings `blocks`, the topmost ones of `location`, down."""
        return Topple(location, len(state.piles[location]) - len(blocks) + 1)

    def gathered(self, action: Action, state: State) -> tuple[str, tuple[str, ...]] | None:
        """Return the blocks that a topple brings down, topmost first."""
        if not isinstance(action, Topple):
            return None
        return action.location, tuple(reversed(state.piles[action.location][action.height - 1 :]))
