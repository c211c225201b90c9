"""Cycles of the precedence graph that a (fractional) choice does not hit, by shortest paths from all blocks at once.

For each block b the shortest way from what follows its removal, `R(b)`, to its placement, `P(b)`, where a
back edge of block c costs how far c is freed; with b's own back edge it closes a cycle. All sources are relaxed
together, as rows of matrices: a start pile and a goal chain are running minima, so that a round costs a
few passes over a blocks x blocks matrix, and there are as many rounds as back edges on the longest path.
"""

from __future__ import annotations

from time import perf_counter

import numpy as np

from smash.planners.precedence.graph import Floats, Ints, PrecedenceGraph

TIE = 1e-6
"""Added to each back edge, so that of two equally cheap paths the one through fewer blocks is taken."""
SOURCES_AT_ONCE = 256


class CycleFinder:
    """Finds violated cycles of one graph; scratch memory is kept between calls."""

    def __init__(self, graph: PrecedenceGraph) -> None:
        self.graph = graph
        size = len(graph.blocks)
        self._chain_of = np.full(size, -1, dtype=np.int64)
        self._pile_of = np.full(size, -1, dtype=np.int64)
        for number, chain in enumerate(graph.chains):
            self._chain_of[chain] = number
        for number, (_, begin, end) in enumerate(graph.piles):
            self._pile_of[begin:end] = number
        self._chain_rank = np.full(size, -1, dtype=np.int64)
        for chain in graph.chains:
            self._chain_rank[chain] = np.arange(len(chain))
        self._lowest_leaving = {
            first: end - 1 for first, (_, _, end) in zip(graph.first, graph.piles, strict=True) if first >= 0
        }
        self.sources: Ints = np.flatnonzero(graph.placed & (self._pile_of >= 0))

    def violated(self, freedom: Floats, below: float, deadline: float = np.inf) -> list[tuple[int, ...]]:
        """Return cycles whose blocks' freedom sums to less than `below`, each as the blocks of its back edges.

        Args:
            freedom: per block, how far it is freed (`PrecedenceGraph.freedom`).
            below: the sum from which on a cycle is not violated.
            deadline: when to return what was found so far, in seconds of `time.perf_counter`.
        """
        weight = freedom + TIE
        candidates = self.sources[freedom[self.sources] < below]
        found: dict[frozenset[int], tuple[float, tuple[int, ...]]] = {}
        for begin in range(0, len(candidates), SOURCES_AT_ONCE):
            if perf_counter() > deadline:
                break
            sources = candidates[begin : begin + SOURCES_AT_ONCE]
            removal, placement = self._distances(sources, weight, below)
            columns = np.arange(len(sources))
            length = placement[sources, columns] + weight[sources]
            for column in np.flatnonzero(length < below):
                cycle = self._trace(int(sources[column]), removal[:, column], placement[:, column], weight)
                total = float(freedom[list(cycle)].sum())
                if total < below:
                    found.setdefault(frozenset(cycle), (total, cycle))
        return [cycle for _, cycle in sorted(found.values())]

    def _distances(self, sources: Ints, weight: Floats, below: float) -> tuple[Floats, Floats]:
        """Return the distances to each removal and to each placement, shape (blocks, sources), inf from `below` on."""
        graph = self.graph
        size, count = len(graph.blocks), len(sources)
        removal = np.full((size, count), np.inf)
        placement = np.full((size, count), np.inf)
        self._start_at(sources, removal, placement)
        movable = self.sources
        while True:
            self._follow_order(removal, placement)
            arrived = placement[movable] + weight[movable, None]
            arrived[arrived >= below] = np.inf
            before = removal[movable]
            if not (arrived < before).any():
                return removal, placement
            removal[movable] = np.minimum(before, arrived)

    def _start_at(self, sources: Ints, removal: Floats, placement: Floats) -> None:
        """Set distance 0 at what follows the removal of each source (other than its own placement)."""
        graph = self.graph
        for column, source in enumerate(sources):
            pile = self._pile_of[source]
            end = graph.piles[pile][2]
            if source + 1 < end:
                removal[source + 1, column] = 0.0
            elif graph.first[pile] >= 0:
                placement[graph.first[pile], column] = 0.0

    def _follow_order(self, removal: Floats, placement: Floats) -> None:
        """Carry distances down each start pile, from removals to placements, and up each goal chain."""
        graph = self.graph
        for first, (_, begin, end) in zip(graph.first, graph.piles, strict=True):
            if end - begin > 1:
                np.minimum.accumulate(removal[begin:end], axis=0, out=removal[begin:end])
            if first >= 0:
                np.minimum(placement[first], removal[end - 1], out=placement[first])
        movable = self.sources
        placement[movable] = np.minimum(placement[movable], removal[movable])
        for chain in graph.chains:
            if len(chain) > 1:
                placement[chain] = np.minimum.accumulate(placement[chain], axis=0)

    def _trace(self, source: int, removal: Floats, placement: Floats, weight: Floats) -> tuple[int, ...]:
        """Walk the shortest path from `P(source)` back to the source; return the blocks whose back edges it uses."""
        used = [source]
        block = source
        while True:
            value = placement[block]
            entry = self._entry_of_chain(block, source, value, removal, placement)
            if entry < 0:
                return self._shortened(used)
            begin = self.graph.piles[self._pile_of[entry]][1]
            if self._pile_of[source] == self._pile_of[entry] and source < entry and value == 0.0:
                return self._shortened(used)
            block = -1
            for candidate in range(entry, begin - 1, -1):
                if self.graph.placed[candidate] and placement[candidate] + weight[candidate] == value:
                    block = candidate
                    break
            if block < 0:  # pragma: no cover - the distances are a fixed point, so a predecessor exists
                raise AssertionError("a shortest path has no predecessor")
            used.append(block)

    def _shortened(self, used: list[int]) -> tuple[int, ...]:
        """Return the cycle in its direction: the removal of each block comes before the placement of the next.

        A path may come back to the source's pile above the source; that block then closes a cycle by itself,
        without the source, as its removal comes before all that follows the source's.
        """
        forward = used[::-1]
        pile = self._pile_of[used[0]]
        for position, block in enumerate(forward):
            if self._pile_of[block] == pile:
                return tuple(forward[: position + 1])
        raise AssertionError("the source lies on its cycle")  # pragma: no cover

    def _entry_of_chain(self, block: int, source: int, value: float, removal: Floats, placement: Floats) -> int:
        """Return the block by whose removal the path entered the chain of `block`, -1 where the source starts there."""
        chain = self.graph.chains[self._chain_of[block]]
        for under in chain[: self._chain_rank[block] + 1]:
            if placement[under] != value:
                continue
            lowest = self._lowest_leaving.get(int(under))
            if lowest is not None and lowest == source and value == 0.0:
                return -1
            if lowest is not None and removal[lowest] == value:
                return lowest
            if self._pile_of[under] >= 0 and removal[under] == value:
                return int(under)
        raise AssertionError("a shortest path has no entry")  # pragma: no cover - as above
