"""From the events of a layered solution to actions: where each block that is put aside rests meanwhile.

The model asks only that a block is off its start place between two layers. Here it gets a location: one on
whose top nothing happens until the block has left again, the one that is needed soonest after that.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from smash.planners.layered.blocks import MovingBlocks
from smash.planners.layered.draft import Draft
from smash.planners.layered.events import Event
from smash.problem.actions.topple import Topple
from smash.problem.model import Action
from smash.problem.problem import Problem

NEVER = 1 << 30


@dataclass(slots=True)
class _Chain:
    """A goal chain while it is built; `location` is None until a free one is taken."""

    location: str | None
    bottom: bool


class Packing:
    """Turns the events of one solution into actions."""

    def __init__(self, problem: Problem, blocks: MovingBlocks, events: Sequence[Event]) -> None:
        self.instance = problem.instance
        self.blocks = blocks
        self.events = events
        self.draft = Draft(problem)
        self.resting: dict[str, list[int]] = {location: [] for location in self.instance.locations}
        located = len(blocks.demands.build)
        bottoms = [False] * located + [chain.bottom for chain in blocks.demands.floating]
        self.chains = [_Chain(at, bottom) for (at, _), bottom in zip(blocks.chains, bottoms, strict=True)]
        self.chain_of = {block: number for number, (_, chain) in enumerate(blocks.chains) for block in chain}
        self.pile_of = {block: at for at, pile in blocks.piles for block in pile}
        self.returns = {e.subject: i for i, e in enumerate(events) if e.kind == "from_aside"}

    def actions(self) -> tuple[Action, ...] | None:
        """Return the plan, or None where some block finds no place to rest.

        Raises:
            IllegalAction: where the events are no plan.
        """
        for index, event in enumerate(self.events):
            if event.kind == "topple":
                assert event.location is not None
                self.draft.add(Topple(event.location, self.blocks.demands.keep[event.location] + event.subject + 1))
                continue
            block = self.blocks.names[event.subject]
            source = self.draft.place_of(block)
            target = self._target(index, event, source)
            if target is None:
                return None
            if event.kind == "from_aside":
                self.resting[source].remove(event.subject)
            elif event.kind == "aside":
                self.resting[target].append(event.subject)
            self.draft.move(block, source, target)
        return self.draft.actions

    def _target(self, index: int, event: Event, source: str) -> str | None:
        if event.kind == "aside":
            if event.location is not None:
                return event.location
            until = self.returns.get(event.subject, NEVER)
            return self._resting_place(index, until, source)
        chain = self.chains[self.chain_of[event.subject]]
        if chain.location is None:
            chain.location = self._free_location(index, chain.bottom, source)
        return chain.location

    def _resting_place(self, index: int, until: int, source: str) -> str | None:
        fits = []
        for order, location in enumerate(self.instance.locations):
            free_until = self._next_use(index, location)
            if location != source and (free_until > until or free_until == until == NEVER):
                stacked = location in self.instance.stacks or bool(self.draft.state.piles[location])
                fits.append((free_until, stacked, order, location))
        return min(fits)[-1] if fits else None

    def _free_location(self, index: int, bottom: bool, source: str) -> str | None:
        piles = self.draft.state.piles
        for location in sorted(self.instance.locations, key=lambda at: bool(piles[at])):
            if bottom and piles[location]:
                return None
            if location != source and self._next_use(index, location) == NEVER:
                return location
        return None

    def _next_use(self, index: int, location: str) -> int:
        """Return the index of the next event that touches what lies on top of `location`, or `NEVER`."""
        soonest = min((self.returns.get(block, NEVER) for block in self.resting[location]), default=NEVER)
        for later in range(index + 1, min(soonest, len(self.events))):
            if self._touches(self.events[later], location):
                return later
        return soonest

    def _touches(self, event: Event, location: str) -> bool:
        if event.kind == "topple":
            return event.location == location
        if event.kind in ("direct", "aside") and self.pile_of.get(event.subject) == location:
            return True
        if event.kind == "aside":
            return False
        return self.chains[self.chain_of[event.subject]].location == location
