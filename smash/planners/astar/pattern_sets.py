"""Which sets of blocks the pattern databases are of: sums that are large at the start, built in the time there is."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

from smash.planners.astar.patterns import ENTRIES, FIRST, UNKNOWN
from smash.planners.astar.task import Ints
from smash.problem.model import OnGoal, PlanOptions
from smash.problem.views.numbered import Numbered
from smash.problem.views.targets import goal_piles

MOST_PLACES = 5
"""With more locations the tables are too large for the blocks that they hold, and the bound adds little."""
MOST_ENTRIES = 1 << 25
"""Of one table."""
SHARE = 400_000
"""Entries looked at between two looks at the clock."""
ENTRY_SECONDS = 2e-6
"""About what an entry takes to be reached."""
TABLES = 12
"""The largest tables are taken of which so many can be built in the time."""
SUMS = 2
"""Partitions of the blocks whose sums are kept."""
FRUITLESS = 40
"""Exchanges in a row that raised no sum, after which the next partition is drawn."""


@dataclass(frozen=True, slots=True)
class Patterns:
    """The layout and the tables that `patterns.pattern_bound` reads."""

    layout: Ints
    tables: Ints

    @classmethod
    def none(cls, compiled: bool) -> Patterns:
        """Return patterns that bound nothing."""
        if not compiled:
            return cls([0] * FIRST, [])
        import numpy as np

        return cls(np.zeros(FIRST, dtype="i8"), np.zeros(1, dtype="u1"))  # type: ignore[arg-type]


def takes_patterns(problem: Numbered, options: PlanOptions) -> bool:
    """Whether transfers of single blocks to places that the goal names are all there is, on few locations."""
    return (
        not options.topple
        and not isinstance(problem.instance.goal, OnGoal)
        and not problem.table
        and problem.locations <= MOST_PLACES
    )


@dataclass(frozen=True, slots=True)
class _Cuts:
    """The ways of cutting an order of `size` blocks into piles at `places` locations."""

    ways: Any
    numbers: Any

    @classmethod
    def of(cls, size: int, places: int) -> _Cuts:
        import numpy as np

        ways = [
            (*heights, size - sum(heights))
            for heights in itertools.product(range(size + 1), repeat=places - 1)
            if sum(heights) <= size
        ]
        numbers = np.full(1 + (size + 1) ** (places - 1), -1, dtype="i8")
        numbers[0] = len(ways)
        for number, heights in enumerate(ways):
            cut = 0
            for height in heights[:-1]:
                cut = cut * (size + 1) + height
            numbers[1 + cut] = number
        return cls(np.array(ways, dtype="i8").reshape(-1), numbers)


class PatternBuilder:
    """Builds pattern databases of one problem with the compiled functions `code`."""

    def __init__(self, problem: Numbered, code: Any, seed: int = 0) -> None:
        wanted = goal_piles(problem)
        assert wanted is not None
        # The search numbers the locations with a goal pile first; nothing tells the others apart.
        self._order = sorted(range(problem.locations), key=lambda location: not wanted[location])
        self._goal = [wanted[location] for location in self._order]
        self._start = [problem.start[location] for location in self._order]
        self._blocks = problem.blocks
        self._code = code
        self._draw = random.Random(seed)
        self._cuts: dict[int, _Cuts] = {}

    def build(self, deadline: float) -> Patterns | None:
        """Return the best sums found by `deadline` [s, `time.perf_counter`], None where not one was whole by then."""
        size = self._size(deadline - perf_counter())
        sums: list[tuple[int, list[tuple[int, ...]]]] = []
        known: dict[tuple[int, ...], int] = {}
        climb_until = deadline - SUMS * math.ceil(self._blocks / size) * self._entries(size) * ENTRY_SECONDS

        def value(blocks: tuple[int, ...]) -> int | None:
            if blocks not in known:
                table = self.table(blocks, deadline)
                if table is None:
                    return None
                known[blocks] = int(table[self._number(blocks, self._start)])
            return known[blocks]

        while perf_counter() < climb_until or not sums:
            found = self._climb(size, value, climb_until)
            if found is None:
                break
            sums = sorted([*sums, found], reverse=True)[:SUMS]
            if len(sums[0][1]) == 1:
                break
        partitions = [partition for _, partition in sums]
        tables = {blocks: self.table(blocks, math.inf) for partition in partitions for blocks in partition}
        return self._joined(partitions, tables) if sums else None

    def _size(self, seconds: float) -> int:
        """Return how many blocks a pattern has."""
        size = 2
        while size < self._blocks and self._entries(size + 1) <= min(MOST_ENTRIES, seconds / (TABLES * ENTRY_SECONDS)):
            size += 1
        sets = math.ceil(self._blocks / size)
        return math.ceil(self._blocks / sets)

    def _entries(self, size: int) -> int:
        places = len(self._goal)
        return math.factorial(size) * math.comb(size + places - 1, places - 1)

    def _climb(self, size: int, value: Any, until: float) -> tuple[int, list[tuple[int, ...]]] | None:
        """Draw a partition and exchange blocks between its sets while that raises the sum at the start."""
        blocks = self._draw.sample(range(self._blocks), self._blocks)
        partition = [tuple(sorted(blocks[at :: -(-self._blocks // size)])) for at in range(-(-self._blocks // size))]
        values = [value(part) for part in partition]
        if None in values:
            return None
        fruitless = 0
        while len(partition) > 1 and fruitless < FRUITLESS and perf_counter() < until:
            one, other = self._draw.sample(range(len(partition)), 2)
            out, back = self._draw.choice(partition[one]), self._draw.choice(partition[other])
            exchanged = [
                tuple(sorted({*partition[one], back} - {out})),
                tuple(sorted({*partition[other], out} - {back})),
            ]
            after = [value(part) for part in exchanged]
            if None in after:
                break
            gain = sum(after) - values[one] - values[other]
            fruitless = 0 if gain > 0 else fruitless + 1
            if gain >= 0:
                partition[one], partition[other] = exchanged
                values[one], values[other] = after
        return sum(values), partition

    def table(self, blocks: tuple[int, ...], deadline: float) -> Any:
        """Return the table of a pattern, breadth first from the goal; None where `deadline` passes before."""
        import numpy as np

        size, places = len(blocks), len(self._goal)
        cuts = self._cuts.setdefault(size, _Cuts.of(size, places))
        table = np.full(self._entries(size), UNKNOWN, dtype="u1")
        work = np.zeros(2 * size + places, dtype="i8")
        piles = [[blocks.index(block) for block in pile if block in blocks] for pile in self._goal]
        wanted = np.array([*map(len, piles), *itertools.chain.from_iterable(piles)], dtype="i8")
        depth, found = -1, 1
        while found:
            found = 0
            for begin in range(0, len(table), SHARE):
                if perf_counter() > deadline:
                    return None
                part = table, work, begin, min(len(table), begin + SHARE)
                if depth < 0:
                    found += self._code.mark_goals(size, places, cuts.ways, cuts.numbers, wanted, *part)
                else:
                    found += self._code.spread(size, places, cuts.ways, cuts.numbers, table, work, depth, *part[2:])
            depth += 1
        return table

    def _number(self, blocks: tuple[int, ...], piles: Sequence[tuple[int, ...]]) -> int:
        """Return the number of the arrangement that `piles` leave of the blocks."""
        size = len(blocks)
        cuts = self._cuts.setdefault(size, _Cuts.of(size, len(piles)))
        order = [blocks.index(block) for pile in piles for block in pile if block in blocks]
        cut = 0
        for pile in piles[:-1]:
            cut = cut * (size + 1) + sum(block in blocks for block in pile)
        number = 0
        for index, block in enumerate(order):
            number = number * (size - index) + block - sum(other < block for other in order[:index])
        return number * int(cuts.numbers[0]) + int(cuts.numbers[1 + cut])

    def _joined(self, partitions: list[list[tuple[int, ...]]], tables: dict[tuple[int, ...], Any]) -> Patterns:
        import numpy as np

        listed = [(number, blocks) for number, partition in enumerate(partitions) for blocks in partition]
        head = FIRST + ENTRIES * len(listed)
        places: dict[int, int] = {}
        tail: list[int] = []
        for size in {len(blocks) for _, blocks in listed}:
            places[size] = head + len(tail)
            tail += self._cuts[size].numbers.tolist()
        header = [len(listed), len(self._goal)]
        begin = 0
        for number, blocks in listed:
            header += [len(blocks), begin, number, places[len(blocks)], head + len(tail)]
            tail += [blocks.index(block) if block in blocks else -1 for block in range(self._blocks)]
            begin += len(tables[blocks])
        layout: Any = np.array(header + tail, dtype="i8")
        joined: Any = np.concatenate([tables[blocks] for _, blocks in listed])
        return Patterns(layout, joined)
