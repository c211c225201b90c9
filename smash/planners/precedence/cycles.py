"""Cycles of the precedence graph that a (fractional) choice does not hit: for each block the cheapest through it.

For block b it is the shortest way from what follows its removal, `R(b)`, to its placement, `P(b)`, where a back edge of
block c costs how far c is freed; with b's own back edge it closes a cycle (`kernels/paths.py`).
"""

from __future__ import annotations

from collections import Counter
from time import perf_counter
from typing import Any

import numpy as np

from smash.planners.precedence.compiled import INTERPRETED, Kernels
from smash.planners.precedence.graph import Floats, Ints, PrecedenceGraph
from smash.planners.precedence.kernels.paths import NONE, Events, Work

TIE = 1e-6
"""Added to each back edge, so that of two equally cheap paths the one through fewer blocks is taken."""

MOST_OF_A_PILE = 4
"""Cycles through one start pile at a time where a topple frees many of its blocks at once: their rows are alike."""


class CycleFinder:
    """Finds violated cycles of one graph; scratch memory is kept between calls."""

    def __init__(self, graph: PrecedenceGraph) -> None:
        size = len(graph.blocks)
        under, first, following = [NONE] * size, [NONE] * size, [NONE] * size
        self._pile_of = [NONE] * size
        for number, (begins, (_, begin, end)) in enumerate(zip(graph.first, graph.piles, strict=True)):
            under[begin : end - 1] = range(begin + 1, end)
            first[end - 1] = begins
            self._pile_of[begin:end] = [number] * (end - begin)
        for chain in graph.chains:
            for block, above in zip(chain[:-1].tolist(), chain[1:].tolist(), strict=True):
                following[block] = above
        moves = [int(placed and pile >= 0) for placed, pile in zip(graph.placed.tolist(), self._pile_of, strict=True)]
        self.sources: Ints = np.flatnonzero(np.array(moves, dtype=bool))
        self._events = Events(under, first, following, moves)
        self._work = Work([0] * size, [0] * size, [NONE] * size, [0.0] * (size + 1), [NONE] * (size + 1), [0])
        self._searches = 0
        self._most = MOST_OF_A_PILE if len(graph.choices) < len(self.sources) else size
        self._kernels = INTERPRETED

    def use(self, kernels: Kernels) -> None:
        """Go on with compiled kernels."""
        if kernels.compiled and not self._kernels.compiled:
            self._kernels = kernels
            self._events = Events(*(_array(numbers) for numbers in self._events))
            self._work = Work(*(_array(numbers) for numbers in self._work))

    def violated(self, freedom: Floats, below: float, deadline: float = np.inf) -> list[tuple[int, ...]]:
        """Return cycles whose blocks' freedom sums to less than `below`, each as the blocks of its back edges.

        If there are any, some are found, through each block or through others of its pile.

        Args:
            freedom: per block, how far it is freed (`PrecedenceGraph.freedom`).
            below: the sum from which on a cycle is not violated.
            deadline: when to return what was found so far, in seconds of `time.perf_counter`.
        """
        weight: Any = freedom + TIE
        if not self._kernels.compiled:
            weight = weight.tolist()
        candidates = self.sources[freedom[self.sources] < below]
        found: dict[frozenset[int], tuple[float, tuple[int, ...]]] = {}
        through: Counter[int] = Counter()
        for source in candidates.tolist():
            if perf_counter() > deadline:
                break
            if through[self._pile_of[source]] >= self._most:
                continue
            self._searches += 1
            if self._kernels.cheapest_cycle(self._events, self._work, weight, source, below, self._searches):
                cycle = self._cycle(source)
                total = float(freedom[list(cycle)].sum())
                if total < below:
                    through[self._pile_of[source]] += 1
                    found.setdefault(frozenset(cycle), (total, cycle))
        return [cycle for _, cycle in sorted(found.values())]

    def _cycle(self, source: int) -> tuple[int, ...]:
        """Return the cycle found in its direction: the removal of each block comes before the placement of the next.

        A path may come back to the source's pile above the source; that block then closes a cycle by itself,
        without the source, as its removal comes before all that follows the source's.
        """
        backward = [source]
        block = int(self._work.came_from[source])
        while block != source:
            backward.append(block)
            block = int(self._work.came_from[block])
        forward = [*backward[:0:-1], source]
        pile = self._pile_of[source]
        end = next(at for at, passed in enumerate(forward) if self._pile_of[passed] == pile)
        return tuple(forward[: end + 1])


def _array(numbers: Any) -> Any:
    """Return the numbers of a list as an array of integers or floats."""
    return np.array(numbers)
