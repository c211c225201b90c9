"""One pass of the greedy planner: direct moves while there are any, else dig for the cheapest next goal block.

Each round fixes one more goal block for good, so a pass ends; between two blocks it costs O(locations), so its
time is near-linear in the plan's length. Where a block is put aside is read off a list of the locations by when they
are needed next, in O(log locations).
"""

from __future__ import annotations

import math
import random
from bisect import bisect_left, bisect_right, insort
from collections.abc import Sequence
from time import perf_counter

from smash.problem.views.numbered import ON_TABLE, TOPPLE, Numbered, Step
from smash.problem.views.targets import Piles, Resting

NEVER = math.inf
"""The due time of a block that is not needed."""
CHECK_SECONDS = 3e-6
"""About what an action takes to be judged and reported, once the pass is over."""


class Construction:
    """The state of one pass, the steps taken so far, and the choices when no direct move is left.

    Args:
        problem: the numbered instance.
        target: the piles to build; with topple forbidden there are three locations or more.
        topple: whether toppling is allowed.
        cap: the most blocks of one topple.
        due: per block, when it is expected to reach its goal: blocks put aside are stacked by it.
        noise: how much the choice of the next block is disturbed, 0 for none.
        disturbed: how many choices are, the first ones.
        draw: the random source for `noise`.
    """

    def __init__(
        self,
        problem: Numbered,
        target: Piles,
        *,
        topple: bool,
        cap: int,
        due: Sequence[float],
        noise: float = 0.0,
        disturbed: float = math.inf,
        draw: random.Random | None = None,
    ) -> None:
        self.target = target
        self.stacks = problem.stacks
        self.topple = topple
        self.cap = cap
        self.noise = noise
        self._to_disturb = disturbed
        self.draw = draw or random.Random(0)
        self.goal_of = [ON_TABLE] * problem.blocks
        for location, pile in enumerate(target):
            for block in pile:
                self.goal_of[block] = location
        self.due = [due[block] if goal != ON_TABLE else NEVER for block, goal in enumerate(self.goal_of)]
        self.resting = Resting(problem)
        self.steps: list[Step] = []
        self.finished_at: list[float] = [NEVER] * problem.blocks
        self.toppled: set[int] = set()
        self.at = [ON_TABLE] * problem.blocks
        self.level = [0] * problem.blocks
        self.piles: list[list[int]] = [[] for _ in target]
        self.earliest: list[list[float]] = [[] for _ in target]
        self.done = [0] * len(target)
        for location, blocks in enumerate(problem.start):
            for level, block in enumerate(blocks):
                right = self.done[location] == level < len(target[location]) and target[location][level] == block
                self.done[location] += right
                self._lay(block, location)
        self.agenda = list(range(len(target)))
        self._needed = [(self._release(at), len(pile), at) for at, pile in enumerate(self.piles)]
        self._by_need = sorted(self._needed)

    def run(
        self, first: Sequence[int] = (), deadline: float = math.inf, most_steps: float = math.inf
    ) -> list[Step] | None:
        """Topple the stacks `first` whole, then work until every target pile is built.

        Args:
            first: stacks.
            deadline: when the plan is to be judged [s, `perf_counter`]; it is given up if it would not be.
            most_steps: it is given up with more.

        Returns:
            The steps, or None where it was given up.
        """
        for location in first:
            while self._must_leave(location):
                self._topple(location)
        self._direct_moves()
        while (goal := self._next_goal()) is not None:
            block = self.target[goal][self.done[goal]]
            while self.finished_at[block] == NEVER:
                if perf_counter() + CHECK_SECONDS * len(self.steps) > deadline or len(self.steps) > most_steps:
                    return None
                self._dig(block, goal)
                self._direct_moves()
        if self.topple:
            self._let_fall()
        return self.steps

    # One step forward.

    def _dig(self, block: int, goal: int) -> None:
        """Bring `block` one action closer to being moved to its goal location."""
        source = self.at[block]
        if source not in (ON_TABLE, goal) and self.piles[source][-1] != block:
            self._clear(source, block, goal)
        else:
            self._clear(goal, block, goal)

    def _clear(self, location: int, block: int, goal: int) -> None:
        if self.topple and location < self.stacks:
            self._topple(location)
        else:
            top = self.piles[location][-1]
            self._move(top, self._parking(top, location, {goal, self.at[block]}))

    def _direct_moves(self) -> None:
        """Move every block that can go straight to its final place."""
        while self.agenda:
            goal = self.agenda.pop()
            done = self.done[goal]
            if done != len(self.piles[goal]) or done == len(self.target[goal]):
                continue
            block = self.target[goal][done]
            source = self.at[block]
            if source == ON_TABLE or self.piles[source][-1] == block:
                self._move(block, goal)

    def _move(self, block: int, target: int) -> None:
        source = self.at[block]
        self.steps.append((block, source, target))
        if source != ON_TABLE:
            self._pop(source)
        done = self.done[target]
        if done == len(self.piles[target]) and done < len(self.target[target]) and self.target[target][done] == block:
            self.done[target] = done + 1
            self.finished_at[block] = len(self.steps)
        self._push(block, target)
        self.agenda.append(target)

    def _topple(self, location: int) -> None:
        """Topple as much as must leave, up to the cap."""
        pile = self.piles[location]
        falling = min(self.cap, max(1, self._must_leave(location)))
        self.steps.append((TOPPLE, location, falling))
        self.toppled.add(location)
        for _ in range(falling):
            block = pile[-1]
            self._pop(location)
            self.at[block] = ON_TABLE
            if self.goal_of[block] != ON_TABLE:
                self.agenda.append(self.goal_of[block])

    def _push(self, block: int, location: int) -> None:
        self._lay(block, location)
        self._note_need(location)

    def _lay(self, block: int, location: int) -> None:
        pile, earliest = self.piles[location], self.earliest[location]
        placed = len(pile) < self.done[location]
        lowest = earliest[-1] if earliest else NEVER
        self.at[block] = location
        self.level[block] = len(pile)
        pile.append(block)
        earliest.append(lowest if placed else min(lowest, self.due[block]))
        if placed:
            self.finished_at[block] = len(self.steps)

    def _pop(self, location: int) -> None:
        pile = self.piles[location]
        pile.pop()
        self.earliest[location].pop()
        self.agenda.append(location)
        if pile and self.goal_of[pile[-1]] != ON_TABLE:
            self.agenda.append(self.goal_of[pile[-1]])
        self._note_need(location)

    def _let_fall(self) -> None:
        """Bring what may not lie where it does (`Resting`) to where it may, in the end to the table region."""
        for buffer in range(self.stacks, len(self.piles)):
            while self._must_leave(buffer):
                block = self.piles[buffer][-1]
                self._move(block, self._harbour(block, buffer))
        for stack in range(self.stacks):
            while self._must_leave(stack):
                self._topple(stack)

    # Choices.

    def _must_leave(self, location: int) -> int:
        """Return how many top blocks cannot stay: those above the right ones, or from the first needed or wrong one."""
        pile, done = self.piles[location], self.done[location]
        if done < len(self.target[location]):
            return len(pile) - done
        for level in range(done, len(pile)):
            block = pile[level]
            if self.goal_of[block] != ON_TABLE or (level and self.resting.wrong(block, pile[level - 1])):
                return len(pile) - level
        return 0

    def _next_goal(self) -> int | None:
        """Return the unfinished location whose next block takes the least work, or None where all are built."""
        best, least = None, (math.inf, math.inf)
        noise = self.noise if self._to_disturb > 0 else 0.0
        self._to_disturb -= 1
        for goal, target in enumerate(self.target):
            if self.done[goal] == len(target):
                continue
            block = target[self.done[goal]]
            source = self.at[block]
            work = self._price(goal, len(self.piles[goal]) - self.done[goal])
            if source not in (ON_TABLE, goal):
                work += self._price(source, len(self.piles[source]) - 1 - self.level[block])
            if noise:
                work *= 1 + noise * self.draw.random()
            if (work, self.due[block]) < least:
                best, least = goal, (work, self.due[block])
        return best

    def _price(self, location: int, blocks: int) -> float:
        if self.topple and location < self.stacks:
            return math.ceil(blocks / self.cap)
        return 2 * blocks

    def _parking(self, block: int, source: int, avoid: set[int]) -> int:
        """Return where to put `block` aside: where it leaves before what it covers, the tightest such place.

        With topple any stack will do if all else is to be avoided: it can be emptied again.
        """
        due, by_need, skipped = self.due[block], self._by_need, {source, *avoid}
        harmless = bisect_right(by_need, (due, math.inf)) if due < NEVER else bisect_left(by_need, (NEVER,))
        for index in range(harmless, len(by_need)):
            location = by_need[index][2]
            if location not in skipped and (due < NEVER or not self._spoils(block, self.piles[location])):
                return location
        for release, _, location in reversed(by_need):
            if location not in skipped:  # the latest need: of those the lowest pile
                same = range(bisect_left(by_need, (release,)), len(by_need))
                return next(by_need[index][2] for index in same if by_need[index][2] not in skipped)
        return next(location for location in range(self.stacks) if location != source)

    def _note_need(self, location: int) -> None:
        """Keep the list of the locations in its order when what lies on one has changed."""
        before = self._needed[location]
        after = (self._release(location), len(self.piles[location]), location)
        del self._by_need[bisect_left(self._by_need, before)]
        insort(self._by_need, after)
        self._needed[location] = after

    def _spoils(self, block: int, pile: Sequence[int]) -> bool:
        return bool(pile) and self.resting.wrong(block, pile[-1])

    def _harbour(self, block: int, source: int) -> int:
        """Return where a block may lie for good when all targets are built; else a stack that it can fall from."""
        settled = [at for at in range(len(self.piles)) if at != source and not self._must_leave(at)]
        for location in settled:
            if not self._spoils(block, self.piles[location]):
                return location
        return next((stack for stack in range(self.stacks) if stack not in settled), 0)

    def _release(self, location: int) -> float:
        """Return when something under the top of `location` is needed, or the next block is to be put there."""
        earliest = self.earliest[location][-1] if self.earliest[location] else NEVER
        done, target = self.done[location], self.target[location]
        return min(earliest, self.due[target[done]]) if done < len(target) else earliest
