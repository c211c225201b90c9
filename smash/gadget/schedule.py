"""When each action of a plan happens on the gadget: steps of pushes, pops and activations, as early as possible."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from smash.gadget.elements import Aggregate, NodeKind
from smash.gadget.graph import Gadget
from smash.gadget.motion import settled
from smash.problem.actions.registry import kind_of
from smash.problem.errors import IllegalAction
from smash.problem.model import TABLE, Action, Aggregating, Instance, Pick, Place, PlanOptions, State
from smash.problem.rules import Law


class Event(NamedTuple):
    """In step `step`, `blocks` (bottom first) enter (`push`) or leave a location by its top, at once."""

    step: int
    blocks: tuple[str, ...]
    push: bool


@dataclass(slots=True)
class Schedule:
    """The steps of a plan's moves.

    Attributes:
        events: per location, in time order.
        tracks: per block the (layer, node) entries of its way outside of the piles, the start included.
        tokens: per token the (layer, node) entries.
        active: the aggregate that is active in a step, by step.
    """

    events: dict[str, list[Event]]
    tracks: dict[str, list[tuple[int, int]]]
    tokens: list[list[tuple[int, int]]]
    active: dict[int, int] = field(default_factory=dict)


class Scheduler:
    """Gives every action of a plan its earliest step on `gadget`.

    Moves that touch different locations and carriers may share a step. A block at height h of the start needs l - h
    steps to rise to v_s^l before it can leave; from then on a location takes one move a step, for its pile floats at
    the top. k blocks that come at once come k - 1 steps later, as the pile sinks before, and leave it k - 1 steps of
    rest. Tokens move one after the other.
    """

    def __init__(self, gadget: Gadget, instance: Instance) -> None:
        self._gadget = gadget
        self._law = Law(instance, PlanOptions())
        self._state = State.start_of(instance)
        self._pebble = {block: number for number, block in enumerate(instance.blocks, start=1)}
        self._free: dict[str, int] = defaultdict(int)
        self._tokens_free = 0
        self._risen = {
            block: gadget.height - height
            for pile in self._state.piles.values()
            for height, block in enumerate(pile, start=1)
        }
        self._exposed = dict.fromkeys(instance.table, 1)
        nodes = settled(gadget, instance.blocks, self._state)
        self._schedule = Schedule(
            events={location: [] for location in instance.locations},
            tracks={block: [(0, node)] for block, node in zip(instance.blocks, nodes, strict=False)},
            tokens=[[(0, node)] for node in nodes[len(instance.blocks) :]],
        )

    def run(self, actions: Sequence[Action]) -> Schedule:
        """Schedule the whole plan.

        Raises:
            IllegalAction: where the law refuses an action, the gadget has no part for it, or the hand is not empty at
                the end.
        """
        taken: Pick | None = None
        for action in actions:
            if isinstance(action, Aggregating):
                self._aggregating(action)
                continue
            self._law.apply(self._state, action)
            if isinstance(action, Place):
                assert taken is not None
                self._transfer(action.block, taken.source, action.target)
            else:
                taken = action
        if self._state.hand is not None:
            raise IllegalAction(f"the plan ends with {self._state.hand!r} in the hand")
        return self._schedule

    def _transfer(self, block: str, source: str, target: str) -> None:
        """Schedule a pick and a place; a block that is put back where it was moves nowhere."""
        if source == target:
            return
        ready = self._exposed.pop(block) if source == TABLE else max(self._free[source], self._risen.pop(block, 0))
        step = max(ready, self._free[target])
        if source == TABLE:
            self._enter(block, step, self._gadget.node(NodeKind.INTERFACE, index=self._pebble[block]))
        elif source in self._state.piles:
            self._schedule.events[source].append(Event(step, (block,), push=False))
        if target in self._state.piles:
            self._schedule.events[target].append(Event(step, (block,), push=True))
        else:
            self._enter(block, step + 1, self._carrier_node(target))
        self._free[source] = self._free[target] = step + 1

    def _carrier_node(self, carrier: str) -> int:
        token = next(token for token in self._gadget.tokens if token.name == carrier)
        return token.nodes[self._state.stations[carrier]]

    def _enter(self, block: str, layer: int, node: int) -> None:
        self._schedule.tracks[block].append((layer, node))

    def _aggregating(self, action: Aggregating) -> None:
        reason = self._law.refusal(self._state, action)
        if reason is not None:
            raise IllegalAction(f"{action}: {reason}")
        parts = self._gadget.parts
        name = kind_of(action).name
        at = parts[name].at(action, self._state) if name in parts else None
        if at is None:
            raise IllegalAction(f"{action}: the gadget has no part for it")
        number = self._gadget.aggregate(name, at)
        aggregate = self._gadget.aggregates[number]
        blocks = kind_of(action).gathered(self._state, action)
        self._law.carry_out(self._state, action)
        if aggregate.in_place:
            step = self._move_in_place(aggregate, blocks)
        elif aggregate.locks is not None:
            step = self._stage(aggregate, aggregate.locks, blocks)
        else:
            step = self._empty(aggregate, blocks)
        self._schedule.active[step] = number

    def _idle(self, step: int) -> int:
        """Return the first step from `step` on in which nothing is active."""
        while step in self._schedule.active:
            step += 1
        return step

    def _stage(self, aggregate: Aggregate, location: str, blocks: Sequence[str]) -> int:
        """Stage the blocks of a location one by one, topmost first, then activate."""
        assert aggregate.gather is not None
        for block in blocks:
            step = max(self._free[location], self._risen.pop(block, 0))
            self._schedule.events[location].append(Event(step, (block,), push=False))
            self._free[location] = step + 1
            self._enter(block, step + 1, aggregate.gather)
        step = self._idle(self._free[location])
        self._free[location] = step + 1
        self._arrive(blocks, step + 1, self._gadget.edges[aggregate.edges[0]].head)
        return step

    def _empty(self, aggregate: Aggregate, blocks: Sequence[str]) -> int:
        """Move the blocks at a token's node, and the token where the action takes it along."""
        step = self._idle(max(self._tokens_free, *(self._free[name] for name in aggregate.touches)))
        head = self._gadget.edges[aggregate.edges[0]].head
        self._arrive(blocks, step + 1, head)
        if aggregate.token is not None:
            self._schedule.tokens[aggregate.token].append((step + 1, head))
            self._tokens_free = step + 1
        self._free.update(dict.fromkeys(aggregate.touches, step + 1))
        return step

    def _arrive(self, blocks: Sequence[str], layer: int, node: int) -> None:
        """Let blocks be at a node from a layer on; those on the table can be picked a step later."""
        for block in blocks:
            self._enter(block, layer, node)
            if self._gadget.nodes[node].kind is NodeKind.TABLE:
                self._exposed[block] = layer + 1

    def _move_in_place(self, aggregate: Aggregate, blocks: Sequence[str]) -> int:
        """Move the top of a pile (topmost block first) onto another one."""
        source, target = aggregate.at
        risen = (self._risen.pop(block, 0) - depth for depth, block in enumerate(blocks))
        size = len(blocks)
        step = self._idle(max(self._free[source], self._free[target] + size - 1, *risen))
        upward = tuple(reversed(blocks))
        self._schedule.events[source].append(Event(step, upward, push=False))
        self._schedule.events[target].append(Event(step, upward, push=True))
        self._free[source], self._free[target] = step + size, step + 1
        return step
