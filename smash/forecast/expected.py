"""The forecast of a plan: its expected seconds and its risk, action by action along the law's states."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import atan2, cos, hypot, sin

from smash.forecast.durations import Point, features, in_order, seconds
from smash.forecast.model import OutcomeModel, Spot
from smash.problem.actions.topple import Topple
from smash.problem.errors import Unsupported
from smash.problem.model import TABLE, Action, Aggregating, Pick, Place, State
from smash.problem.problem import Problem
from smash.problem.words import counted

INTO_OTHERS = 1.0
"""Risk of a topple among blocks that still lie from an earlier one of the same pile: it rams them, and no trial tells
how they come to rest."""
BESIDE = 1.5
"""A block whose middle is nearer to a pile's than this many sides leaves the fingers little room."""


@dataclass(frozen=True, slots=True)
class Expected:
    """What is expected of an action, or of a plan.

    Attributes:
        seconds: of its execution, trouble included.
        risk: expected number of actions that do not go as planned.
    """

    seconds: float
    risk: float


@dataclass(frozen=True, slots=True)
class Lying:
    """A block in the table region, as far as it can be foreseen.

    Attributes:
        at: where it lies on average.
        blocked: how probably another block of the same topple is in the way of its grasp at first.
        companions: the other blocks of that topple.
        beside: how probably it lies at the foot of the pile at a location.
        fallen_from: the location that it was toppled from.
    """

    at: Point
    blocked: float = 0.0
    companions: frozenset[str] = frozenset()
    beside: Mapping[str, float] = field(default_factory=dict)
    fallen_from: str | None = None


@dataclass(frozen=True, slots=True)
class Fall:
    """What is expected of a topple of so many blocks at a location: its own time and risk, and where each block lands.

    Attributes:
        seconds: from the ready pose.
        risk: how probably the rest of the pile does not stand as it should, or no push is found.
        landed: from the cut upward.
    """

    seconds: float
    risk: float
    landed: tuple[Lying, ...]


class Walk:
    """A forecast under way: the law's state, where the hand is, where toppled blocks lie.

    Attributes:
        state: the law's.
        hand: where the hand was last.
        first: whether the arm is still at its ready pose.
        lying: what is foreseen of the blocks in the table region.
    """

    __slots__ = ("first", "hand", "lying", "state")

    def __init__(self, state: State, hand: Point, first: bool, lying: dict[str, Lying]) -> None:
        self.state = state
        self.hand = hand
        self.first = first
        self.lying = lying

    def copy(self) -> Walk:
        """Return an independent copy."""
        return Walk(self.state.copy(), self.hand, self.first, dict(self.lying))


class Forecaster:
    """Forecasts plans of one problem in one scene.

    Args:
        problem: what is planned.
        model: of the scene.

    Raises:
        Unsupported: where the model does not know an action that plans may use, or has no room for the instance.
    """

    def __init__(self, problem: Problem, model: OutcomeModel) -> None:
        unknown = [kind.name for kind in problem.kinds if kind.name != "topple"]
        if unknown or problem.instance.carriers:
            what = " and ".join(unknown) or "carriers"
            leave_out = "".join(f" --without {name}" for name in unknown)
            raise Unsupported(
                f"expected times and risk: the outcome model has no times for {what}"
                + (f"; plan{leave_out}" if unknown and not problem.instance.carriers else "")
            )
        self.problem = problem
        self.law = problem.law
        self.model = model
        self.spots = model.bind(problem.instance)
        self.weights = in_order(model.moves.weights)
        self._falls: dict[tuple[str, int, int], Fall] = {}
        self._moves: dict[tuple[str, Point, Point, bool, bool], float] = {}

    def begin(self) -> Walk:
        """Return a walk at the start."""
        somewhere = {block: Lying(self._region()) for block in self.problem.instance.table}
        return Walk(State.start_of(self.problem.instance), self.begin_point(), True, somewhere)

    def of(self, actions: Sequence[Action]) -> Expected:
        """Forecast a legal plan."""
        walk = self.begin()
        total = risk = 0.0
        for action in actions:
            expected = self.step(walk, action)
            total += expected.seconds
            risk += expected.risk
        return Expected(total, risk)

    def misfit(self, actions: Sequence[Action]) -> str | None:
        """Return what of a legal plan the scene has no room for; None where it can be carried out there."""
        state = State.start_of(self.problem.instance)
        for action in actions:
            if (reason := self.no_room(state, action)) is not None:
                return reason
            self.law.carry_out(state, action)
        return None

    def no_room(self, state: State, action: Action) -> str | None:
        """Return why the scene has no room for a legal action, or None.

        A stack without a topple direction is not toppled, a strip takes so many blocks, and a place a pile so high.

        Args:
            state: where it is done.
            action: the action.
        """
        match action:
            case Place(_, location):
                spot, count = self.spots[location], len(state.piles[location]) + 1
                room = self.model.highest if spot.highest is None else min(self.model.highest, spot.highest)
                if count > room:
                    return f"a pile of {count} at {location!r}; scene {self.model.scene!r} has room for {room}"
            case Topple(location, height):
                spot, falling = self.spots[location], len(state.piles[location]) - height + 1
                if not spot.headings:
                    return f"a topple at {location!r}; scene {self.model.scene!r} has no strip there"
                if spot.falling is not None and falling > spot.falling:
                    strip = f"scene {self.model.scene!r} has a strip for {spot.falling} there"
                    return f"a topple of {counted(falling, 'block')} at {location!r}; {strip}"
            case _:
                pass
        return None

    def steps(self, actions: Sequence[Action]) -> Iterator[Expected]:
        """Forecast a legal plan action by action."""
        walk = self.begin()
        for action in actions:
            yield self.step(walk, action)

    def step(self, walk: Walk, action: Action) -> Expected:
        """Forecast a legal action, and move the walk on by it."""
        before, target = walk.state, walk.hand
        risk, taken = 0.0, 0.0
        match action:
            case Pick(block, source):
                target = self.grasp(walk, block, source)
                risk = self.model.stuck * self.danger(walk, block) if source == TABLE else 0.0
                taken = self._moved("pick", walk, target, source == TABLE)
                walk.lying.pop(block, None)
            case Place(_, location):
                target = self._above(location, len(before.piles[location]) + 0.5)
                taken = self._moved("place", walk, target, False)
            case Topple(location, height):
                fallen = before.piles[location][height - 1 :]
                fall = self.fall(location, height, len(fallen))
                target = self._above(location, height)
                taken = fall.seconds + self._detour(walk, target)
                among = any(lying.fallen_from == location for lying in walk.lying.values())
                risk = INTO_OTHERS if among else fall.risk
                for block, lying in zip(fallen, fall.landed, strict=True):
                    companions = frozenset(fallen).difference((block,))
                    walk.lying[block] = Lying(lying.at, lying.blocked, companions, lying.beside, location)
            case Aggregating():
                raise Unsupported(f"{action}: the outcome model has no times for it")
        self.law.carry_out(before, action)
        walk.hand, walk.first = target, False
        return Expected(taken + risk * self.model.trouble, risk)

    def begin_point(self) -> Point:
        """Return where the hand is before the first action."""
        return Point(self.model.ready.radius, self.model.ready.bearing, self.model.ready_height)

    def grasp(self, walk: Walk, block: str, source: str) -> Point:
        """Return where a block is grasped, as far as it can be foreseen."""
        if source == TABLE:
            known = walk.lying.get(block)
            return self._region() if known is None else known.at
        return self._above(source, len(walk.state.piles[source]) - 0.5)

    def danger(self, walk: Walk, block: str) -> float:
        """Return how probably a block of the table region has a neighbour or a pile so near that it may be stuck."""
        known = walk.lying.get(block)
        if known is None:
            return 0.0
        left = sum(other in walk.state.table for other in known.companions)
        danger = known.blocked * left / len(known.companions) if known.companions else known.blocked
        for location, share in known.beside.items():
            if walk.state.piles[location]:
                danger = max(danger, share)
        return danger

    def fall(self, location: str, height: int, falling: int) -> Fall:
        """Return what is expected of a topple at a location."""
        known = self._falls.get((location, height, falling))
        if known is None:
            known = self._falls[location, height, falling] = self._fall(location, height, falling)
        return known

    def _fall(self, location: str, height: int, falling: int) -> Fall:
        tried = self.model.trials(height, falling)
        trials = [trial for trial in tried if trial.landed]
        spot = self.spots[location]
        if not trials or not spot.headings:
            return Fall(0.0, 1.0, (Lying(self._region()),) * falling)
        landed = []
        for level in range(falling):
            seen = [trial.landed[min(level, len(trial.landed) - 1)] for trial in trials]
            points = [_point(spot, block.along, block.aside) for block in seen]
            x, y = (sum(values) / len(points) for values in zip(*points, strict=True))
            near = {
                name: sum(hypot(px - qx, py - qy) < BESIDE * self.model.side for px, py in points) / len(points)
                for name, (qx, qy) in ((name, _middle(other)) for name, other in self.spots.items())
            }
            landed.append(
                Lying(
                    Point(hypot(x, y), atan2(y, x), self.model.side / 2),
                    sum(not block.graspable for block in seen) / len(seen),
                    beside={name: share for name, share in near.items() if share},
                )
            )
        return Fall(
            sum(trial.seconds for trial in trials) / len(trials),
            sum(not trial.stands for trial in tried) / len(tried),
            tuple(landed),
        )

    def _moved(self, kind: str, walk: Walk, target: Point, lying: bool) -> float:
        move = (kind, walk.hand, target, lying, walk.first)
        known = self._moves.get(move)
        if known is None:
            known = self._moves[move] = seconds(self.weights, features(*move))
        return known

    def _detour(self, walk: Walk, target: Point) -> float:
        """Return how much longer than from the ready pose the way to a topple is [s], as it is for a pick there."""
        if walk.first:
            return 0.0
        ready = self.begin_point()
        there = seconds(self.weights, features("pick", ready, target, False, True))
        return self._moved("pick", walk, target, False) - there

    def _above(self, location: str, height: float) -> Point:
        """Return the point so many sides above the table at a location."""
        spot = self.spots[location]
        return Point(spot.radius, spot.bearing, height * self.model.side)

    def _region(self) -> Point:
        """Return a middle of the table region, for blocks of which nothing is known: before the first stack."""
        spot = self.model.stacks[0]
        return Point(spot.radius, spot.bearing, self.model.side / 2)


def _middle(spot: Spot) -> tuple[float, float]:
    return spot.radius * cos(spot.bearing), spot.radius * sin(spot.bearing)


def _point(spot: Spot, along: float, aside: float) -> tuple[float, float]:
    """Return the world point of a landing, for the preferred topple direction of a place."""
    (x, y), heading = _middle(spot), spot.headings[0]
    return x + along * cos(heading) - aside * sin(heading), y + along * sin(heading) + aside * cos(heading)
