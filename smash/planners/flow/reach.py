"""Which pebble can be where and when: distances from the start and to the goal, pebble by pebble.

They ignore the other pebbles but for one thing: below a block that has not left its start pile yet stand as many
blocks as at the start, and below one that has come to its goal position as many as there belong.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from smash.gadget import NodeKind
from smash.planners.flow.scope import Scope

FAR = 1 << 30
"""A distance that no horizon reaches."""


@dataclass(frozen=True)
class Reach:
    """For one pebble: steps from the start to each node, and from each node to the end."""

    edges: tuple[int, ...]
    earliest: Sequence[int]
    togo: Sequence[int]

    @property
    def shortest(self) -> int:
        """Fewest steps in which the pebble alone reaches its goal."""
        return min((e + t for e, t in zip(self.earliest, self.togo, strict=True)), default=0)


def reach_of(scope: Scope, pebble: int) -> Reach:
    """Return the distances of one pebble."""
    gadget = scope.gadget
    edges = scope.edges_of(pebble)
    pairs = [(gadget.edges[number].tail, gadget.edges[number].head) for number in edges]
    forward, backward = _adjacency(pairs), _adjacency([(head, tail) for tail, head in pairs])
    start = scope.start[pebble]
    earliest = _distances(scope, forward, start)
    goal = scope.goal_of(pebble)
    if goal is not None:
        togo = _distances(scope, backward, goal)
    else:
        togo = _spread(backward, [(node, 0) for node in scope.final_nodes(pebble)], len(gadget.nodes))
    return Reach(tuple(edges), earliest, togo)


def _distances(scope: Scope, adjacency: Mapping[int, Sequence[int]], source: int) -> list[int]:
    """Return distances from a settled node, along edges or against them.

    While the pebble stays in that pile it is at its height or above; every other node, the lower ones of the pile
    included, is reached through the nodes that edges lead out of (or, backward, into) the pile.
    """
    gadget = scope.gadget
    node = gadget.nodes[source]
    count = len(gadget.nodes)
    if node.kind is not NodeKind.STACK or node.location is None:
        return _spread(adjacency, [(source, 0)], count)
    pile = range(node.key.index, gadget.height + 1)
    inside = [gadget.stack_node(node.location, height) for height in pile]
    below = {gadget.stack_node(node.location, height) for height in range(1, gadget.height + 1)}
    outside = [
        (head, steps + 1) for steps, at in enumerate(inside) for head in adjacency.get(at, ()) if head not in below
    ]
    distances = _spread(adjacency, outside, count)
    for steps, at in enumerate(inside):
        distances[at] = min(distances[at], steps)
    return distances


def _adjacency(pairs: Iterable[tuple[int, int]]) -> dict[int, list[int]]:
    lists: dict[int, list[int]] = {}
    for tail, head in pairs:
        lists.setdefault(tail, []).append(head)
    return lists


def _spread(adjacency: Mapping[int, Sequence[int]], seeds: Iterable[tuple[int, int]], count: int) -> list[int]:
    """Breadth-first distances from seeds that are given with theirs."""
    distances = [FAR] * count
    waiting: dict[int, list[int]] = {}
    for node, distance in seeds:
        waiting.setdefault(distance, []).append(node)
    distance = min(waiting, default=0)
    while waiting:
        for node in waiting.pop(distance, ()):
            if distances[node] <= distance:
                continue
            distances[node] = distance
            waiting.setdefault(distance + 1, []).extend(adjacency.get(node, ()))
        distance += 1
    return distances
