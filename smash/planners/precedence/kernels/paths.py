"""The cheapest cycle through a block, by a shortest path over the events of the precedence graph (compiled).

A path goes down a start pile and up a goal chain for nothing and pays a block's weight where it takes its back edge.
Events are reached in the order of their distance, each once: a pile or a chain is followed only as far as no path
before has come.
"""

from __future__ import annotations

from typing import NamedTuple

from smash.planners.precedence.kernels.numbers import Floats, Ints

NONE = -1
HELD = 0
"""The entry of `Work.counters` that says how many blocks wait in the heap."""


class Events(NamedTuple):
    """What follows each block's events, as numbers of blocks; -1 for nothing."""

    under: Ints
    """The next lower block that must leave the same start pile."""
    first: Ints
    """For the lowest that must leave: what is placed first on what stays there."""
    following: Ints
    """The next of its goal chain."""
    moves: Ints
    """1 where a block leaves a start pile and is placed: it can move directly."""


class Work(NamedTuple):
    """Scratch of one search; what does not bear the search's number is of one before."""

    removed: Ints
    placed: Ints
    came_from: Ints
    """Per block reached: the block whose removal reached its placement."""
    distances: Floats
    waiting: Ints
    counters: Ints


def cheapest_cycle(events: Events, work: Work, weight: Floats, source: int, below: float, number: int) -> bool:
    """Look for the cheapest cycle through the back edge of `source`; `came_from` leads round it, from `source` back.

    Args:
        events: of the graph.
        work: scratch.
        weight: per block what its back edge costs, more than 0.
        source: the block.
        below: only cycles cheaper than this are looked for.
        number: of this search, different from all before it.

    Returns:
        Whether there is one.
    """
    work.counters[HELD] = 0
    distance = weight[source]
    block = source
    while distance < below:
        if _leave(events, work, weight, block, source, distance, below, number):
            return True
        if work.counters[HELD] == 0:
            return False
        distance = work.distances[0]
        block = work.waiting[0]
        _drop_first(work)
    return False


def _leave(
    events: Events, work: Work, weight: Floats, block: int, source: int, distance: float, below: float, number: int
) -> bool:
    """Follow what comes after the removal of `block`; return whether the placement of `source` is among it."""
    found = False
    lowest = block
    lower = events.under[block]
    while lower >= 0:
        if work.removed[lower] == number:
            return found
        work.removed[lower] = number
        if events.moves[lower] == 1 and _build(events, work, weight, lower, block, source, distance, below, number):
            found = True
        lowest = lower
        lower = events.under[lower]
    begin = events.first[lowest]
    if begin >= 0 and _build(events, work, weight, begin, block, source, distance, below, number):
        found = True
    return found


def _build(
    events: Events,
    work: Work,
    weight: Floats,
    block: int,
    by: int,
    source: int,
    distance: float,
    below: float,
    number: int,
) -> bool:
    """Follow the placements from `block` up its chain, reached through the removal of `by`."""
    found = False
    while block >= 0 and work.placed[block] != number:
        work.placed[block] = number
        work.came_from[block] = by
        if block == source:
            found = True
        elif events.moves[block] == 1 and work.removed[block] != number and distance + weight[block] < below:
            _hold(work, block, distance + weight[block])
        block = events.following[block]
    return found


def _hold(work: Work, block: int, distance: float) -> None:
    """Put a block into the heap."""
    place = work.counters[HELD]
    work.counters[HELD] = place + 1
    while place > 0:
        parent = (place - 1) // 2
        if work.distances[parent] <= distance:
            break
        work.distances[place] = work.distances[parent]
        work.waiting[place] = work.waiting[parent]
        place = parent
    work.distances[place] = distance
    work.waiting[place] = block


def _drop_first(work: Work) -> None:
    """Take the nearest block off the heap."""
    size = work.counters[HELD] - 1
    work.counters[HELD] = size
    distance = work.distances[size]
    block = work.waiting[size]
    place = 0
    while True:
        child = 2 * place + 1
        if child >= size:
            break
        if child + 1 < size and work.distances[child + 1] < work.distances[child]:
            child += 1
        if work.distances[child] >= distance:
            break
        work.distances[place] = work.distances[child]
        work.waiting[place] = work.waiting[child]
        place = child
    work.distances[place] = distance
    work.waiting[place] = block
