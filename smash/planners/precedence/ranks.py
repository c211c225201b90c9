"""Rank inequalities that a fractional choice violates: of small sets of blocks, so many have to be put aside.

They cut off what rows of single cycles leave (three blocks that wait for each other in pairs are hit by halves; two of
them have to be put aside), and take the relaxation most of the way from the cycles' bound to the optimum.
"""

from __future__ import annotations

from collections.abc import Iterable
from time import perf_counter

import numpy as np

from smash.planners.precedence.compiled import Kernels
from smash.planners.precedence.graph import Floats
from smash.planners.precedence.kernels.order import MODULUS
from smash.planners.precedence.kernels.ranks import Rows, Table
from smash.planners.precedence.turns import TurnGraph

MOST_VERTICES = 14
"""Of a set: the tables have an entry for each of its subsets."""
FRACTIONAL = 0.02
"""How far a value is from 0 and 1 for its block to be the first of a set."""

Rank = tuple[frozenset[int], int]
"""A set of choices, and how many of them have to be taken."""


class RankFinder:
    """Finds violated rank inequalities of one turn graph."""

    def __init__(self, turns: TurnGraph, kernels: Kernels) -> None:
        size, subsets = len(turns.edges), 1 << MOST_VERTICES
        self._kernels = kernels
        self._edges = turns.edges.reshape(-1)
        self._forced = turns.forced
        self._free = turns.free
        self._number = 1
        self._table = Table(
            ground=np.zeros(MOST_VERTICES, dtype=np.int64),
            leads=np.zeros(MOST_VERTICES, dtype=np.int64),
            kept=np.zeros(subsets, dtype=np.int8),
            size=np.zeros(subsets, dtype=np.int8),
            value=np.zeros(subsets),
            score=np.zeros(size),
            inside=np.zeros(size, dtype=np.int8),
        )

    def violated(
        self, values: Floats, rows: Iterable[frozenset[int]], most: int, noise: float, deadline: float = np.inf
    ) -> list[Rank]:
        """Return inequalities that `values` violate, the most violated of each set that was looked at.

        Args:
            values: one value per choice.
            rows: cycles along which sets are grown: those that the values hit hardly more than once.
            most: vertices of a set, at most `MOST_VERTICES`.
            noise: how much chance decides about the sets.
            deadline: when to return what was found so far, in seconds of `time.perf_counter`.
        """
        arrays = _arrays([sorted(row) for row in rows if self._forced.isdisjoint(row)], len(values))
        found: dict[frozenset[int], int] = {}
        for seed in self._free[(values[self._free] > FRACTIONAL) & (values[self._free] < 1.0 - FRACTIONAL)].tolist():
            if perf_counter() > deadline:
                break
            subset, needed, self._number = self._kernels.best_rank(
                self._edges, values, arrays, self._table, seed, most, noise, self._number
            )
            assert 0 < self._number < MODULUS
            if subset:
                members = self._table.ground[[at for at in range(most) if subset >> at & 1]]
                found[frozenset(members.tolist())] = needed
        return list(found.items())


def _arrays(rows: list[list[int]], size: int) -> Rows:
    """Return rows as arrays, and per vertex the rows that hold it."""
    first = np.concatenate(([0], np.cumsum([len(row) for row in rows]))).astype(np.int64)
    member = np.array([vertex for row in rows for vertex in row], dtype=np.int64)
    number = np.repeat(np.arange(len(rows)), np.diff(first))
    by_vertex = np.argsort(member, kind="stable")
    of_first = np.concatenate(([0], np.cumsum(np.bincount(member, minlength=size)))).astype(np.int64)
    return Rows(first, member, of_first, number[by_vertex])
