"""The time-expanded graph as arrays: one arc per pebble, edge (or wait) and step in which it can be of use."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from smash.gadget import NodeKind
from smash.planners.flow.reach import Reach, reach_of
from smash.planners.flow.scope import Scope
from smash.planners.milp.arrays import Ints

WAIT = -1
"""The edge number of an arc on which a pebble stays where it is."""


@dataclass(frozen=True)
class Arcs:
    """Arcs of the time-expanded graph; all arrays have shape (arcs,). Arc j is column j of the model.

    Attributes:
        horizon: number of steps T.
        pebble: the pebble.
        edge: number of the gadget's edge, or `WAIT`.
        tail: node left, at layer `step`.
        head: node entered, at layer `step` + 1.
        step: the step, 0 to T - 1.
    """

    horizon: int
    pebble: Ints
    edge: Ints
    tail: Ints
    head: Ints
    step: Ints

    def __len__(self) -> int:
        return len(self.pebble)


def reaches_of(scope: Scope) -> dict[int, Reach]:
    """Return the distances of every moving pebble and every token."""
    return {pebble: reach_of(scope, pebble) for pebble in scope.pebbles}


def count_arcs(scope: Scope, reaches: dict[int, Reach], horizon: int) -> int:
    """Return how many arcs there are, without making them."""
    return int(sum(_windows(scope, reaches[pebble], horizon)[3].sum() for pebble in scope.pebbles))


def arcs_of(scope: Scope, reaches: dict[int, Reach], horizon: int) -> Arcs:
    """Make the arcs of a horizon: those on a path from the pebble's start to its goal that fits into it."""
    columns: list[list[Ints]] = [[], [], [], [], []]
    for pebble in scope.pebbles:
        edge, (tail, head), first, length = _windows(scope, reaches[pebble], horizon)
        row = np.repeat(np.arange(len(edge)), length)
        offset = np.arange(len(row)) - np.repeat(np.cumsum(length) - length, length)
        parts = (np.full(len(row), pebble), edge[row], tail[row], head[row], first[row] + offset)
        for column, part in zip(columns, parts, strict=True):
            column.append(part)
    joined = [np.concatenate(column) if column else np.zeros(0, dtype=np.int64) for column in columns]
    return Arcs(horizon, *joined)


def _windows(scope: Scope, reach: Reach, horizon: int) -> tuple[Ints, tuple[Ints, Ints], Ints, Ints]:
    """Return edge, (tail, head), first step and number of steps of all that one pebble can do."""
    gadget = scope.gadget
    waits = [number for number, node in enumerate(gadget.nodes) if node.kind is not NodeKind.INTERFACE]
    edge = np.array([*reach.edges, *([WAIT] * len(waits))], dtype=np.int64)
    tail = np.array([*(gadget.edges[number].tail for number in reach.edges), *waits], dtype=np.int64)
    head = np.array([*(gadget.edges[number].head for number in reach.edges), *waits], dtype=np.int64)
    earliest, togo = np.array(reach.earliest, dtype=np.int64), np.array(reach.togo, dtype=np.int64)
    first = np.maximum(earliest[tail], earliest[head] - 1)
    last = np.minimum(horizon - togo[tail], horizon - 1 - togo[head])
    useful = last >= first
    return edge[useful], (tail[useful], head[useful]), first[useful], (last - first + 1)[useful]
