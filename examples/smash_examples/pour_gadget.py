"""The pour on the gadget: all pebbles at a carrier's node go to the TABLE node in one activation; the carrier stays."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Self

from smash.gadget import Aggregate, AggregatingPart, EdgeKind, GadgetBuilder, NodeKind
from smash.gadget.parts.topple import TopplePart
from smash.problem.actions.kind import allowed
from smash.problem.model import Aggregating, Carrier, Instance, PlanOptions, State
from smash_examples.pour import Pour, PourKind


@dataclass(frozen=True)
class PourPart(AggregatingPart):
    """The edges ((C, p), v_T) of carrier C at station p; the nodes are those of carry and topple."""

    name = "pour"
    carriers: tuple[Carrier, ...]

    @classmethod
    def of(cls, instance: Instance, options: PlanOptions) -> Self | None:
        """Return the part of an instance that has carriers to pour."""
        return cls(instance.carriers) if allowed(PourKind(), instance, options) else None

    def extend(self, builder: GadgetBuilder) -> None:
        """Add the edges, and the TABLE node where nothing else needs it."""
        if not builder.has(NodeKind.TABLE):
            TopplePart((), builder.height).extend(builder)
        table, cost = builder.node(NodeKind.TABLE), builder.costs.of(self.name)
        for carrier in self.carriers:
            for index, station in enumerate(carrier.stations, start=1):
                if not builder.has(NodeKind.CARRIER, carrier.name, index):
                    continue
                node = builder.node(NodeKind.CARRIER, carrier.name, index)
                edge = builder.add_edge(node, table, EdgeKind.TOPPLE, cost, carrier.capacity)
                builder.add_aggregate(
                    Aggregate(
                        part=self.name,
                        at=(carrier.name, station),
                        edges=(edge,),
                        cost=cost,
                        capacity=carrier.capacity,
                        grounded=PourKind.grounded,
                        gather=node,
                        touches=(carrier.name,),
                    )
                )

    def action(self, aggregate: Aggregate, blocks: Collection[str], state: State) -> Pour:
        """Return the pour of the aggregate's carrier."""
        return Pour(aggregate.at[0])

    def at(self, action: Aggregating, state: State) -> tuple[str, ...] | None:
        """Return the carrier and where it stands."""
        return (action.carrier, state.stations[action.carrier]) if isinstance(action, Pour) else None
