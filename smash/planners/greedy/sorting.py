"""A plan without topple that is found at once, however few locations there are: the blocks are sorted into their piles.

All that has to leave is gathered on one location and dealt out by target; then each pile is sorted by dealing it out
again onto the tops of all the others, range by range of its heights. With n blocks on k + 1 locations that takes about
n (2 + log n / log k) transfers, where digging for one block after another takes some n² / k.
"""

from __future__ import annotations

from collections.abc import Sequence

from smash.problem.views.numbered import ON_TABLE, Numbered, Step
from smash.problem.views.targets import Piles, Resting


def sorted_steps(problem: Numbered, target: Piles) -> list[Step] | None:
    """Return steps without topple after which every target pile stands, or None where they might leave a block wrong.

    Args:
        problem: the numbered instance, of three locations or more.
        target: the piles to build.

    Raises:
        ValueError: with fewer than three locations.
    """
    if problem.locations < 3:
        raise ValueError("blocks are sorted with three locations or more")
    wanted = {block for pile in target for block in pile}
    resting = Resting(problem)
    loose = any(block not in wanted for pile in problem.start for block in pile)
    if loose and (resting.clear or resting.on_table):
        return None
    return _Sorting(problem, target).run()


class _Sorting:
    """The piles, and the transfers so far."""

    def __init__(self, problem: Numbered, target: Piles) -> None:
        self.steps: list[Step] = []
        self.piles = [list(pile) for pile in problem.start]
        self._table = set(problem.table)
        self._goal = {block: at for at, pile in enumerate(target) for block in pile}
        self._height = {block: height for pile in target for height, block in enumerate(pile)}
        self._leaving = [len(pile) - self._kept(pile, target[at]) for at, pile in enumerate(self.piles)]
        # Best a location that nothing is to come to.
        coming = [sum(block not in pile for block in target[at]) for at, pile in enumerate(map(set, self.piles))]
        self._hub = min(range(len(target)), key=lambda at: (bool(target[at]), coming[at], -self._leaving[at]))
        self._aside = next(at for at in range(len(target)) if at != self._hub)

    def _kept(self, pile: Sequence[int], target: Sequence[int]) -> int:
        """Return how many of the lowest blocks of a pile can stay."""
        right = 0
        while right < min(len(pile), len(target)) and pile[right] == target[right]:
            right += 1
        if right < len(target):
            return right
        return next((level for level in range(right, len(pile)) if pile[level] in self._goal), len(pile))

    def run(self) -> list[Step]:
        hub, piles = self._hub, self.piles
        count = self._leaving[hub]
        for at, leaving in enumerate(self._leaving):
            if at != hub:
                for _ in range(leaving):
                    self._move(at, hub)
                count += leaving
        for block in sorted(self._table & self._goal.keys()):
            self.steps.append((block, ON_TABLE, hub))
            piles[hub].append(block)
            count += 1
        for block in piles[hub][len(piles[hub]) - count :]:
            if block not in self._goal:  # anywhere, on top of what is wanted
                self._goal[block] = self._aside
                self._height[block] = len(self._height)
        self._deal_out(count)
        return self.steps

    def _deal_out(self, count: int) -> None:
        """Bring the top blocks of the hub to their piles, and sort these."""
        hub, aside, piles = self._hub, self._aside, self.piles
        waiting = [0] * len(piles)
        mixed = 0
        for _ in range(count):
            goal = self._goal[piles[hub][-1]]
            mixed += goal == hub
            waiting[goal if goal != hub else aside] += 1
            self._move(hub, goal if goal != hub else aside)
        if mixed:  # the hub's own are among those of another pile: take both apart
            third = next(at for at in range(len(piles)) if at not in (hub, aside))
            own = waiting[aside] - mixed
            for _ in range(waiting[aside]):
                self._move(aside, hub if self._goal[piles[aside][-1]] == hub else third)
            waiting[hub], waiting[aside] = mixed, 0
            self._sort(third, aside, own)
        for at, blocks in enumerate(waiting):
            self._sort(at, at, blocks)

    def _sort(self, source: int, target: int, count: int) -> None:
        """Bring the top `count` blocks of `source` onto `target`, by height; all other piles are left as they were."""
        pile = self.piles[source]
        heights = [self._height[block] for block in pile[len(pile) - count :]]
        rising = sorted(heights)
        if source == target and heights == rising:
            return
        if source != target and heights[::-1] == rising:
            for _ in range(count):
                self._move(source, target)
            return
        others = [at for at in range(len(self.piles)) if at not in (source, target)]
        if source != target:
            others.insert(0, target)  # its range is the lowest: it is sorted where it lies
        parts = min(len(others), count)
        bucket = {height: others[number * parts // count] for number, height in enumerate(rising)}
        sizes = dict.fromkeys(others, 0)
        for _ in range(count):
            to = bucket[self._height[pile[-1]]]
            sizes[to] += 1
            self._move(source, to)
        for at, size in sizes.items():
            self._sort(at, target, size)

    def _move(self, source: int, target: int) -> None:
        block = self.piles[source].pop()
        self.piles[target].append(block)
        self.steps.append((block, source, target))
