"""Which pebble can be where and when: distances from the start and to the goal, pebble by pebble.

They ignore the other pebbles but for one thing: below a block that has not left its start pile yet stand as many
blocks as at the start, and below one that has come to its goal position as many as there belong.
"""

from __future__ import annotations

from collections import deque
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
    goal = scope.goal[pebble]
    if goal is not None:
        togo = _distances(scope, backward, goal)
    else:
        togo = _spread(backward, [(node, 0) for node in scope.final_nodes(pebble)], len(gadget.nodes))
    return Reach(tuple(edges), earliest, togo)


def _distances(scope: Scope, adjacency: Mapping[int, Sequence[int]], source: int) -> list[int]:
    """Return distances from a settled node, along edges or against them.

    While the pebble stays in that pile it is at its height or above; every other node, the lower ones of the pile
    included, is reached through the pile's top.
    """
    gadget = scope.gadget
    node = gadget.nodes[source]
    count = len(gadget.nodes)
    if node.kind is not NodeKind.STACK or node.location is None:
        return _spread(adjacency, [(source, 0)], count)
    rise = gadget.height - node.key.index
    top = gadget.top(node.location)
    outside = [
        (head, rise + 1)
        for head in adjacency.get(top, ())
        if gadget.nodes[head].location != node.location or (gadget.nodes[head].kind is not NodeKind.STACK)
    ]
    distances = _spread(adjacency, outside, count)
    for height in range(node.key.index, gadget.height + 1):
        inside = gadget.stack_node(node.location, height)
        distances[inside] = min(distances[inside], height - node.key.index)
    return distances


def _adjacency(pairs: Iterable[tuple[int, int]]) -> dict[int, list[int]]:
    lists: dict[int, list[int]] = {}
    for tail, head in pairs:
        lists.setdefault(tail, []).append(head)
    return lists


def _spread(adjacency: Mapping[int, Sequence[int]], seeds: Iterable[tuple[int, int]], count: int) -> list[int]:
    """Breadth-first distances from seeds that are given with theirs (all alike)."""
    distances = [FAR] * count
    queue = deque(seeds)
    for node, distance in queue:
        distances[node] = distance
    while queue:
        node, distance = queue.popleft()
        for head in adjacency.get(node, ()):
            if distances[head] == FAR:
                distances[head] = distance + 1
                queue.append((head, distance + 1))
    return distances
