"""Where things are, for PDDL: spots between which ways are paid, regions of locations, carriers and stations."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

from smash.problem.model import TABLE, Instance, State
from smash_baselines.names import Names, count_names, numbered

T = TypeVar("T")
Point = tuple[float, float]
NOWHERE: Point = (0.0, 0.0)
"""Where everything is as long as no way costs anything."""
IN_HAND: Point = (math.inf, math.inf)
"""Where a block is taken from that the hand holds at the start: its first way costs nothing."""


@dataclass(frozen=True, slots=True)
class Layout:
    """The PDDL objects of an instance beside its blocks and stack locations, by what they stand for.

    Attributes:
        instance: the instance.
        names: its blocks and stack locations.
        spots: a spot for each position of a place; one in all where travel costs nothing. Where it costs something and
            the hand holds a block at the start, one more.
        regions: a region for the stack locations (True) and for the buffers (False) of each spot.
        carriers: the carriers by name.
        stations: the stations by name.
        counts: the objects that count, from 0 to the number of blocks or buffers.
    """

    instance: Instance
    names: Names
    spots: Mapping[Point, str] = field(init=False)
    regions: Mapping[tuple[bool, str], str] = field(init=False)
    carriers: Mapping[str, str] = field(init=False)
    stations: Mapping[str, str] = field(init=False)
    counts: tuple[str, ...] = field(init=False)

    def __post_init__(self) -> None:
        instance = self.instance
        stations = dict.fromkeys(station for carrier in instance.carriers for station in carrier.stations)
        places = [*instance.locations, TABLE, *stations]
        held = [IN_HAND] if instance.hand is not None and instance.costs.travel else []
        fields = {
            "spots": _numbered("p", [*map(self._point, places), *held]),
            "carriers": numbered("c", [carrier.name for carrier in instance.carriers]),
            "stations": numbered("t", stations),
            "counts": tuple(count_names(max(len(instance.blocks), len(instance.buffers)))),
        }
        for name, value in fields.items():
            object.__setattr__(self, name, value)
        regions = [(location in self.names.locations, self.spot(location)) for location in instance.locations]
        object.__setattr__(self, "regions", _numbered("r", regions))

    def spot(self, place: str) -> str:
        """Return the spot of a location, the table region or a station."""
        return self.spots[self._point(place)]

    def origin(self, place: str | None) -> str:
        """Return the spot that the held block was taken from.

        Args:
            place: where from; None: it is in the hand since the start, or no way costs.
        """
        return self.spots[IN_HAND] if place is None and IN_HAND in self.spots else self.spot(place or TABLE)

    def region(self, location: str) -> str:
        """Return the region of a location."""
        return self.regions[location in self.names.locations, self.spot(location)]

    def count(self, number: int) -> str:
        """Return the object that stands for a number; larger ones than any plan needs are cut down."""
        return self.counts[min(number, len(self.counts) - 1)]

    def free(self, state: State, region: str) -> list[str]:
        """Return the empty buffers of a region."""
        return [at for at in self.instance.buffers if not state.piles[at] and self.region(at) == region]

    def ways(self) -> Iterator[tuple[str, str, int]]:
        """Yield every ordered pair of spots with what the way between them costs."""
        samples = {self.spot(place): place for place in [*self.instance.locations, TABLE]}
        samples |= {self.spot(station): station for station in self.stations}
        for origin, here in samples.items():
            for target, there in samples.items():
                yield origin, target, self.instance.costs.distance(here, there)
        if IN_HAND in self.spots:
            yield from ((self.spots[IN_HAND], target, 0) for target in samples)

    def _point(self, place: str) -> Point:
        costs = self.instance.costs
        return costs.positions[place] if costs.travel else NOWHERE


def _numbered(letter: str, items: list[T]) -> dict[T, str]:
    distinct = list(dict.fromkeys(items))
    return dict(zip(distinct, numbered(letter, map(str, range(len(distinct)))).values(), strict=True))
