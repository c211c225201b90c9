"""From the events of a layered solution to actions: where each block that is put aside rests meanwhile.

The model asks only that a block is off its start place between two layers. Here it gets a location: one on
whose top nothing happens until the block has left again, the one that is needed soonest after that. Where there is
none it is put where it is in the way last, and moved once more when it is: the plan then costs more than the solution.
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
    """A goal chain while it is built; `location` is None until a free one is taken, `height` how high its pile is."""

    location: str | None
    bottom: bool
    height: int = 0


class Packing:
    """Turns the events of one solution into actions."""

    def __init__(self, problem: Problem, blocks: MovingBlocks, events: Sequence[Event]) -> None:
        self.instance = problem.instance
        self.blocks = blocks
        self.events = events
        self.draft = Draft(problem)
        self.resting: dict[str, list[int]] = {location: [] for location in self.instance.locations}
        demands = blocks.demands
        bottoms = [False] * len(demands.build) + [chain.bottom for chain in demands.floating]
        self.chains = [
            _Chain(at, bottom, 0 if at is None else demands.keep[at])
            for (at, _), bottom in zip(blocks.chains, bottoms, strict=True)
        ]
        self.number = {block: number for number, block in enumerate(blocks.names)}
        self.capped = problem.options.max_topple is not None
        self.chain_of = {block: number for number, (_, chain) in enumerate(blocks.chains) for block in chain}
        self.pile_of = {block: at for at, pile in blocks.piles for block in pile}
        self.returns = {e.subject: i for i, e in enumerate(events) if e.kind == "from_aside"}

    def actions(self) -> tuple[Action, ...] | None:
        """Return the plan, or None where some block finds no place at all.

        Raises:
            IllegalAction: where the events are no plan.
        """
        for index, event in enumerate(self.events):
            if event.kind == "topple":
                if not self._topple(index, event):
                    return None
                continue
            block = self.blocks.names[event.subject]
            source = self.draft.place_of(block)
            target = self._target(index, event, source)
            if target is not None and target == source and not self._step_aside(index, event, block, source):
                return None
            source = self.draft.place_of(block)
            if target is None or not self._uncover(index, event, block, source, target):
                return None
            if event.kind == "from_aside":
                self._rest_no_more(event.subject, source)
            elif event.kind == "aside":
                self.resting[target].append(event.subject)
            if event.kind != "aside":
                self.chains[self.chain_of[event.subject]].height += 1
            if source != target:
                self.draft.move(block, source, target)
        return self.draft.actions

    def _topple(self, index: int, event: Event) -> bool:
        """Topple; blocks that rest there fall too, if there is no cap: from the table they come back as well."""
        at = event.location
        assert at is not None
        resting = [self.blocks.names[number] for number in self.resting[at]]
        if self.capped and not self._move_away(index, resting, at, at):
            return False
        self.resting[at].clear()
        self.draft.add(Topple(at, self.blocks.demands.keep[at] + event.subject + 1))
        return True

    def _step_aside(self, index: int, event: Event, block: str, at: str) -> bool:
        """Move a block that rests where it is to be placed off that location, unless it lies in its very place."""
        pile = self.draft.state.piles[at]
        position = pile.index(block)
        if position == self.chains[self.chain_of[event.subject]].height:
            return True
        return self._move_away(index, pile[position:], at, at)

    def _uncover(self, index: int, event: Event, block: str, source: str, target: str) -> bool:
        """Move away what rests on a block and on the place that it goes to; False where there is no room."""
        piles = self.draft.state.piles
        covers = piles[source][piles[source].index(block) + 1 :] if source in piles else []
        if not self._move_away(index, covers, source, target):
            return False
        if event.kind == "aside":
            return True
        height = self.chains[self.chain_of[event.subject]].height + (source == target)
        return self._move_away(index, piles[target][height:], target, source)

    def _move_away(self, index: int, covers: Sequence[str], at: str, other: str) -> bool:
        """Move blocks off a location, the topmost first, to where they are in the way last."""
        for block in reversed(covers):
            free = [location for location in self.instance.locations if location not in (at, other)]
            if not free or block not in self.number:
                return False
            to = max(free, key=lambda location: self._next_use(index, location))
            self._rest_no_more(self.number[block], at)
            self.resting[to].append(self.number[block])
            self.draft.move(block, at, to)
        return True

    def _rest_no_more(self, number: int, at: str) -> None:
        if number in self.resting.get(at, ()):
            self.resting[at].remove(number)

    def _target(self, index: int, event: Event, source: str) -> str | None:
        if event.kind == "aside":
            if event.location is not None:
                return event.location
            until = self.returns.get(event.subject, NEVER)
            return self._resting_place(index, until, source)
        chain = self.chains[self.chain_of[event.subject]]
        if chain.location is None:
            chain.location = self._free_location(index, chain.bottom, source)
            chain.height = len(self.draft.state.piles.get(chain.location or "", ()))
        return chain.location

    def _resting_place(self, index: int, until: int, source: str) -> str | None:
        fits = []
        for order, location in enumerate(self.instance.locations):
            free_until = self._next_use(index, location)
            if location != source and (free_until > until or free_until == until == NEVER):
                stacked = location in self.instance.stacks or bool(self.draft.state.piles[location])
                fits.append((free_until, stacked, order, location))
        if fits:
            return min(fits)[-1]
        others = [location for location in self.instance.locations if location != source]
        return max(others, key=lambda location: self._next_use(index, location), default=None)

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
