"""Feasible choices by a dive: run the events in order and, where none can happen, free the cheapest top block."""

from __future__ import annotations

from collections.abc import Iterable
from time import perf_counter

import numpy as np

from smash.planners.precedence.graph import Floats, PrecedenceGraph


class EventOrder:
    """Runs the events of a graph under choices, each as soon as it can happen; may be begun anew at will.

    `run` takes time linear in the number of blocks: a pile or a chain is looked at again only where
    something changed for its next block.
    """

    def __init__(self, graph: PrecedenceGraph) -> None:
        self.graph = graph
        size = len(graph.blocks)
        self._chains = [chain.tolist() for chain in graph.chains]
        self._ends = [end for _, _, end in graph.piles]
        self._begins = [begin for _, begin, _ in graph.piles]
        self._placed = graph.placed.tolist()
        self._pile_of = [-1] * size
        self._chain_of = [-1] * size
        for number, (begin, end) in enumerate(zip(self._begins, self._ends, strict=True)):
            self._pile_of[begin:end] = [number] * (end - begin)
        for number, chain in enumerate(self._chains):
            for block in chain:
                self._chain_of[block] = number
        self._above_pile = {first: number for number, first in enumerate(graph.first) if first >= 0}
        pile_number = {location: number for number, (location, _, _) in enumerate(graph.piles)}
        self._spans = []
        for location, low, high, _ in graph.choices:
            number = pile_number[location]
            top = graph.demands.keep[location] + self._ends[number] - self._begins[number]
            self._spans.append((self._begins[number] + top - high, self._begins[number] + top - low + 1))
        self.begin(())

    def begin(self, chosen: Iterable[int]) -> None:
        """Start over under the choices `chosen`."""
        self.freed = bytearray(len(self._placed))
        self._next_of_pile = list(self._begins)
        self._next_of_chain = [0] * len(self._chains)
        self._agenda = list(range(len(self._begins)))
        self._chain_agenda = list(range(len(self._chains)))
        for choice in chosen:
            self._mark(choice)

    def free(self, choice: int) -> None:
        """Take one more choice."""
        self._mark(choice)
        self._agenda.append(self._pile_of[self._spans[choice][0]])

    def _mark(self, choice: int) -> None:
        begin, end = self._spans[choice]
        self.freed[begin:end] = b"\x01" * (end - begin)

    def run(self) -> bool:
        """Let all happen that can happen; return whether every event has happened."""
        while self._agenda or self._chain_agenda:
            while self._agenda:
                self._look_at_pile(self._agenda.pop())
            if self._chain_agenda:
                self._look_at_chain(self._chain_agenda.pop())
        return all(done == len(chain) for done, chain in zip(self._next_of_chain, self._chains, strict=True))

    def _look_at_pile(self, number: int) -> None:
        """Remove what is free to go; wake the chains that waited for it."""
        at, end = self._next_of_pile[number], self._ends[number]
        while at < end and (self.freed[at] or not self._placed[at]):
            if self._placed[at]:
                self._chain_agenda.append(self._chain_of[at])
            at += 1
        self._next_of_pile[number] = at
        if at < end:
            self._chain_agenda.append(self._chain_of[at])
        elif self.graph.first[number] >= 0:
            self._chain_agenda.append(self._chain_of[self.graph.first[number]])

    def _look_at_chain(self, number: int) -> None:
        """Place what can be placed; wake the piles that a block left straight for its place."""
        chain, at = self._chains[number], self._next_of_chain[number]
        while at < len(chain):
            block = chain[at]
            below = self._above_pile.get(block)
            if below is not None and self._next_of_pile[below] < self._ends[below]:
                break
            pile = self._pile_of[block]
            if pile >= 0 and block >= self._next_of_pile[pile]:
                if block > self._next_of_pile[pile]:
                    break
                self._next_of_pile[pile] += 1
                self._agenda.append(pile)
            at += 1
        self._next_of_chain[number] = at

    def stuck_tops(self) -> list[int]:
        """Return the top block of each start pile that can only leave if it is freed."""
        return [at for at, end in zip(self._next_of_pile, self._ends, strict=True) if at < end]

    def hits_all(self, chosen: Iterable[int]) -> bool:
        """Whether the choices leave no cycle and free every block that has to be."""
        self.begin(chosen)
        return all(self.freed[block] for block in self.graph.must_free) and self.run()


def dive(
    graph: PrecedenceGraph, values: Floats | None = None, order: EventOrder | None = None, deadline: float = np.inf
) -> set[int]:
    """Return choices that hit every cycle, cheap where `values` (an LP solution) are high; none is superfluous.

    Args:
        graph: the precedence graph.
        values: one value per choice, in 0 to 1; None: no hint.
        order: the graph's event order, if it was made before.
        deadline: when to stop dropping superfluous choices, in seconds of `time.perf_counter`.
    """
    order = order or EventOrder(graph)
    prices = graph.costs * (1.0 - (np.zeros(len(graph.choices)) if values is None else np.minimum(values, 1.0)))
    chosen = {_best(graph, block, prices) for block in graph.must_free}
    order.begin(chosen)
    while not order.run():
        options = [_best(graph, block, prices, last=True) for block in order.stuck_tops()]
        choice = min(options, key=lambda choice: (prices[choice], choice))
        chosen.add(choice)
        order.free(choice)
    for choice in sorted(chosen, key=lambda c: (-prices[c], c)):
        if perf_counter() > deadline:
            break
        if order.hits_all(chosen - {choice}):
            chosen.remove(choice)
    return chosen


def _best(graph: PrecedenceGraph, block: int, prices: Floats, last: bool = False) -> int:
    """Return the cheapest choice that frees `block`; of equals the one that reaches lowest where `last`."""
    candidates = range(int(graph.choice_low[block]), int(graph.choice_high[block]))
    return min(candidates, key=lambda choice: (prices[choice], -choice if last else choice))
