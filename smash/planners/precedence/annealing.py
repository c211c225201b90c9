"""An upper bound on the fewest blocks put aside: simulated annealing on an acyclic order of the others."""

from __future__ import annotations

from time import perf_counter

import numpy as np

from smash.planners.precedence.compiled import Kernels
from smash.planners.precedence.kernels.order import GAP, Order
from smash.planners.precedence.turns import TurnGraph

HOT, COLD = 1.2, 0.3
"""Temperatures of the first and the last move, in blocks: ending colder finds worse orders."""
SHARE = 20_000
"""Moves between two looks at the clock: some milliseconds."""


class Annealing:
    """One annealing of one turn graph; `run` may be stopped at any time."""

    def __init__(self, turns: TurnGraph, kernels: Kernels, seed: int) -> None:
        size = len(turns.free)
        self._turns = turns
        self._kernels = kernels
        self._vertices = turns.vertices()
        self._order = Order(
            label=np.append(np.full(size, -1), (0, GAP)),
            after=np.append(np.full(size, -1), (size + 1, -1)),
            before=np.append(np.full(size, -1), (-1, size)),
            outside=np.arange(size),
            place=np.arange(size),
            best=np.zeros(size, dtype=np.int64),
            conflicts=np.zeros(size + 1, dtype=np.int64),
            counters=np.array([size, size, seed * 7919 + 12345, 0, 0]),
        )

    def run(self, moves: int, deadline: float) -> set[int]:
        """Try `moves` moves, or stop at `deadline` [s, `perf_counter`]; return choices that hit every cycle."""
        for tried in range(0, moves, SHARE):
            if perf_counter() > deadline:
                break
            share = min(SHARE, moves - tried)
            self._kernels.anneal_some(self._vertices, self._order, share, moves, HOT, COLD)
        out = self._turns.free[np.asarray(self._order.best) == 0]
        return {*self._turns.forced, *out.tolist()}
