"""The plan of least risk among those of a given cost: at no cost in actions, fewer surprises.

States are expanded by cost. A state here is the law's and what is foreseen of the blocks in the table region, which is
what risk depends on; of two ways to one the less risky is kept, so that what reaches the goal is the least there is.
No state is left out but those from which a block-by-block bound shows that the cost does not suffice.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from time import monotonic

from smash.forecast.expected import Forecaster, Walk
from smash.problem.actions.topple import Topple
from smash.problem.model import Action, OnGoal, Pick, Place, PositionsGoal, StacksGoal, State, no_goal

MOST_STATES = 60_000
"""States that are expanded at most."""
MOVE = 2
"""A pick and its place."""


@dataclass(frozen=True, slots=True)
class LeastRisk:
    """The plan of least risk, and its risk; `exact` says whether all plans of its cost were looked at."""

    actions: tuple[Action, ...]
    risk: float
    exact: bool


@dataclass(slots=True)
class _Node:
    """A state that was reached: how, from which node, at which risk."""

    walk: Walk
    risk: float
    before: _Node | None
    by: tuple[Action, ...]


def least_risk(
    forecaster: Forecaster,
    plan: tuple[Action, ...],
    until: float,
    stopped: Callable[[], bool] = lambda: False,
) -> LeastRisk:
    """Return the plan of least risk among those that have as many actions as an optimal one.

    Args:
        forecaster: of a plain problem, whose hand is empty at the start.
        plan: an optimal plan; where the scene has no room for it, any other one is better.
        until: when to give up, by the monotonic clock [s].
        stopped: whether to give up at once.
    """
    fits = forecaster.misfit(plan) is None
    known = LeastRisk(plan, forecaster.of(plan).risk, True)
    if fits and known.risk <= 0.0:
        return known
    search = _Layers(forecaster, len(plan))
    while search.left and not search.spent:
        if stopped() or monotonic() > until:
            break
        search.expand()
    found = search.best
    exact = not search.left
    if found is None or (fits and found.risk >= known.risk):
        return LeastRisk(known.actions, known.risk, exact)
    return LeastRisk(_way(found), found.risk, exact)


class _Layers:
    """States by cost, those of each cost expanded before those of the next.

    Attributes:
        best: of the states that fulfil the goal the least risky.
    """

    def __init__(self, forecaster: Forecaster, cost: int) -> None:
        self._forecaster = forecaster
        self._law = forecaster.law
        self._cost = cost
        self._misplaced = misplaced(forecaster)
        self._alike = alike_buffers(forecaster) and not near_buffers(forecaster)
        begin = forecaster.begin()
        self._layers: list[dict[Hashable, _Node]] = [{} for _ in range(cost + 1)]
        self._layers[0][_key(begin)] = _Node(begin, 0.0, None, ())
        self._at = 0
        self._expanded = 0
        self.best: _Node | None = None

    @property
    def left(self) -> bool:
        """Whether a state waits to be expanded."""
        while self._at < self._cost and not self._layers[self._at]:
            self._at += 1
        return bool(self._layers[self._at])

    @property
    def spent(self) -> bool:
        """Whether too many states were expanded."""
        return self._expanded >= MOST_STATES

    def expand(self) -> None:
        """Expand one state of the least cost."""
        _, node = self._layers[self._at].popitem()
        self._expanded += 1
        if self._law.goal_shortfall(node.walk.state) is None:
            if self.best is None or node.risk < self.best.risk:
                self.best = node
            return
        if self.best is not None and node.risk >= self.best.risk:
            return
        for actions in self._moves(node.walk.state):
            cost = self._at + len(actions)
            if cost > self._cost:
                continue
            walk, risk, fits = node.walk.copy(), node.risk, True
            for action in actions:
                fits = fits and self._forecaster.no_room(walk.state, action) is None
                risk += self._forecaster.step(walk, action).risk
            if not fits or cost + MOVE * self._misplaced(walk.state) > self._cost:
                continue
            layer, key = self._layers[cost], _key(walk)
            other = layer.get(key)
            if other is None or risk < other.risk:
                layer[key] = _Node(walk, risk, node, actions)

    def _moves(self, state: State) -> Iterator[tuple[Action, ...]]:
        for action in self._law.legal_actions(state):
            if isinstance(action, Topple):
                yield (action,)
            elif isinstance(action, Pick):
                yield from ((action, Place(action.block, target)) for target in self._targets(state, action.source))

    def _targets(self, state: State, source: str) -> Iterator[str]:
        """Yield where a block may go; of the empty buffers one, where they differ in nothing that risk depends on."""
        instance = self._forecaster.problem.instance
        yield from (location for location in instance.stacks if location != source)
        empty = 0
        for location in instance.buffers:
            empty += not state.piles[location]
            if location != source and (state.piles[location] or empty == 1 or not self._alike):
                yield location


def alike_buffers(forecaster: Forecaster) -> bool:
    """Return whether every buffer takes a pile as high as every other one."""
    spots = forecaster.spots
    return len({spots[buffer].highest for buffer in forecaster.problem.instance.buffers}) <= 1


def near_buffers(forecaster: Forecaster) -> bool:
    """Return whether a toppled block may come to lie at the foot of a pile on a buffer."""
    instance = forecaster.problem.instance
    most = len(instance.blocks)
    buffers = set(instance.buffers)
    return any(
        not buffers.isdisjoint(lying.beside)
        for location in instance.stacks
        for height in range(1, most + 1)
        for falling in range(1, most - height + 2)
        for lying in forecaster.fall(location, height, falling).landed
    )


def misplaced(forecaster: Forecaster) -> Callable[[State], int]:
    """Return what counts the blocks that have to be placed yet: never more than any plan places."""
    goal = forecaster.problem.instance.goal
    match goal:
        case StacksGoal() | PositionsGoal():
            wanted: Mapping[str, tuple[str, ...]] = goal.stacks if isinstance(goal, StacksGoal) else goal.stacks()
            return lambda state: _wrong(wanted, state)
        case OnGoal():
            under = dict(goal.on)
            return lambda state: _unsupported(under, state)
        case _:
            no_goal(goal)


def _wrong(wanted: Mapping[str, tuple[str, ...]], state: State) -> int:
    missing = 0
    for location, tower in wanted.items():
        right = 0
        for block, here in zip(tower, state.piles[location], strict=False):
            if block != here:
                break
            right += 1
        missing += len(tower) - right
    return missing


def _unsupported(under: Mapping[str, str], state: State) -> int:
    missing = len(under)
    for pile in state.piles.values():
        missing -= sum(under.get(upper) == lower for lower, upper in pairwise(pile))
    return missing


def _key(walk: Walk) -> Hashable:
    """Return what the rest of a plan, and its risk, depend on."""
    state = walk.state
    piles = tuple((location, tuple(pile)) for location, pile in state.piles.items() if pile)
    lying = frozenset(
        (block, known.at, known.companions & state.table, len(known.companions)) for block, known in walk.lying.items()
    )
    return piles, lying


def _way(node: _Node) -> tuple[Action, ...]:
    parts = []
    at: _Node | None = node
    while at is not None:
        parts.append(at.by)
        at = at.before
    return tuple(action for part in reversed(parts) for action in part)
