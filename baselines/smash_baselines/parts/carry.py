"""Carry in the family's domains: the carrier moves, and blocks are on the carrier and not at its station."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from smash.problem.actions.carry import Carry
from smash.problem.model import Action, Instance, Pick, Place, PlanOptions, State
from smash_baselines.names import Fact, Step
from smash_baselines.parts.part import Part, Telling


class CarryPart(Part):
    """`carry`, and the picks and places that load and unload."""

    kind = "carry"
    blocks_only_hinder = True

    def needed(self, instance: Instance, options: PlanOptions) -> bool:
        """Return whether there is something to carry, or to pick from a carrier that stays where it is."""
        return super().needed(instance, options) or any(carrier.holds for carrier in instance.carriers)

    def objects(self, telling: Telling) -> Mapping[str, tuple[str, ...]]:
        """Return the carriers and stations."""
        return {
            "carrier": tuple(telling.layout.carriers.values()),
            "station": tuple(telling.layout.stations.values()),
        }

    def start(self, telling: Telling) -> Iterator[Fact]:
        """Yield where the carriers are, what they hold and where they can go."""
        layout, instance = telling.layout, telling.instance
        carries = telling.options.allows(self.kind)
        for carrier in instance.carriers:
            short = layout.carriers[carrier.name]
            yield ("parked", short, layout.stations[carrier.at])
            yield ("room", short, room(telling, carrier.name, len(carrier.holds)))
            yield from (("on-carrier", telling.block(block), short) for block in carrier.holds)
            if carries:
                yield ("loads", short)
                yield from (("reaches", short, layout.stations[station]) for station in carrier.stations)
        taken = {carrier.at for carrier in instance.carriers}
        for station, short in layout.stations.items():
            yield ("station-at", short, layout.spot(station))
            if station not in taken:
                yield ("vacant", short)

    def costs(self, telling: Telling) -> Iterator[tuple[Fact, int]]:
        """Yield what a carry costs over each way."""
        carry = telling.instance.costs.of(self.kind)
        yield from ((("carry-cost", origin, target), carry + way) for origin, target, way in telling.layout.ways())

    def tells(self, telling: Telling, action: Action) -> bool:
        """Carries, and the picks and places of carriers."""
        match action:
            case Pick(_, place) | Place(_, place):
                return place in telling.layout.carriers
        return isinstance(action, Carry)

    def steps(self, telling: Telling, state: State, action: Action) -> Iterator[Step]:
        """Yield the one step."""
        layout = telling.layout
        match action:
            case Pick(block, carrier):
                held, stand = len(state.carried[carrier]), self._stand(telling, state, carrier)
                counts = room(telling, carrier, held), room(telling, carrier, held - 1)
                yield ("pick-from-carrier", telling.block(block), *stand, *counts)
            case Place(block, carrier):
                short, station, spot = self._stand(telling, state, carrier)
                held, origin = len(state.carried[carrier]), layout.origin(state.origin)
                counts = room(telling, carrier, held), room(telling, carrier, held + 1)
                yield ("place-on-carrier", telling.block(block), short, station, origin, spot, *counts)
            case Carry(carrier, target):
                short, station, spot = self._stand(telling, state, carrier)
                yield ("carry", short, station, layout.stations[target], spot, layout.spot(target))

    def action(self, telling: Telling, state: State, step: Step) -> Action | None:
        """Return the carry, pick or place."""
        carriers = {short: name for name, short in telling.layout.carriers.items()}
        stations = {short: name for name, short in telling.layout.stations.items()}
        match step:
            case ("pick-from-carrier", block, carrier, *_):
                return Pick(telling.named(block), carriers[carrier])
            case ("place-on-carrier", block, carrier, *_):
                return Place(telling.named(block), carriers[carrier])
            case (_, carrier, _, target, *_):
                return Carry(carriers[carrier], stations[target])
        raise ValueError("an argument is missing")

    def _stand(self, telling: Telling, state: State, carrier: str) -> tuple[str, str, str]:
        """Return a carrier, its station and its spot."""
        layout, station = telling.layout, state.stations[carrier]
        return layout.carriers[carrier], layout.stations[station], layout.spot(station)


def room(telling: Telling, carrier: str, held: int) -> str:
    """Return the count of the blocks that fit on a carrier beside those that it holds."""
    capacity = next(known.capacity for known in telling.instance.carriers if known.name == carrier)
    return telling.layout.count(min(capacity, len(telling.instance.blocks)) - held)
