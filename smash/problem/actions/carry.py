"""Carry: a carrier is moved to another station with all that lies on it (paper, "Demonstration: Scoop")."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from smash.problem.actions.kind import AggregatingKind, Hop
from smash.problem.model import Aggregating, Instance, PlanOptions, State


@dataclass(frozen=True, slots=True)
class Carry(Aggregating):
    """Move `carrier` to `station`, with the blocks on it, in one action."""

    carrier: str
    station: str

    def __str__(self) -> str:
        return f"carry {self.carrier!r} to {self.station!r}"


class CarryKind(AggregatingKind[Carry]):
    """Gathers what picks and places have put on a carrier, leaves it there at known poses, somewhere else."""

    name = "carry"
    action = Carry
    form = '["carry", carrier, station]'
    grounded = True

    def available(self, instance: Instance) -> bool:
        """An instance with carriers has it."""
        return bool(instance.carriers)

    def refusal(self, instance: Instance, options: PlanOptions, state: State, action: Carry) -> str | None:
        """Return why the carry is illegal, or None."""
        carrier = next((known for known in instance.carriers if known.name == action.carrier), None)
        if carrier is None:
            return f"no carrier is called {action.carrier!r}"
        if action.station not in carrier.stations:
            return f"{action.station!r} is no station of {action.carrier!r}"
        other = next((name for name, station in state.stations.items() if station == action.station), None)
        return None if other is None else f"{other!r} stands at {action.station!r}"

    def apply(self, state: State, action: Carry) -> None:
        """Move the carrier."""
        state.stations[action.carrier] = action.station

    def legal(self, instance: Instance, options: PlanOptions, state: State) -> Iterator[Carry]:
        """Yield a carry of each carrier to each free station of its own."""
        taken = set(state.stations.values())
        for carrier in instance.carriers:
            yield from (Carry(carrier.name, station) for station in carrier.stations if station not in taken)

    def gathered(self, state: State, action: Carry) -> tuple[str, ...]:
        """Return the blocks on the carrier."""
        return tuple(sorted(state.carried[action.carrier]))

    def way(self, state: State, action: Carry) -> tuple[str, str]:
        """Return the two stations."""
        return state.stations[action.carrier], action.station

    def hops(self, instance: Instance, options: PlanOptions) -> Iterator[Hop]:
        """Yield the ways between the stations of each carrier."""
        for carrier in instance.carriers:
            for origin, target in itertools.permutations(carrier.stations, 2):
                cost = instance.costs.of(self.name) + instance.costs.distance(origin, target)
                yield Hop(origin, target, cost, carrier.capacity)

    def read(self, entry: list[Any]) -> Carry | None:
        """Return the carry of `["carry", carrier, station]`."""
        match entry:
            case [_, str(carrier), str(station)]:
                return Carry(carrier, station)
        return None

    def write(self, action: Carry) -> list[str | int]:
        """Return `["carry", carrier, station]`."""
        return [self.name, action.carrier, action.station]
