"""The places between which blocks move, and what each edge costs (paper, section "Method": costs of edges).

A place is a location, a *deck* (a carrier at one of its stations) or the table region. Heights and the order of
piles are the model's business, not theirs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from smash.planners.milp.arrays import Ints
from smash.problem.actions.carry import Carry
from smash.problem.model import TABLE, Carrier, Instance
from smash.problem.problem import Problem

NO_EDGE = -1


def free(price: Ints) -> Ints:
    """Return 0 where there is an edge, whatever it costs; `NO_EDGE` elsewhere."""
    return np.where(price >= 0, 0, NO_EDGE)


@dataclass(frozen=True, slots=True)
class Deck:
    """A carrier at one of its stations; `carrier` is its number."""

    carrier: int
    station: str


@dataclass(frozen=True, slots=True)
class Places:
    """Places by number: the locations, the decks, the table region.

    Attributes:
        locations: names of the locations.
        decks: the decks, carrier by carrier.
        carriers: the carriers by number.
        transfer: (places, places) what a pick at one and a place at the other cost together, -1: no such edge.
        carry: (decks, decks) what it costs to move a carrier from one station to another, -1: no such edge.
        lift: (locations, locations) what it costs to lift blocks from one pile to another, -1: no such edge.
        topple: what a topple costs.
        toppled: how many of the locations, the first ones, are beside a topple region; 0 where topple is not allowed.
        lifted: most blocks of one lift; 0 where lift is not allowed.
    """

    locations: tuple[str, ...]
    decks: tuple[Deck, ...]
    carriers: tuple[Carrier, ...]
    transfer: Ints
    carry: Ints
    lift: Ints
    topple: int
    toppled: int
    lifted: int

    @classmethod
    def of(cls, problem: Problem) -> Places:
        """Work out the places of a problem and the edges that its options leave."""
        instance, allowed = problem.instance, {kind.name for kind in problem.kinds}
        carriers = instance.carriers
        decks = tuple(Deck(number, station) for number, one in enumerate(carriers) for station in one.stations)
        lifted = instance.capacities["lift"] if "lift" in allowed else 0
        return cls(
            locations=instance.locations,
            decks=decks,
            carriers=carriers,
            transfer=_transfers(instance, decks, "carry" in allowed),
            carry=_carries(instance, decks, "carry" in allowed),
            lift=_lifts(instance, lifted),
            topple=instance.costs.of("topple"),
            toppled=len(instance.stacks) if "topple" in allowed else 0,
            lifted=lifted,
        )

    @property
    def count(self) -> int:
        """Number of places."""
        return len(self.locations) + len(self.decks) + 1

    @property
    def table(self) -> int:
        """The number of the table region, the last place."""
        return self.count - 1

    @property
    def inside(self) -> slice:
        """The numbers of the decks as places."""
        return slice(len(self.locations), self.table)

    def occupied(self) -> Iterator[tuple[int, Carrier]]:
        """Yield the decks at which a carrier stands at the start, by number, with the carrier."""
        for number, deck in enumerate(self.decks):
            carrier = self.carriers[deck.carrier]
            if carrier.at == deck.station:
                yield number, carrier

    def carry_to(self, deck: int) -> Carry:
        """Return the action that brings a carrier to a deck."""
        return Carry(self.carriers[self.decks[deck].carrier].name, self.decks[deck].station)

    def source(self, place: int) -> str:
        """Return what a pick or a place calls a place."""
        if place < len(self.locations):
            return self.locations[place]
        if place == self.table:
            return TABLE
        return self.carriers[self.decks[place - len(self.locations)].carrier].name


def _transfers(instance: Instance, decks: tuple[Deck, ...], loads: bool) -> Ints:
    costs = instance.costs
    handling = costs.of("pick") + costs.of("place")
    locations = len(instance.locations)
    points = [*instance.locations, *(deck.station for deck in decks), TABLE]
    table = np.full((len(points), len(points)), NO_EDGE, dtype=np.int64)
    for source in range(len(points)):
        for target in range(locations + (len(decks) if loads else 0)):
            if source != target and not _same_carrier(decks, source - locations, target - locations):
                table[source, target] = handling + costs.distance(points[source], points[target])
    return table


def _same_carrier(decks: tuple[Deck, ...], one: int, other: int) -> bool:
    inside = range(len(decks))
    return one in inside and other in inside and decks[one].carrier == decks[other].carrier


def _carries(instance: Instance, decks: tuple[Deck, ...], allowed: bool) -> Ints:
    table = np.full((len(decks), len(decks)), NO_EDGE, dtype=np.int64)
    for one, deck in enumerate(decks):
        for other, target in enumerate(decks):
            if allowed and one != other and deck.carrier == target.carrier:
                table[one, other] = instance.costs.of("carry") + instance.costs.distance(deck.station, target.station)
    return table


def _lifts(instance: Instance, most: int) -> Ints:
    locations = instance.locations
    table = np.full((len(locations), len(locations)), NO_EDGE, dtype=np.int64)
    for one, source in enumerate(locations):
        for other, target in enumerate(locations):
            if most and one != other:
                table[one, other] = instance.costs.of("lift") + instance.costs.distance(source, target)
    return table
