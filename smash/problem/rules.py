"""The law: which actions are legal, what they do, when a goal holds, which plans are accepted.

Every other part of the testbed asks this module; nobody else decides what a pick, a place or a topple does.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from smash.problem.errors import IllegalAction
from smash.problem.model import (
    TABLE,
    Action,
    Instance,
    OnGoal,
    Pick,
    Place,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    State,
    Topple,
)


@dataclass(frozen=True, slots=True)
class Verdict:
    """The checker's answer: accepted, or refused with the reason and the 1-based step (None: the plan as a whole)."""

    accepted: bool
    reason: str = ""
    step: int | None = None

    def __str__(self) -> str:
        if self.accepted:
            return "accepted"
        return f"refused: {self.reason}" if self.step is None else f"refused at step {self.step}: {self.reason}"


class Law:
    """The law for one instance under given plan options."""

    def __init__(self, instance: Instance, options: PlanOptions | None = None) -> None:
        self.instance = instance
        self.options = options or PlanOptions()
        self._topple_locations = frozenset(instance.stacks)

    def refusal(self, state: State, action: Action) -> str | None:
        """Return why `action` is illegal in `state`, or None if it is legal."""
        match action:
            case Pick():
                return self._pick_refusal(state, action)
            case Place():
                return self._place_refusal(state, action)
            case Topple():
                return self._topple_refusal(state, action)

    def apply(self, state: State, action: Action) -> None:
        """Carry out `action` on `state`, in place.

        Raises:
            IllegalAction: where the law refuses it; `state` is then unchanged.
        """
        reason = self.refusal(state, action)
        if reason is not None:
            raise IllegalAction(f"{action}: {reason}")
        match action:
            case Pick(block, source):
                if source == TABLE:
                    state.table.remove(block)
                else:
                    state.piles[source].pop()
                state.hand = block
            case Place(block, target):
                state.piles[target].append(block)
                state.hand = None
            case Topple(location, height):
                pile = state.piles[location]
                state.table.update(pile[height - 1 :])
                del pile[height - 1 :]

    def legal_actions(self, state: State) -> Iterator[Action]:
        """Yield every legal action in `state`."""
        if state.hand is not None:
            yield from (Place(state.hand, location) for location in self.instance.locations)
            return
        yield from (Pick(pile[-1], location) for location, pile in state.piles.items() if pile)
        yield from (Pick(block, TABLE) for block in sorted(state.table))
        if not self.options.topple:
            return
        for location in self.instance.stacks:
            height = len(state.piles[location])
            lowest = 1 if self.options.max_topple is None else max(1, height - self.options.max_topple + 1)
            yield from (Topple(location, cut) for cut in range(lowest, height + 1))

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

    def check(self, actions: Iterable[Action]) -> Verdict:
        """Replay `actions` from the start and judge them: every step legal and the goal held at the end."""
        state = State.start_of(self.instance)
        for step, action in enumerate(actions, start=1):
            try:
                self.apply(state, action)
            except IllegalAction as error:
                return Verdict(False, str(error), step)
        shortfall = self.goal_shortfall(state)
        return Verdict(True) if shortfall is None else Verdict(False, f"goal not reached: {shortfall}")

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
        return None if action.target in state.piles else f"no location is called {action.target!r}"

    def _topple_refusal(self, state: State, action: Topple) -> str | None:
        if not self.options.topple:
            return "topple is not allowed"
        if state.hand is not None:
            return f"the hand holds {state.hand!r}"
        if action.location not in self._topple_locations:
            known = action.location in state.piles
            return "buffers are not toppled" if known else f"no location is called {action.location!r}"
        pile = state.piles[action.location]
        if not 1 <= action.height <= len(pile):
            return f"no block falls: the location holds {len(pile)}, heights count from 1"
        falling = len(pile) - action.height + 1
        cap = self.options.max_topple
        return None if cap is None or falling <= cap else f"{falling} blocks fall, max_topple is {cap}"


def _stacks_shortfall(goal: StacksGoal, state: State) -> str | None:
    for location, pile in state.piles.items():
        wanted = goal.stacks.get(location, ())
        if tuple(pile) != tuple(wanted):
            return f"location {location!r} holds {pile}, wanted {list(wanted)}"
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
    for block in goal.bottom:
        if block not in below or below[block] is not None:
            return f"block {block!r} is not at the bottom of a location"
    return None
