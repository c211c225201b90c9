"""When each action of a plan happens on the gadget: steps of pushes, pops and activations, as early as possible."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from smash.gadget.graph import Gadget
from smash.problem.errors import IllegalAction
from smash.problem.model import TABLE, Action, Instance, Pick, Place, PlanOptions, State
from smash.problem.rules import Law


class Event(NamedTuple):
    """In step `step`, `block` enters (`push`) or leaves a location by its top."""

    step: int
    block: str
    push: bool


class TableVisit(NamedTuple):
    """A block's way through the table region, in steps.

    It is staged in step `staged` and comes down in step `toppled` (both None where it starts on the table), and
    is picked in step `picked` (None: it stays).
    """

    location: str | None
    staged: int | None
    toppled: int | None
    picked: int | None


@dataclass(slots=True)
class Schedule:
    """The steps of a plan's moves: events per location in time order, and each block's visits to the table."""

    events: dict[str, list[Event]]
    visits: dict[str, list[TableVisit]] = field(default_factory=dict)


class Scheduler:
    """Gives every action of a plan its earliest step on `gadget`.

    Moves that touch different locations may share a step. A block at height h of the start needs l - h steps to
    rise to v_s^l before it can leave; from then on a location takes one move a step, for its pile floats at the top.
    """

    def __init__(self, gadget: Gadget, instance: Instance) -> None:
        self._gadget = gadget
        self._law = Law(instance, PlanOptions())
        self._state = State.start_of(instance)
        self._free = dict.fromkeys(instance.locations, 0)
        self._risen = {
            block: gadget.height - height
            for pile in self._state.piles.values()
            for height, block in enumerate(pile, start=1)
        }
        self._on_table: dict[str, TableVisit] = {block: TableVisit(None, None, None, None) for block in instance.table}
        self._activated: set[int] = set()
        self._schedule = Schedule({location: [] for location in instance.locations})

    def run(self, actions: Sequence[Action]) -> Schedule:
        """Schedule the whole plan.

        Raises:
            IllegalAction: where the law refuses an action, or the hand is not empty at the end.
        """
        taken: Pick | None = None
        for action in actions:
            if isinstance(action, Pick):
                self._law.apply(self._state, action)
                taken = action
            elif isinstance(action, Place):
                self._law.apply(self._state, action)
                assert taken is not None
                self._transfer(action.block, taken.source, action.target)
            else:
                self._aggregate(action)
        if self._state.hand is not None:
            raise IllegalAction(f"the plan ends with {self._state.hand!r} in the hand")
        for block, visit in self._on_table.items():
            self._schedule.visits.setdefault(block, []).append(visit)
        return self._schedule

    def _transfer(self, block: str, source: str, target: str) -> None:
        if source == target:
            return
        if source == TABLE:
            visit = self._on_table.pop(block)
            exposed = 0 if visit.toppled is None else visit.toppled + 1
            step = max(self._free[target], exposed + 1)
            self._schedule.visits.setdefault(block, []).append(visit._replace(picked=step))
        else:
            step = max(self._free[source], self._free[target], self._risen.pop(block, 0))
            self._record(source, Event(step, block, push=False))
        self._record(target, Event(step, block, push=True))

    def _aggregate(self, action: Action) -> None:
        answers = (part.gathered(action, self._state) for part in self._gadget.parts.values())
        gathered = next((answer for answer in answers if answer is not None), None)
        self._law.apply(self._state, action)
        if gathered is None:
            raise IllegalAction(f"{action}: the gadget has no part for it")
        location, blocks = gathered
        staged: dict[str, int] = {}
        for block in blocks:
            staged[block] = max(self._free[location], self._risen.pop(block, 0))
            self._record(location, Event(staged[block], block, push=False))
        step = self._free[location]
        while step in self._activated:
            step += 1
        self._activated.add(step)
        self._free[location] = step + 1
        for block in blocks:
            self._on_table[block] = TableVisit(location, staged[block], step, None)

    def _record(self, location: str, event: Event) -> None:
        self._schedule.events[location].append(event)
        self._free[location] = event.step + 1
