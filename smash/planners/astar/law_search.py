"""A* over the law's own states: any aggregating action, any costs, every goal.

A pick and the place after it are one step of the search. What a kind of aggregating action does is asked of the law
alone, so that a new kind is searched without a line here. Successors are made when they are taken from the queue;
until then a step and its bound stand for them.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass
from time import perf_counter
from typing import Literal

from smash.problem.model import TABLE, Action, Instance, Pick, Place, State
from smash.problem.rules import Law
from smash.problem.views.distances import Estimate

SLACK = 1e-6
"""Rounding of the sums of shared costs."""
MOST_OPEN = 6_000_000
"""Steps that may wait in the queue: about 2 GB."""


@dataclass(slots=True)
class _Node:
    """A state that was reached: from which one, by which actions, at what cost; `moved`: the block of a transfer."""

    state: State
    cost: int
    parent: _Node | None
    actions: tuple[Action, ...]
    moved: str | None

    def plan(self) -> tuple[Action, ...]:
        steps: list[tuple[Action, ...]] = []
        node: _Node | None = self
        while node is not None:
            steps.append(node.actions)
            node = node.parent
        return tuple(action for step in reversed(steps) for action in step)


class LawSearch:
    """One search. `run` goes on until a plan is found, nothing cheaper is left, or the time is over.

    Attributes:
        bound: no plan costs less (where `weight` is 1).
        ended: why it ended for good: `exhausted` (nothing is cheaper than `below`) or `memory`.
    """

    def __init__(self, law: Law, *, weight: float = 1.0, below: float = math.inf) -> None:
        self.law = law
        self.instance = law.instance
        self.estimate = Estimate(law)
        self.weight = weight
        self.below = below
        self.expanded = 0
        self.ended: Literal["exhausted", "memory"] | None = None
        start = State.start_of(self.instance)
        first = self.estimate.of(start)
        self.bound = math.ceil(first - SLACK) if first < math.inf else 0
        self._alike = _interchangeable(self.instance)
        self._closed: dict[Hashable, int] = {}
        self._ties = itertools.count()
        self._open: list[tuple[float, float, int, int, _Node | None, tuple[Action, ...], str | None]] = []
        self._start = _Node(start, 0, None, (), None)
        self._push(first, 0, None, (), None)

    def run(self, until: float, on_bound: Callable[[int], None] | None = None) -> tuple[Action, ...] | None:
        """Return the next plan cheaper than `below`, or None.

        Args:
            until: when to stop [s, clock of `perf_counter`].
            on_bound: called with every better `bound`.
        """
        while self._open:
            if self.expanded % 64 == 0 and perf_counter() > until:
                return None
            if len(self._open) > MOST_OPEN:
                self.ended = "memory"
                return None
            _, rest, _, cost, parent, actions, moved = heapq.heappop(self._open)
            if cost + rest > self.below - 1 + SLACK:
                continue
            node = self._arrive(cost, parent, actions, moved)
            if node is None:
                continue
            self._raise(cost + rest, on_bound)
            if rest <= SLACK and self.law.goal_shortfall(node.state) is None:
                self.below = cost
                return node.plan()
            self.expanded += 1
            self._expand(node, rest)
        self.ended = "exhausted"
        if self.below < math.inf:
            self._raise(self.below, on_bound)
        return None

    def _raise(self, least: float, on_bound: Callable[[int], None] | None) -> None:
        bound = math.ceil(least - SLACK)
        if self.weight == 1.0 and bound > self.bound:
            self.bound = bound
            if on_bound is not None:
                on_bound(bound)

    def _arrive(self, cost: int, parent: _Node | None, actions: tuple[Action, ...], moved: str | None) -> _Node | None:
        """Return the node of a step, or None where its state was reached at no more cost."""
        node = self._start
        if parent is not None:
            state = parent.state.copy()
            for action in actions:
                self.law.apply(state, action)
            node = _Node(state, cost, parent, actions, moved)
        key = self._key(node.state)
        if self._closed.get(key, math.inf) <= cost:
            return None
        self._closed[key] = cost
        return node

    def _key(self, state: State) -> Hashable:
        """Return the state up to renaming of buffers that are alike."""
        groups = [tuple(sorted(tuple(state.piles[name]) for name in group)) for group in self._alike]
        carried = tuple((name, state.stations[name], frozenset(blocks)) for name, blocks in state.carried.items())
        return tuple(groups), frozenset(state.table), carried

    def _push(
        self, rest: float, cost: int, parent: _Node | None, actions: tuple[Action, ...], moved: str | None
    ) -> None:
        if rest < math.inf and cost + rest <= self.below - 1 + SLACK:
            order = cost + self.weight * rest
            heapq.heappush(self._open, (order, rest, next(self._ties), cost, parent, actions, moved))

    def _expand(self, node: _Node, rest: float) -> None:
        state, cost, law = node.state, node.cost, self.law
        self._transfers(node, rest)
        for kind in law.kinds:
            for action in kind.legal(self.instance, law.options, state):
                after = state.copy()
                law.carry_out(after, action)
                self._push(self.estimate.of(after), cost + law.cost(state, action), node, (action,), None)

    def _transfers(self, node: _Node, rest: float) -> None:
        """Push every pick with every place after it; no block is moved twice running: once would be cheaper."""
        state, estimate, costs = node.state, self.estimate, self.instance.costs
        fixed = node.cost + costs.of("pick") + costs.of("place")
        targets = list(self._targets(state))
        for block, source, now in self._sources(state):
            if block == node.moved:
                continue
            origin = state.place_of(source)
            for target, place, height, under, blocked in targets:
                if target == source:
                    continue
                if height is None:
                    then = estimate.loose(block, place)
                elif blocked or estimate.wrong(block, target, height, under):
                    then = estimate.moving(block, target)
                else:
                    then = 0.0
                cost = fixed + costs.distance(origin, place)
                self._push(rest - now + then, cost, node, (Pick(block, source), Place(block, target)), block)

    def _sources(self, state: State) -> Iterator[tuple[str, str, float]]:
        """Yield the blocks that can be picked, from where, and their share of the estimate."""
        estimate = self.estimate
        for location, pile in state.piles.items():
            if pile:
                block, under = pile[-1], pile[-2] if len(pile) > 1 else None
                blocked = estimate.of_pile(location, pile[:-1])[1]
                moves = blocked or estimate.wrong(block, location, len(pile), under)
                yield block, location, estimate.moving(block, location) if moves else 0.0
        yield from ((block, TABLE, estimate.loose(block, TABLE)) for block in state.table)
        for carrier, blocks in state.carried.items():
            station = state.stations[carrier]
            yield from ((block, carrier, estimate.loose(block, station)) for block in blocks)

    def _targets(self, state: State) -> Iterator[tuple[str, str, int | None, str | None, bool]]:
        """Yield where a block can be put: name, place, height, block below, whether blocks below have to move."""
        for group in self._alike:
            empty = False
            for location in group:
                pile = state.piles[location]
                if not pile and empty:
                    continue  # one empty buffer of those that are alike is enough
                empty = empty or not pile
                blocked = self.estimate.of_pile(location, pile)[1]
                yield location, location, len(pile) + 1, pile[-1] if pile else None, blocked
        for carrier in self.law.open_carriers(state):
            yield carrier, state.stations[carrier], None, None, False


def _interchangeable(instance: Instance) -> list[tuple[str, ...]]:
    """Return the locations in groups: buffers that are alike (without travel costs, all of them), stacks alone."""
    groups: dict[object, list[str]] = {}
    for buffer in instance.buffers:
        where = instance.costs.positions[buffer] if instance.costs.travel else None
        groups.setdefault(where, []).append(buffer)
    return [(stack,) for stack in instance.stacks] + [tuple(group) for group in groups.values()]
