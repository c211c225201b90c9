"""Lift as an aggregating part: rungs between the upper nodes of two locations, taken together."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from itertools import permutations
from typing import ClassVar, Self

from smash.gadget.builder import AggregatingPart, GadgetBuilder
from smash.gadget.elements import Aggregate, EdgeKind, NodeKind
from smash.problem.actions.kind import allowed
from smash.problem.actions.lift import Lift, LiftKind
from smash.problem.model import Aggregating, Instance, PlanOptions, State


@dataclass(frozen=True, slots=True)
class LiftPart(AggregatingPart):
    """The rungs (v_u^i, v_w^i), i = l - most + 1 to l, for every two locations: blocks keep their height and order.

    Attributes:
        most: most blocks of one lift.
    """

    name: ClassVar[str] = LiftKind.name
    stacks_several: ClassVar[bool] = True
    most: int

    @classmethod
    def of(cls, instance: Instance, options: PlanOptions) -> Self | None:
        """Return the part of an instance that says how many blocks are lifted at once."""
        return cls(instance.capacities[cls.name]) if allowed(LiftKind(), instance, options) else None

    def extend(self, builder: GadgetBuilder) -> None:
        """Add the rungs, the top one first."""
        heights = range(builder.height, max(0, builder.height - self.most), -1)
        for source, target in permutations(builder.locations if heights else (), 2):
            cost = builder.costs.of(self.name) + builder.costs.distance(source, target)
            rungs = tuple(
                builder.add_edge(
                    builder.node(NodeKind.STACK, source, height),
                    builder.node(NodeKind.STACK, target, height),
                    EdgeKind.LIFT,
                    cost,
                    1,
                )
                for height in heights
            )
            between = (source, target)
            builder.add_aggregate(
                Aggregate(self.name, between, rungs, cost, len(rungs), LiftKind.grounded, touches=between)
            )

    def action(self, aggregate: Aggregate, blocks: Collection[str], state: State) -> Lift:
        """Return the lift of `blocks`, the topmost ones of the first location."""
        source, target = aggregate.at
        return Lift(source, len(state.piles[source]) - len(blocks) + 1, target)

    def at(self, action: Aggregating, state: State) -> tuple[str, ...] | None:
        """Return the two locations of a lift."""
        return (action.source, action.target) if isinstance(action, Lift) else None
