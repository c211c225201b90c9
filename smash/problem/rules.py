"""The law: which actions are legal, what they do, when a goal holds, which plans are accepted.

Every other part of the testbed asks this module; nobody else decides what a pick, a place or a topple does.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from smash.problem.actions.kind import AggregatingKind
from smash.problem.actions.registry import kind_of, kinds_of
from smash.problem.errors import IllegalAction
from smash.problem.model import (
    TABLE,
    Action,
    Aggregating,
    Instance,
    OnGoal,
    Pick,
    Place,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    State,
    no_goal,
)


@dataclass(frozen=True, slots=True)
class Verdict:
    """The checker's answer: accepted, or refused with the reason and the 1-based step (None: the plan as a whole).

    `cost` is the plan's cost where every step is legal.
    """

    accepted: bool
    reason: str = ""
    step: int | None = None
    cost: int | None = field(default=None, compare=False)

    def __str__(self) -> str:
        if self.accepted:
            return "accepted"
        return f"refused: {self.reason}" if self.step is None else f"refused at step {self.step}: {self.reason}"


class Law:
    """The law for one instance under given plan options.

    Attributes:
        instance: the instance.
        options: what a plan may use.
        kinds: the kinds of aggregating actions that it may use, in the order of the registry.
    """

    def __init__(
        self,
        instance: Instance,
        options: PlanOptions | None = None,
        kinds: tuple[AggregatingKind[Any], ...] | None = None,
    ) -> None:
        """Make the law.

        Args:
            instance: the instance.
            options: what a plan may use; everything, where None.
            kinds: the kinds of aggregating actions, where they are known already.
        """
        self.instance = instance
        self.options = options or PlanOptions()
        self._room = {carrier.name: carrier.capacity for carrier in instance.carriers}
        self.kinds = tuple(kinds_of(instance, self.options)) if kinds is None else kinds
        self._carries = any(kind.name == "carry" for kind in self.kinds)

    def refusal(self, state: State, action: Action) -> str | None:
        """Return why `action` is illegal in `state`, or None if it is legal."""
        match action:
            case Pick():
                return self._pick_refusal(state, action)
            case Place():
                return self._place_refusal(state, action)
            case Aggregating():
                return self._aggregating_refusal(state, action)

    def cost(self, state: State, action: Action) -> int:
        """Return what a legal `action` costs in `state`, the state before it."""
        costs = self.instance.costs
        match action:
            case Pick():
                return costs.of("pick")
            case Place(_, target):
                way = None if state.origin is None else (state.origin, state.place_of(target))
                return costs.of("place") + (costs.distance(*way) if way else 0)
            case Aggregating():
                kind = kind_of(action)
                way = kind.way(state, action)
                return costs.of(kind.name) + (costs.distance(*way) if way else 0)

    def apply(self, state: State, action: Action) -> None:
        """Carry out `action` on `state`, in place.

        Raises:
            IllegalAction: where the law refuses it; `state` is then unchanged.
        """
        reason = self.refusal(state, action)
        if reason is not None:
            raise IllegalAction(f"{action}: {reason}")
        self.carry_out(state, action)

    def carry_out(self, state: State, action: Action) -> None:
        """Carry out a legal `action` on `state`, in place; it is not asked whether it is legal."""
        match action:
            case Pick():
                block, source = action.block, action.source
                if source in state.piles:
                    state.piles[source].pop()
                else:
                    (state.table if source == TABLE else state.carried[source]).remove(block)
                state.hand = block
                state.origin = state.place_of(source) if self.instance.costs.travel else None
            case Place():
                if action.target in state.piles:
                    state.piles[action.target].append(action.block)
                else:
                    state.carried[action.target].add(action.block)
                state.hand = state.origin = None
            case Aggregating():
                kind_of(action).apply(state, action)

    def legal_actions(self, state: State) -> Iterator[Action]:
        """Yield every legal action in `state`."""
        if state.hand is not None:
            yield from (Place(state.hand, location) for location in self.instance.locations)
            yield from (Place(state.hand, carrier) for carrier in self.open_carriers(state))
            return
        yield from (Pick(pile[-1], location) for location, pile in state.piles.items() if pile)
        yield from (Pick(block, TABLE) for block in sorted(state.table))
        yield from (Pick(block, name) for name, blocks in state.carried.items() for block in sorted(blocks))
        for kind in self.kinds:
            yield from kind.legal(self.instance, self.options, state)

    def open_carriers(self, state: State) -> Iterator[str]:
        """Yield the carriers on which a block can be placed in `state`."""
        yield from (carrier for carrier in state.carried if self._carrier_refusal(state, carrier) is None)

    def goal_shortfall(self, state: State) -> str | None:
        """Return what `state` lacks for the goal, in words, or None where the goal holds."""
        if state.hand is not None:
            return f"the hand still holds {state.hand!r}"
        match self.instance.goal:
            case StacksGoal() as goal:
                return _stacks_shortfall(goal, state)
            case PositionsGoal() as goal:
                return _positions_shortfall(goal, state)
            case OnGoal() as goal:
                return _on_shortfall(goal, state)
            case _:
                no_goal(self.instance.goal)

    def check(self, actions: Iterable[Action]) -> Verdict:
        """Replay `actions` from the start and judge them: every step legal and the goal held at the end."""
        state = State.start_of(self.instance)
        total = 0
        plain = self.instance.costs.plain
        for step, action in enumerate(actions, start=1):
            reason = self.refusal(state, action)
            if reason is not None:
                return Verdict(False, f"{action}: {reason}", step)
            total += 1 if plain else self.cost(state, action)
            self.carry_out(state, action)
        shortfall = self.goal_shortfall(state)
        return Verdict(shortfall is None, f"goal not reached: {shortfall}" if shortfall else "", cost=total)

    def price(self, actions: Sequence[Action]) -> int:
        """Return the cost of legal actions from the start on.

        Raises:
            IllegalAction: at the first action that the law refuses.
        """
        if self.instance.costs.plain:
            return len(actions)
        state = State.start_of(self.instance)
        total = 0
        for action in actions:
            reason = self.refusal(state, action)
            if reason is not None:
                raise IllegalAction(f"{action}: {reason}")
            total += self.cost(state, action)
            self.carry_out(state, action)
        return total

    def states(self, actions: Sequence[Action]) -> Iterator[State]:
        """Yield an independent copy of the start state and of the state after each action.

        Raises:
            IllegalAction: at the first action that the law refuses.
        """
        state = State.start_of(self.instance)
        yield state.copy()
        for action in actions:
            self.apply(state, action)
            yield state.copy()

    def _pick_refusal(self, state: State, action: Pick) -> str | None:
        if state.hand is not None:
            return f"the hand holds {state.hand!r}"
        if action.source == TABLE:
            return None if action.block in state.table else "the block is not in the table region"
        if action.source in state.carried:
            return None if action.block in state.carried[action.source] else f"the block is not on {action.source!r}"
        pile = state.piles.get(action.source)
        if pile is None:
            return f"no location is called {action.source!r}"
        if not pile:
            return f"location {action.source!r} is empty"
        return None if pile[-1] == action.block else f"the top of {action.source!r} is {pile[-1]!r}"

    def _place_refusal(self, state: State, action: Place) -> str | None:
        if state.hand != action.block:
            held = "is empty" if state.hand is None else f"holds {state.hand!r}"
            return f"the hand {held}"
        if action.target == TABLE:
            return "nothing is placed in the table region"
        if action.target in state.carried:
            return self._carrier_refusal(state, action.target)
        return None if action.target in state.piles else f"no location is called {action.target!r}"

    def _carrier_refusal(self, state: State, carrier: str) -> str | None:
        if not self._carries:
            return "carry is not allowed, hence nothing is placed on a carrier"
        room = self._room[carrier]
        return None if len(state.carried[carrier]) < room else f"{carrier!r} is full: it holds {room}"

    def _aggregating_refusal(self, state: State, action: Aggregating) -> str | None:
        kind = kind_of(action)
        if not self.options.allows(kind.name):
            return f"{kind.name} is not allowed"
        if kind not in self.kinds:
            return f"the instance has no {kind.name}"
        if state.hand is not None:
            return f"the hand holds {state.hand!r}"
        return kind.refusal(self.instance, self.options, state, action)


def _stacks_shortfall(goal: StacksGoal, state: State) -> str | None:
    for location, pile in state.piles.items():
        wanted = goal.stacks.get(location, ())
        if tuple(pile) != tuple(wanted):
            return f"location {location!r} holds {pile}, wanted {list(wanted)}"
    for carrier, blocks in state.carried.items():
        if blocks:
            return f"carrier {carrier!r} holds {sorted(blocks)}"
    return f"the table region holds {sorted(state.table)}" if state.table else None


def _positions_shortfall(goal: PositionsGoal, state: State) -> str | None:
    for block, (location, height) in goal.positions.items():
        pile = state.piles[location]
        if len(pile) < height or pile[height - 1] != block:
            return f"block {block!r} is not at height {height} of {location!r}"
    return None


def _on_shortfall(goal: OnGoal, state: State) -> str | None:
    below: dict[str, str | None] = {}
    for pile in state.piles.values():
        for position, block in enumerate(pile):
            below[block] = pile[position - 1] if position else None
    for upper, under in goal.on.items():
        if below.get(upper) != under:
            return f"block {upper!r} is not on {under!r}"
    at_bottom = {block for block, under in below.items() if under is None}
    for block in goal.bottom:
        if block not in at_bottom:
            return f"block {block!r} is not at the bottom of a location"
    for block in goal.ontable:
        if block not in at_bottom and block not in state.table:
            return f"block {block!r} is neither at the bottom of a location nor in the table region"
    above = {under: upper for upper, under in below.items()}
    covered = next((block for block in goal.clear if block in above), None)
    return None if covered is None else f"block {covered!r} is not clear, {above[covered]!r} lies on it"
