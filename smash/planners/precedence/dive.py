"""Feasible choices by a dive: run the events in order and, where none can happen, free the cheapest top block."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from smash.planners.precedence.graph import Floats, PrecedenceGraph


class EventOrder:
    """The events of a graph under a choice that grows: which have happened, which can happen now."""

    def __init__(self, graph: PrecedenceGraph, chosen: Iterable[int] = ()) -> None:
        self.graph = graph
        self.chosen = set(chosen)
        self.freed = np.zeros(len(graph.blocks), dtype=bool)
        self._next_of_pile = [begin for _, begin, _ in graph.piles]
        self._chain_of: dict[int, int] = {}
        for number, chain in enumerate(graph.chains):
            self._chain_of.update((int(block), number) for block in chain)
        self._next_of_chain = [0] * len(graph.chains)
        self._pile_of = {b: number for number, (_, begin, end) in enumerate(graph.piles) for b in range(begin, end)}
        self._blocked_by = {first: number for number, first in enumerate(graph.first) if first >= 0}
        self._settled = 0
        for choice in self.chosen:
            self._mark(choice)

    def free(self, choice: int) -> None:
        """Take one more choice."""
        self.chosen.add(choice)
        self._mark(choice)

    def _mark(self, choice: int) -> None:
        location, low, high, _ = self.graph.choices[choice]
        pile = next(p for p in self.graph.piles if p[0] == location)
        keep = self.graph.demands.keep[location]
        top = keep + pile[2] - pile[1]
        self.freed[pile[1] + top - high : pile[1] + top - low + 1] = True

    def _removed(self, block: int) -> bool:
        pile = self._pile_of.get(block)
        return pile is None or block < self._next_of_pile[pile]

    def _removable(self, block: int) -> bool:
        pile = self._pile_of.get(block)
        return pile is None or block <= self._next_of_pile[pile]

    def run(self) -> bool:
        """Let all happen that can happen; return whether every event has happened."""
        graph = self.graph
        moved = True
        while moved:
            moved = False
            for number, (_, _, end) in enumerate(graph.piles):
                at = self._next_of_pile[number]
                while at < end and (self.freed[at] or not graph.placed[at]):
                    at += 1
                moved = moved or at != self._next_of_pile[number]
                self._next_of_pile[number] = at
            for number, chain in enumerate(graph.chains):
                while self._next_of_chain[number] < len(chain) and self._placeable(
                    int(chain[self._next_of_chain[number]])
                ):
                    block = int(chain[self._next_of_chain[number]])
                    if not self._removed(block):
                        self._next_of_pile[self._pile_of[block]] += 1
                    self._next_of_chain[number] += 1
                    moved = True
        return all(done == len(chain) for done, chain in zip(self._next_of_chain, graph.chains, strict=True))

    def _placeable(self, block: int) -> bool:
        pile = self._blocked_by.get(block)
        if pile is not None and self._next_of_pile[pile] < self.graph.piles[pile][2]:
            return False
        return self._removable(block)

    def stuck_tops(self) -> list[int]:
        """Return the top block of each start pile that can only leave if it is freed."""
        return [at for at, (_, _, end) in zip(self._next_of_pile, self.graph.piles, strict=True) if at < end]


def dive(graph: PrecedenceGraph, values: Floats | None = None) -> set[int]:
    """Return choices that hit every cycle, cheap where `values` (an LP solution) are high; none is superfluous."""
    prices = graph.costs * (1.0 - (np.zeros(len(graph.choices)) if values is None else np.minimum(values, 1.0)))
    forced = {_best(graph, block, prices) for block in graph.must_free}
    order = EventOrder(graph, forced)
    while not order.run():
        tops = order.stuck_tops()
        options = [_best(graph, block, prices, last=True) for block in tops]
        order.free(min(options, key=lambda choice: (prices[choice], choice)))
    return without_superfluous(graph, order.chosen, prices)


def _best(graph: PrecedenceGraph, block: int, prices: Floats, last: bool = False) -> int:
    """Return the cheapest choice that frees `block`; of equals the one that reaches lowest where `last`."""
    candidates = range(int(graph.choice_low[block]), int(graph.choice_high[block]))
    return min(candidates, key=lambda choice: (prices[choice], -choice if last else choice))


def without_superfluous(graph: PrecedenceGraph, chosen: Iterable[int], prices: Floats) -> set[int]:
    """Drop choices, the dearest first, as long as every cycle stays hit."""
    kept = set(chosen)
    for choice in sorted(kept, key=lambda c: (-prices[c], c)):
        trial = kept - {choice}
        if hits_all(graph, trial):
            kept = trial
    return kept


def hits_all(graph: PrecedenceGraph, chosen: Iterable[int]) -> bool:
    """Whether the choices leave no cycle and free every block that has to be."""
    order = EventOrder(graph, chosen)
    return all(order.freed[block] for block in graph.must_free) and order.run()
