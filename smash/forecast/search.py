"""Plans that take less time: annealing on the plan itself, from plans that planners have found.

A plan is taken as what it moves where, in order: from where a block is picked follows from what was done before it, by
the law. A step changes one entry: another order, another place to put a block aside, another cut, a topple more or
fewer. What the law refuses, or what misses the goal, is no plan; of the others the forecast says how long they take.
What the scene has no room for takes so long that it is left behind, and no plan with it is returned.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import exp
from random import Random
from time import monotonic

from smash.forecast.expected import Expected, Forecaster, Walk
from smash.problem.actions.topple import Topple
from smash.problem.model import TABLE, Action, Aggregating, Pick, Place, State

STEPS = 4000
"""Steps of an annealing."""
TIMES = 3
"""Annealings from each start."""
ALIKE = 3
"""Of plans that topple the same and begin with the same moves so many are kept: others may do better in motion."""
BEGINNING = 3
HOT, COLD = 1.5, 0.05
"""Temperatures at its begin and end [s]."""
NO_ROOM = 1e4
"""Seconds of an action that the scene has no room for: more than any motion takes."""
KEPT = 24
"""So many of the fastest plans are kept, for whoever can judge them better."""


@dataclass(frozen=True, slots=True)
class Shift:
    """An entry of a plan: a block goes to a location, from wherever it is then."""

    block: str
    target: str


Entry = Shift | Topple


@dataclass(frozen=True, slots=True)
class Candidate:
    """A legal plan and what is expected of it."""

    actions: tuple[Action, ...]
    expected: Expected


def faster(
    forecaster: Forecaster,
    starts: Sequence[Sequence[Action]],
    *,
    seed: int = 0,
    steps: int = STEPS,
    until: float | None = None,
    stopped: Callable[[], bool] = lambda: False,
) -> list[Candidate]:
    """Return plans that fit the scene and take little time, the fastest first; chosen from the starts, too.

    Args:
        forecaster: says what is expected of a plan.
        starts: legal plans; of those that the scene has no room for, plans that it has may come.
        seed: of what is drawn at random: the same seed gives the same plans where time allows all steps.
        steps: of each annealing.
        until: when to stop, by the monotonic clock [s].
        stopped: whether to stop at once.
    """
    found: dict[tuple[Action, ...], Expected] = {}
    tasks = [start for start in starts for _ in range(TIMES)]
    for number, start in enumerate(tasks):
        now = monotonic()
        last = None if until is None else now + max(0.0, until - now) / (len(tasks) - number)
        actions = tuple(start)
        if forecaster.misfit(actions) is None:
            found[actions] = forecaster.of(actions)
        annealing = _Annealing(forecaster, actions, Random(f"{seed} {number}"))
        for step, candidate in enumerate(annealing.walk(steps)):
            if candidate is not None and candidate.expected.seconds < NO_ROOM:
                found[candidate.actions] = candidate.expected
            if step % 64 == 0:
                if stopped() or (last is not None and monotonic() > last):
                    break
                if len(found) > 40 * KEPT:
                    found = _fastest(found)
    return [Candidate(actions, expected) for actions, expected in _fastest(found).items()]


def _fastest(found: dict[tuple[Action, ...], Expected]) -> dict[tuple[Action, ...], Expected]:
    ranked = sorted(found.items(), key=lambda item: (item[1].seconds, len(item[0])))
    kept, alike = {}, Counter[tuple[object, ...]]()
    for actions, expected in ranked:
        entries = list(_entries(actions))
        topples = frozenset(entry for entry in entries if isinstance(entry, Topple))
        moves = [entry for entry in entries if isinstance(entry, Shift)]
        kind = (topples, *moves[:BEGINNING])
        alike[kind] += 1
        if alike[kind] <= ALIKE:
            kept[actions] = expected
        if len(kept) == KEPT:
            break
    return kept


def neighbours(forecaster: Forecaster, actions: Sequence[Action], random: Random, tries: int) -> Iterator[Candidate]:
    """Yield legal plans that differ from one by a single change, at random, out of so many tries."""
    yield from _Annealing(forecaster, tuple(actions), random).beside(tries)


class _Annealing:
    """One annealing: the plan that it is at, and the walks that lead to each of its entries."""

    def __init__(self, forecaster: Forecaster, start: tuple[Action, ...], random: Random) -> None:
        self._forecaster = forecaster
        self._law = forecaster.law
        self._random = random
        self._places = forecaster.problem.instance.locations
        self._stacks = forecaster.problem.instance.stacks
        held = forecaster.problem.instance.hand is not None
        self._first = start[:1] if held else ()
        self._entries = list(_entries(start[len(self._first) :]))
        self._now = self._followed([], self._entries, 0)

    def walk(self, steps: int) -> Iterator[Candidate | None]:
        """Yield what each step has found: a legal plan that was taken, or None."""
        if self._now is None:
            return
        for step in range(steps):
            heat = HOT * (COLD / HOT) ** (step / steps)
            entries, since = self._changed()
            if entries is None:
                yield None
                continue
            tried = self._followed(self._now.walks, entries, since)
            if tried is None:
                yield None
                continue
            worse = tried.expected.seconds - self._now.expected.seconds
            if worse > 0 and self._random.random() >= exp(-worse / heat):
                yield None
                continue
            self._entries, self._now = entries, tried
            yield Candidate(tried.actions, tried.expected)

    def beside(self, tries: int) -> Iterator[Candidate]:
        """Yield legal plans beside the one that it is at, which it stays at."""
        for _ in range(tries):
            entries, since = self._changed()
            if entries is None or self._now is None:
                continue
            tried = self._followed(self._now.walks, entries, since)
            if tried is not None and tried.actions != self._now.actions:
                yield Candidate(tried.actions, tried.expected)

    def _changed(self) -> tuple[list[Entry] | None, int]:
        """Return the entries with one change, and the first that differs."""
        random, entries = self._random, list(self._entries)
        if not entries:
            return None, 0
        index, kind = random.randrange(len(entries)), random.random()
        if kind < 0.55:
            other = random.randrange(len(entries))
            entries.insert(other, entries.pop(index))
            return (None if other == index else entries), min(index, other)
        entry = entries[index]
        if kind < 0.70:
            if not isinstance(entry, Shift):
                entries[index] = Topple(entry.location, max(1, entry.height + random.choice((-2, -1, 1, 2))))
            else:
                entries[index] = Shift(entry.block, random.choice(self._places))
            return entries, index
        if kind < 0.85:
            if isinstance(entry, Topple) and random.random() < 0.5:
                entries[index] = Topple(random.choice(self._stacks), entry.height)
            else:
                del entries[index]
            return entries, index
        if not self._law.options.topple:
            return None, 0
        entries.insert(index, Topple(random.choice(self._stacks), random.randint(1, 9)))
        return entries, index

    def _followed(
        self, walks: Sequence[tuple[Walk, float, float, int]], entries: Sequence[Entry], since: int
    ) -> _Plan | None:
        """Follow entries from the `since`-th on; None where the law refuses one, or the goal is missed at the end."""
        if since and walks:
            kept = list(walks[: since + 1])
            before, taken, risk, done = kept[-1]
            assert self._now is not None
            walk, actions = before.copy(), list(self._now.actions[:done])
            kept.pop()
        else:
            walk, taken, risk, actions, kept, since = self._forecaster.begin(), 0.0, 0.0, [], [], 0
            for action in self._first:
                expected = self._forecaster.step(walk, action)
                taken, risk, actions = taken + expected.seconds, risk + expected.risk, [*actions, action]
        for entry in entries[since:]:
            kept.append((walk.copy(), taken, risk, len(actions)))
            for action in _actions(entry, walk.state):
                if self._law.refusal(walk.state, action) is not None:
                    return None
                if self._forecaster.no_room(walk.state, action) is not None:
                    taken += NO_ROOM
                expected = self._forecaster.step(walk, action)
                taken, risk = taken + expected.seconds, risk + expected.risk
                actions.append(action)
        if self._law.goal_shortfall(walk.state) is not None:
            return None
        return _Plan(tuple(actions), Expected(taken, risk), kept)


@dataclass(frozen=True, slots=True)
class _Plan:
    """A legal plan, what is expected of it, and for each entry what was before it: the walk, seconds, risk, actions."""

    actions: tuple[Action, ...]
    expected: Expected
    walks: Sequence[tuple[Walk, float, float, int]]


def _entries(actions: Sequence[Action]) -> Iterator[Entry]:
    """Yield the entries of a plan that begins and ends with an empty hand."""
    for action in actions:
        match action:
            case Place(block, target):
                yield Shift(block, target)
            case Topple():
                yield action
            case Pick() | Aggregating():
                continue


def _actions(entry: Entry, state: State) -> tuple[Action, ...]:
    """Return the actions of an entry from a state; of a block that is not to be had, one that the law refuses."""
    if isinstance(entry, Topple):
        return (entry,)
    block = entry.block
    source = TABLE
    if block not in state.table:
        source = next((location for location, pile in state.piles.items() if pile and pile[-1] == block), TABLE)
    return Pick(block, source), Place(block, entry.target)
