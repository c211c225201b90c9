"""The longest acyclic order of a directed graph by simulated annealing (compiled).

The neighbourhood of Galinier, Lemamou and Bouzidi ("Applying local search to the feedback vertex set problem", Journal
of Heuristics 2013): a vertex that is left out is put into the order right after the last of those that lead to it, or
right before the first of those that it leads to; what then stands on the wrong side of it is left out.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from smash.planners.precedence.kernels.numbers import Ints

GAP = 1 << 30
"""Between neighbouring labels after they are given anew."""
MODULUS, FACTOR = 2147483647, 48271
"""Of the random numbers (Park and Miller's generator)."""
LEFT_OUT, BEST, DRAWN, MOVES, CONFLICTS = range(5)
"""Entries of `Order.counters`: vertices left out; the fewest so far; the last random number; moves tried;
with how many vertices the one in hand conflicts."""


class Vertices(NamedTuple):
    """The edges of a graph: those from `v` lead to `to[to_first[v] : to_first[v + 1]]`, those to it come from `of`."""

    to_first: Ints
    to: Ints
    of_first: Ints
    of: Ints


class Order(NamedTuple):
    """An acyclic order as a doubly linked list with rising labels, and the vertices left out.

    The list begins with vertex n and ends with vertex n + 1, which are none of the graph's.
    """

    label: Ints
    """-1 where a vertex is left out."""
    after: Ints
    before: Ints
    outside: Ints
    place: Ints
    """Per vertex left out its place in `outside`."""
    best: Ints
    """1 for the vertices of the longest order so far."""
    conflicts: Ints
    counters: Ints


def anneal_some(vertices: Vertices, order: Order, share: int, total: int, hot: float, cold: float) -> int:
    """Try `share` moves of an annealing of `total` moves; return the fewest vertices left out so far.

    Args:
        vertices: the graph, without loops.
        order: the order in hand.
        share: how many moves to try.
        total: after so many the temperature is `cold`.
        hot: the temperature of the first move, in vertices.
        cold: that of the last.
    """
    counters = order.counters
    for _ in range(share):
        if counters[LEFT_OUT] == 0:
            break
        heat = hot * (cold / hot) ** (counters[MOVES] / total)
        counters[MOVES] += 1
        vertex = order.outside[_draw(order) % counters[LEFT_OUT]]
        after = _draw(order) & 64
        behind = _after_last(vertices, order, vertex) if after else _before_first(vertices, order, vertex)
        conflicts = counters[CONFLICTS]
        if conflicts > 1 and _draw(order) / MODULUS >= math.exp((1 - conflicts) / heat):
            continue
        _insert(order, vertex, behind, conflicts)
        if counters[LEFT_OUT] < counters[BEST]:
            counters[BEST] = counters[LEFT_OUT]
            for other in range(len(order.best)):
                order.best[other] = 1 if order.label[other] >= 0 else 0
    return int(counters[BEST])


def _draw(order: Order) -> int:
    number = order.counters[DRAWN] * FACTOR % MODULUS
    order.counters[DRAWN] = number
    return int(number)


def _after_last(vertices: Vertices, order: Order, vertex: int) -> int:
    """Return what `vertex` would stand right behind, after all that lead to it; note what it would conflict with."""
    behind = len(order.best)
    for entry in range(vertices.of_first[vertex], vertices.of_first[vertex + 1]):
        other = vertices.of[entry]
        if order.label[other] > order.label[behind]:
            behind = other
    count = 0
    for entry in range(vertices.to_first[vertex], vertices.to_first[vertex + 1]):
        other = vertices.to[entry]
        if 0 <= order.label[other] <= order.label[behind]:
            order.conflicts[count] = other
            count += 1
    order.counters[CONFLICTS] = count
    return behind


def _before_first(vertices: Vertices, order: Order, vertex: int) -> int:
    """The same, before all that `vertex` leads to."""
    ahead = len(order.best) + 1
    for entry in range(vertices.to_first[vertex], vertices.to_first[vertex + 1]):
        other = vertices.to[entry]
        if 0 <= order.label[other] < order.label[ahead]:
            ahead = other
    count = 0
    for entry in range(vertices.of_first[vertex], vertices.of_first[vertex + 1]):
        other = vertices.of[entry]
        if order.label[other] >= order.label[ahead]:
            order.conflicts[count] = other
            count += 1
    order.counters[CONFLICTS] = count
    return int(order.before[ahead])


def _insert(order: Order, vertex: int, behind: int, conflicts: int) -> None:
    """Put `vertex` into the order right behind `behind`, and leave its conflicts out."""
    counters = order.counters
    left = counters[LEFT_OUT] - 1
    last = order.outside[left]
    order.outside[order.place[vertex]] = last
    order.place[last] = order.place[vertex]
    for index in range(conflicts):
        other = order.conflicts[index]
        if other == behind:
            behind = order.before[other]
        order.after[order.before[other]] = order.after[other]
        order.before[order.after[other]] = order.before[other]
        order.label[other] = -1
        order.outside[left] = other
        order.place[other] = left
        left += 1
    counters[LEFT_OUT] = left
    ahead = order.after[behind]
    if order.label[ahead] - order.label[behind] < 2:
        _label_anew(order)
    order.label[vertex] = (order.label[behind] + order.label[ahead]) // 2
    order.after[vertex] = ahead
    order.before[vertex] = behind
    order.after[behind] = vertex
    order.before[ahead] = vertex


def _label_anew(order: Order) -> None:
    size = len(order.best)
    label = 0
    vertex = size
    while vertex != size + 1:
        order.label[vertex] = label
        label += GAP
        vertex = order.after[vertex]
    order.label[vertex] = label
