"""From chosen choices to a plan: an order of the events and a resting place for each block that waits.

A block put aside may rest in a free location, on a finished pile, or on any top that is wanted only after the
block has left again, which is one more precedence `P(block) -> next event there`, allowed as long as the
remaining events stay acyclic. Where only one thing can sensibly be done it is done; elsewhere a
depth-first search tries the alternatives, so that few buffers are used as well as they can be.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from time import perf_counter

from smash.planners.precedence.graph import Choice
from smash.problem.actions.topple import Topple
from smash.problem.model import TABLE, Action, OnGoal, Pick, Place, State
from smash.problem.problem import Problem
from smash.problem.views.demands import Demands, Pile

Event = tuple[str, str]
Segments = dict[str, list[tuple[int, int]]]
MEMO_BLOCKS = 60
"""Up to so many blocks visited states are remembered; above, the search hardly meets a state twice."""


@dataclass(slots=True)
class Progress:
    """How far a schedule has come: leaving blocks still in their start pile (`remaining`), those put aside so far."""

    state: State
    where: dict[str, str]
    remaining: dict[str, int]
    placed: list[int]
    chain_at: dict[str, int]
    segments: Segments
    waiting: set[str] = field(default_factory=set)
    gone_aside: int = 0
    actions: list[Action] = field(default_factory=list)

    @property
    def piles(self) -> dict[str, list[str]]:
        """The piles per location, bottom first."""
        return self.state.piles

    def copy(self) -> Progress:
        """Return an independent copy."""
        return Progress(
            self.state.copy(),
            dict(self.where),
            dict(self.remaining),
            list(self.placed),
            dict(self.chain_at),
            {location: list(segments) for location, segments in self.segments.items()},
            set(self.waiting),
            self.gone_aside,
            list(self.actions),
        )

    def key(self) -> object:
        """Return what the rest of the schedule depends on."""
        piles = tuple(tuple(pile) for pile in self.piles.values())
        return piles, tuple(self.placed), tuple(sorted(self.chain_at.items()))


class Scheduler:
    """Schedules one set of choices for a problem; `demands` where more is asked of the blocks than the goal does."""

    def __init__(self, problem: Problem, choices: Sequence[Choice], demands: Demands | None = None) -> None:
        instance, demands = problem.instance, demands or problem.demands
        self.law = problem.law
        self.instance = instance
        self.demands = demands
        self.cap = problem.options.max_topple
        self.chains: list[Pile] = [*demands.build.values(), *(chain.blocks for chain in demands.floating)]
        located = len(demands.build)
        self.bottoms = {located + k for k, chain in enumerate(demands.floating) if chain.bottom}
        self.chain_of = {block: number for number, chain in enumerate(self.chains) for block in chain}
        self.rank = {block: rank for chain in self.chains for rank, block in enumerate(chain)}
        goal = problem.posed.goal
        self.clear = frozenset(goal.clear if isinstance(goal, OnGoal) else ())
        self.on_table = frozenset(goal.ontable if isinstance(goal, OnGoal) else ())
        self.aside = {instance.start[c.location][c.low - 1] for c in choices if not c.topple}
        self.segments = disjoint_segments(choices)
        self._extend_segments()
        self._loose_moves = set(demands.loose) - {
            block
            for location, segments in self.segments.items()
            for low, high in segments
            for block in instance.start[location][low - 1 : high]
        }
        self._riders = any(instance.start[buffer] for buffer in instance.buffers)
        self.nodes = 0
        self._deadline = math.inf

    def _extend_segments(self) -> None:
        """Let a topple take the kept blocks below it that the goal does not name: free, and may empty a location."""
        if not isinstance(self.instance.goal, OnGoal):
            return
        named = {block for tower in self.instance.goal.towers() for block in tower}
        for location, segments in self.segments.items():
            low, high = segments[-1]
            if low != self.demands.keep[location] + 1:
                continue
            while low > 1 and self.instance.start[location][low - 2] not in named:
                if self.cap is not None and high - low + 1 >= self.cap:
                    break
                low -= 1
            segments[-1] = (low, high)

    def plan(self, deadline: float, most_nodes: int = 20_000) -> tuple[Action, ...] | None:
        """Return a plan in which exactly the chosen blocks are freed, or None where none was found.

        Args:
            deadline: when to give up [s, `perf_counter`].
            most_nodes: branches after which to give up.
        """
        self._deadline = deadline
        first = self._start()
        if self._advance(first):
            return tuple(first.actions)
        seen: set[object] = {first.key()}
        memo = len(self.instance.blocks) <= MEMO_BLOCKS
        stack = [self._branches(first)]
        while stack and perf_counter() <= deadline:
            branch = next(stack[-1], None)
            if branch is None:
                stack.pop()
                continue
            self.nodes += 1
            if self.nodes > most_nodes:
                return None
            if self._advance(branch):
                return tuple(branch.actions)
            if memo:
                key = branch.key()
                if key in seen:
                    continue
                seen.add(key)
            stack.append(self._branches(branch))
        return None

    def _start(self) -> Progress:
        start, demands = self.instance.start, self.demands
        where = {block: location for location, pile in start.items() for block in pile}
        where.update((block, TABLE) for block in self.instance.table)
        return Progress(
            state=State.start_of(self.instance),
            where=where,
            remaining={location: len(pile) for location, pile in demands.leaving.items()},
            placed=[0] * len(self.chains),
            chain_at={location: number for number, location in enumerate(demands.build)},
            segments={location: list(segments) for location, segments in self.segments.items()},
        )

    # What can be done without regret

    def _advance(self, state: Progress) -> bool:
        """Do all that can be done without regret; return whether the goal is reached."""
        moved = True
        while moved and perf_counter() <= self._deadline:
            moved = (
                self._place_ready(state)
                or self._topple_ready(state)
                or self._move_loose(state)
                or self._use_room(state)
            )
        done = all(count == len(chain) for count, chain in zip(state.placed, self.chains, strict=True))
        return done and not any(state.remaining.values())

    def _place_ready(self, state: Progress) -> bool:
        moved = False
        for location in list(state.chain_at):
            while location in state.chain_at and perf_counter() <= self._deadline:
                number = state.chain_at[location]
                block = self.chains[number][state.placed[number]]
                if state.where[block] == location or not self._accessible(state, block):
                    break
                if self._next_event(state, location) != ("P", block):
                    break
                self._place(state, block, location)
                moved = True
        return moved

    def _place(self, state: Progress, block: str, location: str) -> None:
        number = self.chain_of[block]
        self._move(state, block, location)
        state.waiting.discard(block)
        state.placed[number] += 1
        state.chain_at[location] = number
        if state.placed[number] == len(self.chains[number]):
            del state.chain_at[location]

    def _topple_ready(self, state: Progress) -> bool:
        if self._riders and self._may_ride(state):
            return False  # a block of a buffer may ride on the falling stack: a branch
        return any(self._topple(state, location) for location in state.segments)

    def _topple(self, state: Progress, location: str) -> bool:
        segments, pile = state.segments[location], state.piles[location]
        if not segments:
            return False
        low, high = segments[0]
        top = self.demands.keep[location] + state.remaining[location]
        if not state.remaining[location] or top < low:
            segments.pop(0)  # all of its blocks went straight to their places
            return True
        if top > high or (self.cap is not None and len(pile) - low + 1 > self.cap):
            return False
        for block in pile[low - 1 :]:
            state.where[block] = TABLE
            state.waiting.discard(block)
        state.remaining[location] -= min(top - low + 1, state.remaining[location])
        segments.pop(0)
        self._do(state, Topple(location, low))
        return True

    def _move_loose(self, state: Progress) -> bool:
        for location, count in state.remaining.items():
            if not count or not state.piles[location] or state.piles[location][-1] not in self._loose_moves:
                continue
            block = state.piles[location][-1]
            if len(state.piles[location]) != self.demands.keep[location] + count:
                continue
            grounds = [] if block in self.on_table else self._grounds(state)
            if grounds:
                self._move(state, block, grounds[0])
                return True
        return False

    def _use_room(self, state: Progress) -> bool:
        """Where every block and tower still to come can have a free location of its own, take one."""
        needed = sum(not count for count in state.placed[len(self.demands.build) :])
        needed += len(self.aside) - state.gone_aside + bool(self._loose_moves)
        if self._riders and self._may_ride(state):
            return False
        free = self._free(state)
        if len(free) < needed:
            return False
        for number in range(len(self.demands.build), len(self.chains)):
            if not state.placed[number] and self._accessible(state, self.chains[number][0]):
                self._place(state, self.chains[number][0], free[0])
                return True
        for block in self._tops_to_put_aside(state)[:1]:
            self._put(state, block, free[0])
            return True
        for block in self._loose_tops(state)[:1]:
            self._move(state, block, free[0])
            return True
        return False

    # Alternatives

    def _branches(self, state: Progress) -> Iterator[Progress]:
        """Yield the alternatives of a state in which nothing can be done without regret, the likeliest first."""
        free = self._free(state)
        yield from self._float(state, free)
        tops = self._tops_to_put_aside(state)
        harbours = [*self._finished(state)[:1], *free[:1]][:1]
        for block in tops:
            for location in harbours:
                yield self._put_aside(state, block, location)
        if self._riders:
            yield from self._rides(state, tops)
        for location in free[:1]:
            for block in self._loose_tops(state):
                after = state.copy()
                self._move(after, block, location)
                yield after
        for block in tops:
            before = self._before(state, block)
            for location in state.piles:
                event = self._next_event(state, location)
                if event is not None and location != state.where[block] and event not in before:
                    yield self._put_aside(state, block, location)

    def _float(self, state: Progress, free: Sequence[str]) -> Iterator[Progress]:
        """Start a tower whose location is free."""
        for number in range(len(self.demands.build), len(self.chains)):
            block = self.chains[number][0]
            if state.placed[number] or not self._accessible(state, block):
                continue
            places = free[:1] if number in self.bottoms else [*self._grounds(state)[:1], *free[:1]][:1]
            for location in places:
                after = state.copy()
                self._place(after, block, location)
                yield after

    def _rides(self, state: Progress, tops: Sequence[str]) -> Iterator[Progress]:
        """Put a block of a buffer on a stack that is about to be toppled, or topple without it."""
        ready = [
            location
            for location, segments in state.segments.items()
            if segments and self.demands.keep[location] + state.remaining[location] <= segments[0][1]
        ]
        for location in ready:
            for block in [*tops, *self._loose_tops(state)]:
                height = len(state.piles[location]) - state.segments[location][0][0] + 1
                if self.cap is None or height < self.cap:
                    yield self._put_aside(state, block, location)
            after = state.copy()
            if self._topple(after, location):
                yield after

    def _tops_to_put_aside(self, state: Progress) -> list[str]:
        """Return the chosen blocks that lie open in their start pile, those that are soon placed first."""
        tops = [
            pile[-1]
            for location, pile in state.piles.items()
            if state.remaining[location] and pile[-1] in self.aside and pile[-1] not in state.waiting
        ]
        return sorted(tops, key=lambda block: self.rank[block] - state.placed[self.chain_of[block]])

    def _loose_tops(self, state: Progress) -> list[str]:
        return [
            pile[-1]
            for location, pile in state.piles.items()
            if state.remaining[location] and pile[-1] in self._loose_moves and pile[-1] not in state.waiting
        ]

    def _put_aside(self, state: Progress, block: str, location: str) -> Progress:
        after = state.copy()
        self._put(after, block, location)
        return after

    def _put(self, state: Progress, block: str, location: str) -> None:
        self._move(state, block, location)
        state.waiting.add(block)
        state.gone_aside += block in self.aside

    # Reading a state

    def _move(self, state: Progress, block: str, target: str) -> None:
        source = state.where[block]
        self._do(state, Pick(block, source))
        self._do(state, Place(block, target))
        if source != TABLE and block not in state.waiting:
            state.remaining[source] -= 1
        state.where[block] = target

    def _do(self, state: Progress, action: Action) -> None:
        self.law.carry_out(state.state, action)
        state.actions.append(action)

    def _accessible(self, state: Progress, block: str) -> bool:
        location = state.where[block]
        return location == TABLE or state.piles[location][-1] == block

    def _next_event(self, state: Progress, location: str) -> Event | None:
        """Return the next event that changes what lies on top of `location`, or None where nothing has to."""
        pile = state.piles[location]
        if pile and pile[-1] in state.waiting:
            return "P", pile[-1]
        if state.remaining[location]:
            return "R", pile[-1]
        if location in state.chain_at:
            number = state.chain_at[location]
            return "P", self.chains[number][state.placed[number]]
        return None

    def _finished(self, state: Progress) -> list[str]:
        """Return the locations with blocks, none of which has to move, and with nothing to come."""
        return [at for at, pile in state.piles.items() if pile and self._next_event(state, at) is None]

    def _grounds(self, state: Progress) -> list[str]:
        """Return the finished locations on which something may stay."""
        return [at for at in self._finished(state) if state.piles[at][-1] not in self.clear]

    def _free(self, state: Progress) -> list[str]:
        """Return the empty locations where nothing is to come."""
        return [at for at, pile in state.piles.items() if not pile and at not in state.chain_at]

    def _may_ride(self, state: Progress) -> bool:
        """Whether a block that is to be put aside or out of the way is still in the start pile of a buffer."""
        keep = self.demands.keep
        return any(
            block in self.aside or block in self._loose_moves
            for buffer in self.instance.buffers
            for block in state.piles[buffer][keep[buffer] : keep[buffer] + state.remaining[buffer]]
        )

    def _before(self, state: Progress, block: str) -> set[Event]:
        """Return the remaining events that come before the placement of `block`, that itself included."""
        after: dict[Event, list[Event]] = {}
        for location, pile in state.piles.items():
            self._predecessors(state, location, pile, after)
        seen: set[Event] = {("P", block)}
        agenda: list[Event] = [("P", block)]
        while agenda:
            event = agenda.pop()
            kind, name = event
            earlier = list(after.get(event, ()))
            if kind == "P" and name in self.chain_of:  # a loose block that rides on a stack has no place to come
                number, rank = self.chain_of[name], self.rank[name]
                if rank > state.placed[number]:
                    earlier.append(("P", self.chains[number][rank - 1]))
                if self._in_start_pile(state, name):
                    earlier.append(("R", name))
            elif name in self.chain_of and self._direct(state, name):
                earlier.append(("P", name))
            fresh = [e for e in earlier if e not in seen]
            seen.update(fresh)
            agenda.extend(fresh)
        return seen

    def _predecessors(
        self, state: Progress, location: str, pile: Sequence[str], after: dict[Event, list[Event]]
    ) -> None:
        """Note, for what lies on `location`, which events wait for which: a pile is taken from the top."""
        base = self.demands.keep[location]
        leaving = pile[base : base + state.remaining[location]] if state.remaining[location] else []
        resting = [b for b in pile if b in state.waiting]
        order: list[Event] = [("R", b) for b in leaving] + [("P", b) for b in resting]
        if location in state.chain_at:
            number = state.chain_at[location]
            order.insert(0, ("P", self.chains[number][state.placed[number]]))
        for later, sooner in itertools.pairwise(order):
            after.setdefault(later, []).append(sooner)

    def _in_start_pile(self, state: Progress, block: str) -> bool:
        location = state.where[block]
        return location != TABLE and block not in state.waiting

    def _direct(self, state: Progress, block: str) -> bool:
        return self._in_start_pile(state, block) and block not in self.aside and not self._will_fall(state, block)

    def _will_fall(self, state: Progress, block: str) -> bool:
        location = state.where[block]
        segments = state.segments.get(location)
        if not segments:
            return False
        height = state.piles[location].index(block) + 1
        return any(low <= height <= high for low, high in segments)


def disjoint_segments(choices: Sequence[Choice]) -> Segments:
    """Return the topples of each stack as runs of heights `(low, high)`, top first, overlaps cut off."""
    segments: Segments = {}
    for choice in sorted((c for c in choices if c.topple), key=lambda c: -c.high):
        runs = segments.setdefault(choice.location, [])
        high = min(choice.high, runs[-1][0] - 1) if runs else choice.high
        if high >= choice.low:
            runs.append((choice.low, high))
    return segments


def chosen_of(choices: Sequence[Choice], chosen: Mapping[int, object] | set[int]) -> list[Choice]:
    """Return the chosen choices, in order."""
    return [choices[index] for index in sorted(chosen)]
