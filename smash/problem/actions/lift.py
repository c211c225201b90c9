"""Lift: the upper part of a pile is grasped by its lowest block and put whole on another location."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from smash.problem.actions.kind import AggregatingKind, Hop
from smash.problem.model import Aggregating, Instance, PlanOptions, State


@dataclass(frozen=True, slots=True)
class Lift(Aggregating):
    """Move every block at `height` and above of `source`, in their order, to the top of `target`, in one action."""

    source: str
    height: int
    target: str

    def __str__(self) -> str:
        return f"lift {self.source!r} from height {self.height} to {self.target!r}"


class LiftKind(AggregatingKind[Lift]):
    """Gathers the top blocks of any pile, at most the instance's capacity, leaves them on another at known poses."""

    name = "lift"
    action = Lift
    form = '["lift", source, height, target]'
    grounded = True
    needs_capacity = True

    def available(self, instance: Instance) -> bool:
        """An instance that says how many blocks the hand can lift has it."""
        return self.name in instance.capacities

    def refusal(self, instance: Instance, options: PlanOptions, state: State, action: Lift) -> str | None:
        """Return why the lift is illegal, or None."""
        for location in (action.source, action.target):
            if location not in state.piles:
                return f"no location is called {location!r}"
        if action.source == action.target:
            return "a lift ends on another location"
        held = len(state.piles[action.source])
        if not 1 <= action.height <= held:
            return f"no block is lifted: the location holds {held}, heights count from 1"
        lifted, most = held - action.height + 1, instance.capacities[self.name]
        return None if lifted <= most else f"{lifted} blocks are lifted, the capacity is {most}"

    def apply(self, state: State, action: Lift) -> None:
        """Move the blocks from pile to pile."""
        pile = state.piles[action.source]
        state.piles[action.target].extend(pile[action.height - 1 :])
        del pile[action.height - 1 :]

    def legal(self, instance: Instance, options: PlanOptions, state: State) -> Iterator[Lift]:
        """Yield a lift for each pile, cut and other location."""
        for source, pile in state.piles.items():
            for height in range(max(1, len(pile) - instance.capacities[self.name] + 1), len(pile) + 1):
                yield from (Lift(source, height, target) for target in state.piles if target != source)

    def gathered(self, state: State, action: Lift) -> tuple[str, ...]:
        """Return the lifted blocks, topmost first."""
        return tuple(reversed(state.piles[action.source][action.height - 1 :]))

    def way(self, state: State, action: Lift) -> tuple[str, str]:
        """Return the two locations."""
        return action.source, action.target

    def hops(self, instance: Instance, options: PlanOptions) -> Iterator[Hop]:
        """Yield the ways between any two locations."""
        for origin, target in itertools.permutations(instance.locations, 2):
            cost = instance.costs.of(self.name) + instance.costs.distance(origin, target)
            yield Hop(origin, target, cost, instance.capacities[self.name])

    def read(self, entry: list[Any]) -> Lift | None:
        """Return the lift of `["lift", source, height, target]`."""
        match entry:
            case [_, str(source), int(height), str(target)] if not isinstance(height, bool):
                return Lift(source, height, target)
        return None

    def write(self, action: Lift) -> list[str | int]:
        """Return `["lift", source, height, target]`."""
        return [self.name, action.source, action.height, action.target]
