"""Rank inequalities of a directed graph: of the vertices of a set, at most so many make no cycle (compiled).

In a small set S of vertices at most a(S) can be kept without a cycle, so at least |S| - a(S) must go. For all
subsets of a set of a dozen vertices a(S) follows from a table, by subsets of one vertex less; the sets are grown along
short cycles that the values hit no more than they must.
"""

from __future__ import annotations

from typing import NamedTuple

from smash.planners.precedence.kernels.numbers import Floats, Ints
from smash.planners.precedence.kernels.order import FACTOR, MODULUS


class Rows(NamedTuple):
    """Sets of vertices, `member[first[r] : first[r + 1]]`, and per vertex the sets that hold it."""

    first: Ints
    member: Ints
    of_first: Ints
    of: Ints


class Table(NamedTuple):
    """Scratch: the grown set and, for each of its subsets (as bits), what is known of it."""

    ground: Ints
    leads: Ints
    """Per vertex of the set those that it leads to, as bits."""
    kept: Ints
    """The most vertices of the subset without a cycle."""
    size: Ints
    value: Floats
    score: Floats
    inside: Ints


def best_rank(
    edges: Ints, values: Floats, rows: Rows, table: Table, seed: int, most: int, noise: float, number: int
) -> tuple[int, int, int]:
    """Grow a set from `seed` and return its subset whose inequality the values violate most.

    Args:
        edges: n * n numbers, 1 at `v * n + w` where v leads to w.
        values: per vertex, how far it is left out.
        rows: cycles along which the set is grown.
        table: scratch.
        seed: the first vertex.
        most: vertices of the set.
        noise: how much chance decides.
        number: a random number above 0.

    Returns:
        The subset as bits over `table.ground` (0: none is violated), how many of it must go, and the next number.
    """
    count, number = _grow(values, rows, table, seed, most, noise, number)
    for at in range(count):
        leads = 0
        for other in range(count):
            if edges[table.ground[at] * len(values) + table.ground[other]] == 1:
                leads |= 1 << other
        table.leads[at] = leads
    best = 0
    most_violated = 1e-6
    table.kept[0] = 0
    table.size[0] = 0
    table.value[0] = 0.0
    for subset in range(1, 1 << count):
        _fill(values, table, subset)
        violated = table.size[subset] - table.kept[subset] - table.value[subset]
        if violated > most_violated + 1e-9:
            most_violated = violated
            best = subset
    return best, int(table.size[best] - table.kept[best]), number


def _grow(values: Floats, rows: Rows, table: Table, seed: int, most: int, noise: float, number: int) -> tuple[int, int]:
    """Fill `ground`: next is what most nearly closes rows that the set has a part of. Return its size."""
    for vertex in range(len(values)):
        table.score[vertex] = 0.0
        table.inside[vertex] = 0
    count = 0
    vertex = seed
    while vertex >= 0:
        table.ground[count] = vertex
        table.inside[vertex] = 1
        count += 1
        if count == most:
            break
        for entry in range(rows.of_first[vertex], rows.of_first[vertex + 1]):
            _credit(rows, table, rows.of[entry])
        vertex = -1
        highest = 0.0
        for other in range(len(values)):
            if table.inside[other] == 0 and table.score[other] > 0.0:
                number = number * FACTOR % MODULUS
                score = table.score[other] * (1.0 + noise * number / MODULUS)
                if score > highest:
                    highest = score
                    vertex = other
    return count, number


def _credit(rows: Rows, table: Table, row: int) -> None:
    """Credit the vertices of a row that are not in the set yet, the more the fewer they are."""
    begin, end = rows.first[row], rows.first[row + 1]
    missing = 0
    for entry in range(begin, end):
        if table.inside[rows.member[entry]] == 0:
            missing += 1
    for entry in range(begin, end):
        if table.inside[rows.member[entry]] == 0:
            table.score[rows.member[entry]] += 1.0 / (missing * missing)


def _fill(values: Floats, table: Table, subset: int) -> None:
    """Work out a subset from those with a vertex less: no cycle where one leads nowhere and the rest has none.

    One vertex more keeps at most one more, so that what is one above the first of them is the most.
    """
    kept = 0
    at = 0
    lowest = -1
    enough = 0
    settled = False
    while (1 << at) <= subset:
        bit = 1 << at
        if subset & bit:
            rest = subset ^ bit
            if lowest < 0:
                lowest = at
                enough = table.kept[rest] + 1
            if table.kept[rest] > kept:
                kept = table.kept[rest]
                if kept == enough:
                    break
            if not settled and table.leads[at] & subset == 0:
                settled = True
                if table.kept[rest] == table.size[rest]:
                    kept = table.size[rest] + 1
                    break
        at += 1
    rest = subset & (subset - 1)
    table.kept[subset] = kept
    table.size[subset] = table.size[rest] + 1
    table.value[subset] = table.value[rest] + values[table.ground[lowest]]
