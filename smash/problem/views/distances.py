"""What it costs at least to bring every block home: shortest ways between places, shared actions split evenly.

The estimate adds up, over the blocks that have to move, the length of a shortest way in a graph of places whose
edges are transfers (pick, place, distance) and the hops of the aggregating actions, each at its cost divided by the
most blocks that share it. An action that moves k blocks pays for k of these edges at most, so the sum never exceeds the
cost of a plan.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from smash.problem.model import TABLE, OnGoal, StacksGoal, State
from smash.problem.rules import Law


class Distances:
    """Least costs of blocks between places; a place is a location, the table region or a station.

    Attributes:
        between: by (origin, target).
        away: from a place to any other.
        back: from a place to another and back.
    """

    def __init__(self, law: Law) -> None:
        instance, options, kinds = law.instance, law.options, law.kinds
        stations = [station for carrier in instance.carriers for station in carrier.stations]
        targets = [*instance.locations, *(stations if any(kind.name == "carry" for kind in kinds) else ())]
        self.places = list(dict.fromkeys([*instance.locations, TABLE, *stations]))
        costs = instance.costs
        both = costs.of("pick") + costs.of("place")
        edges: dict[tuple[str, str], float] = {
            (p, q): both + costs.distance(p, q) for p in self.places for q in targets if p != q
        }
        for kind in kinds:
            for hop in kind.hops(instance, options):
                way = (hop.origin, hop.target)
                edges[way] = min(edges.get(way, math.inf), hop.cost / hop.shared)
        self.between = _shortest(self.places, edges)
        self.away: dict[str, float] = {}
        self.back: dict[str, float] = {}
        for p in self.places:
            leaves = {q: edges[p, q] for q in self.places if (p, q) in edges}
            self.away[p] = min(leaves.values(), default=math.inf)
            self.back[p] = min((cost + self.between[q, p] for q, cost in leaves.items()), default=math.inf)


def _shortest(places: Sequence[str], edges: Mapping[tuple[str, str], float]) -> dict[tuple[str, str], float]:
    """Return all shortest distances (Floyd and Warshall)."""
    length = {(p, q): 0.0 if p == q else edges.get((p, q), math.inf) for p in places for q in places}
    for via in places:
        for p in places:
            first = length[p, via]
            if first == math.inf:
                continue
            for q in places:
                through = first + length[via, q]
                if through < length[p, q]:
                    length[p, q] = through
    return length


class Estimate:
    """The lower bound of a state, and of one block wherever it stands."""

    def __init__(self, law: Law) -> None:
        self.distances = Distances(law)
        goal = law.instance.goal
        self.home: dict[str, tuple[str, int]] = {}
        self.under: dict[str, str] = {}
        self.bottom: frozenset[str] = frozenset()
        self.ontable = self.clear = self.bottom
        if isinstance(goal, OnGoal):
            self.under, self.bottom = dict(goal.on), frozenset(goal.bottom)
            self.ontable, self.clear = frozenset(goal.ontable), frozenset(goal.clear)
        else:
            piles = goal.stacks if isinstance(goal, StacksGoal) else goal.stacks()
            for location, pile in piles.items():
                self.home |= {block: (location, height) for height, block in enumerate(pile, start=1)}
        self.above = {under: upper for upper, under in self.under.items()}
        self.depth: dict[str, int] = {}
        for location, height in self.home.values():
            self.depth[location] = max(height, self.depth.get(location, 0))
        self.whole = isinstance(goal, StacksGoal)

    def of(self, state: State) -> float:
        """Return the bound of a state with an empty hand."""
        total = sum(self.loose(block, TABLE) for block in state.table)
        for carrier, blocks in state.carried.items():
            total += sum(self.loose(block, state.stations[carrier]) for block in blocks)
        return total + sum(self.of_pile(location, pile)[0] for location, pile in state.piles.items())

    def of_pile(self, location: str, pile: Sequence[str]) -> tuple[float, bool]:
        """Return the bound of the blocks of one pile, and whether any of them has to move."""
        total, moves, under = 0.0, False, None
        for height, block in enumerate(pile, start=1):
            moves = moves or self.wrong(block, location, height, under)
            if moves:
                total += self.moving(block, location)
            under = block
        return total, moves

    def wrong(self, block: str, location: str, height: int, under: str | None) -> bool:
        """Return whether a block on blocks that stay has to move."""
        if block in self.home:
            return self.home[block] != (location, height)
        if self.whole or height <= self.depth.get(location, 0):
            return True
        if under is not None and (under in self.clear or block in self.ontable):
            return True
        if block in self.under:
            return self.under[block] != under
        if block in self.bottom:
            return under is not None
        return under is not None and under in self.above

    def moving(self, block: str, location: str) -> float:
        """Return the bound of a block that has to leave its place in a pile."""
        home = self.home.get(block)
        if home is None:
            return self.distances.away[location]
        return self.distances.back[location] if home[0] == location else self.distances.between[location, home[0]]

    def loose(self, block: str, place: str) -> float:
        """Return the bound of a block in the table region or on a carrier."""
        home = self.home.get(block)
        if home is not None:
            return self.distances.between[place, home[0]]
        return self.distances.away[place] if block in self.under or block in self.bottom else 0.0
