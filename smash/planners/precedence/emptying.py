"""Which piles to empty and which tower to build where: a bound for `on` goals where locations are few.

A tower that is begun anew stands at some location at the end, and all that leaves this location has left it before the
tower's base is placed for good; at the bottom of a location there is one base. The towers' places are chosen, together
with how deep piles are taken off and with what hits the cycles, as clauses over

- `removed[b]`: block b leaves its start pile (2 actions where it may stay, and has to be placed if it is removed);
- `at[t, q]`: the base of tower t is placed for good on location q;
- `under[t, u]`: towers t and u, neither of which has to be at a bottom, are both begun anew at one location, t below u;
- topples (1) of neighbours in a start pile, and `aside[b]` (2): what frees a block from moving directly.

Relations of precedence hold where their condition does, and each cycle of them is a clause: one of its conditions is
not there, or one of the blocks whose back edges it uses is freed (`docs/theory.md`).
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter

from smash.planners.precedence.clauses import Cheapest, Clauses
from smash.planners.precedence.graph import ASIDE_COST, MOVE_COST, TOPPLE_COST, Floats, PrecedenceGraph
from smash.problem.certificate_places import PLACED, REMOVED, Key
from smash.problem.model import OnGoal
from smash.problem.problem import Problem
from smash.problem.views.demands import Pile

Event = tuple[str, str]
"""`(REMOVED, block)` or `(PLACED, block)`."""
MOST_PAIRS = 500_000
"""Larger models take longer to build than they are worth: about 80 locations that are all to be built on anew."""
Edge = tuple[Event, tuple[int, ...], str | None]
"""An event that comes later, the literals under which it does, and the block that moves directly for that, or None."""


@dataclass(frozen=True, slots=True)
class Places:
    """What a solution of the model leaves and builds where.

    Attributes:
        kept: per location how many of its lowest blocks stay.
        at: per base of a tower that is begun anew, its location; of towers at one location the lower ones come first.
    """

    kept: dict[str, int]
    at: dict[str, str]


def bases(problem: Problem) -> frozenset[str]:
    """Return the blocks of an `on` goal that have to be at the bottom of a location at the end of every plan."""
    goal = problem.posed.goal
    assert isinstance(goal, OnGoal)
    loaded = frozenset(goal.on.values())
    falls = problem.options.topple
    lying = frozenset(problem.posed.table)
    return frozenset(goal.bottom) | {b for b in goal.ontable if b in loaded or not (falls or b in lying)}


def places_decide(problem: Problem) -> bool:
    """Whether the towers that are begun anew are more than the locations that are empty at the start."""
    instance = problem.posed
    if not isinstance(instance.goal, OnGoal):
        return False
    empty = sum(not instance.start[q] for q in instance.locations)
    return len(problem.demands.floating) > empty


def emptying_bound(
    problem: Problem,
    graph: PrecedenceGraph,
    cycles: Iterable[tuple[int, ...]],
    deadline: float,
    on_bound: Callable[[int], object],
    threads: int = 1,
    on_places: Callable[[Places], int | None] | None = None,
    maxsat: bool = True,
) -> int:
    """Return a bound on the cost of every plan of an `on` goal; 0 where there was no time for one.

    Args:
        problem: a feasible one.
        graph: its precedence graph.
        cycles: those known of it.
        deadline: when to stop, in seconds of `time.perf_counter`.
        on_bound: called with every better bound at once.
        threads: the solver's threads.
        on_places: called with what each solution keeps and builds where; returns the cost of the best plan known.
        maxsat: whether core-guided MaxSAT solves the model, or HiGHS.
    """
    if too_large(problem):
        return 0
    model = PlacesModel(problem)
    for cycle in cycles:
        model.hit([graph.blocks[block] for block in cycle])
    best = 0

    def tell(cost: int) -> bool:
        nonlocal best
        if model.base + cost > best:
            best = model.base + cost
            on_bound(best)
        return perf_counter() < deadline

    tell(0)
    solver = Cheapest(model.clauses, tell, threads, maxsat)
    while perf_counter() < deadline and (values := solver.solve(deadline)) is not None:
        known = None if on_places is None else on_places(model.places(values))
        if (known is not None and known <= best) or not model.cut_off(values, deadline):
            break
    solver.close()
    return best


def too_large(problem: Problem) -> bool:
    """Whether too many clauses keep towers and locations apart: the model grows as the third power of the locations."""
    goal = problem.posed.goal
    assert isinstance(goal, OnGoal)
    locations, towers, bottoms = len(problem.posed.locations), len(goal.towers()), len(bases(problem))
    return locations * (towers * locations + bottoms**2) // 2 > MOST_PAIRS


class PlacesModel:
    """The clauses of one problem, and the relations from which its cycles come.

    Attributes:
        clauses: those known so far.
        base: what every plan costs beyond them.
        names: per variable, that of the choice in a certificate (`smash.problem.certificate_places`).
        under: per pair of towers whose order is chosen, bases of the lower and of the upper one, its variable.
    """

    def __init__(self, problem: Problem) -> None:
        instance, demands = problem.posed, problem.demands
        goal = instance.goal
        assert isinstance(goal, OnGoal)
        self.problem = problem
        self.clauses = Clauses()
        self.base = 0
        self._towers = goal.towers()
        self._top = {tower[0]: tower[-1] for tower in self._towers}
        self._named = frozenset(block for tower in self._towers for block in tower)
        self._leaving = {block for pile in demands.leaving.values() for block in pile}
        self._forced = self._leaving | (self._named & set(instance.table))
        self._removed: dict[str, int] = {}
        self._frees: dict[str, tuple[int, ...]] = {}
        self._at: dict[tuple[str, str], int] = {}
        self.names: list[Key] = []
        self.under: dict[tuple[str, str], int] = {}
        self._edges: dict[Event, list[Edge]] = {}
        self._forward: dict[str, Edge] = {}
        self.base += MOVE_COST * len(self._named & set(instance.table))
        for location in instance.locations:
            self._add_pile(location, instance.start[location])
        self._choose_places()
        self._relate()
        self._relate_order()

    def _add_pile(self, location: str, pile: Pile) -> None:
        """Add the removals of a start pile, and what frees its blocks."""
        options = self.problem.options
        falls = options.topple and location in self.problem.posed.stacks
        size = min(len(pile), options.max_topple or len(pile))
        lows = range(1, len(pile) - size + 2) if falls and pile else ()
        topples = [self._variable(("topple", location, low, low + size - 1), TOPPLE_COST) for low in lows]
        for height, block in enumerate(pile):
            cost = 0 if falls and block not in self._named else MOVE_COST
            if block in self._forced:
                self.base += cost
            else:
                self._removed[block] = self._variable((REMOVED, block), cost)
            if topples:
                self._frees[block] = tuple(topples[max(0, height - size + 1) : height + 1])
                if block not in self._named:
                    self.clauses.ask([*self._frees[block], *self._unless(self._if_removed(block))])
            elif block in self._named:
                self._frees[block] = (self._variable(("aside", block), ASIDE_COST),)
        for under, upper in itertools.pairwise(pile):
            if upper in self._removed:
                self.clauses.ask([*self._if_removed(upper), *self._unless(self._if_removed(under))])

    def _variable(self, name: Key, cost: int = 0) -> int:
        self.names.append(name)
        return self.clauses.variable(cost)

    def _if_removed(self, block: str) -> tuple[int, ...]:
        """Return the literals under which a block leaves its pile: none where it does in any case."""
        return () if block in self._forced else (self._removed[block],)

    @staticmethod
    def _unless(literals: Iterable[int]) -> list[int]:
        return [-literal for literal in literals]

    def _moves(self, block: str) -> bool:
        return block in self._forced or block in self._removed

    def _choose_places(self) -> None:
        """Give each tower that is begun anew a location."""
        instance = self.problem.posed
        wanted = bases(self.problem)
        grounded = []
        for tower in self._towers:
            base = tower[0]
            if not self._moves(base):
                continue
            for location in instance.locations:
                self._at[base, location] = self._variable(("at", base, location))
            places = [self._at[base, location] for location in instance.locations]
            self.clauses.ask([*places, *self._unless(self._if_removed(base))])
            for one, other in itertools.combinations(places, 2):
                self.clauses.ask([-one, -other])
            if base in wanted:
                grounded.append(base)
        for location in instance.locations:
            pile = instance.start[location]
            for base in grounded:
                if pile and pile[0] not in self._forced:
                    self.clauses.ask([-self._at[base, location], self._removed[pile[0]]])
            for lower, higher in itertools.combinations(grounded, 2):
                self.clauses.ask([-self._at[lower, location], -self._at[higher, location]])
        self._order([tower[0] for tower in self._towers if self._moves(tower[0]) and tower[0] not in wanted])
        self._count_places(wanted)

    def _order(self, loose: Sequence[str]) -> None:
        """Say that of two towers at one location one is below the other, where neither has to be at a bottom."""
        locations = self.problem.posed.locations
        if len(loose) ** 2 * len(locations) // 2 > MOST_PAIRS:
            return
        for one, other in itertools.combinations(loose, 2):
            self.under[one, other] = self._variable(("under", one, other))
            self.under[other, one] = self._variable(("under", other, one))
            either = self.under[one, other], self.under[other, one]
            self.clauses.ask(self._unless(either))
            for location in locations:
                self.clauses.ask([-self._at[one, location], -self._at[other, location], *either])

    def _count_places(self, wanted: frozenset[str]) -> None:
        """As many locations are empty at the start, or emptied, as bottoms are made: the places say so, but slowly."""
        piles = self.problem.posed.start.values()
        # A bottom that stays in its place needs no other; one that leaves it frees a place and needs one.
        at_bottom = {pile[0] for pile in piles if pile}
        made = len(wanted - at_bottom) - sum(not pile for pile in piles)
        emptied = []
        for pile in piles:
            if pile and pile[0] not in wanted:
                if pile[0] in self._forced:
                    made -= 1
                else:
                    emptied.append(self._removed[pile[0]])
        if made > 0:
            self.clauses.counts.append((tuple(emptied), made))

    def _relate(self) -> None:
        """Say what comes before what, and under which literals."""
        start = self.problem.posed.start
        on = {block: upper for tower in self._towers for block, upper in itertools.pairwise(tower)}
        moving = {block for block in self._named if self._moves(block)}
        for pile in start.values():
            for under, upper in itertools.pairwise(pile):
                if self._moves(under) and self._moves(upper):
                    self._edge((REMOVED, upper), (REMOVED, under), self._if_removed(under))
                if self._moves(upper) and under in on and on[under] in moving:
                    conditions = {*self._if_removed(upper), *self._if_removed(on[under])}
                    self._edge((REMOVED, upper), (PLACED, on[under]), tuple(conditions))
            for block in pile:
                if block in moving:
                    self._edge((PLACED, block), (REMOVED, block), (), block)
                    self._forward[block] = self._edge((REMOVED, block), (PLACED, block), self._if_removed(block))
        for under, upper in on.items():
            if under in moving and upper in moving:
                self._edge((PLACED, under), (PLACED, upper), self._if_removed(under))
        for (base, location), place in self._at.items():
            self._relate_place(base, location, place)

    def _relate_place(self, base: str, location: str, place: int) -> None:
        """Say what comes before the base of a tower that is built at a location: what leaves it, and a lower tower."""
        pile = self.problem.posed.start[location]
        lowest = next((block for block in pile if block in self._forced), None)
        for block in pile:
            if block in self._removed or block == lowest:
                conditions = {place, *self._if_removed(block), *self._if_removed(base)}
                self._edge((REMOVED, block), (PLACED, base), tuple(conditions))
        wanted = bases(self.problem)
        if base in wanted:
            return
        for tower in self._towers:
            if tower[0] == base or not self._moves(tower[-1]):
                continue
            conditions = {place, *self._if_removed(base), *self._if_removed(tower[-1])}
            if tower[0] in wanted and self._moves(tower[0]):
                below = {*conditions, self._at[tower[0], location], *self._if_removed(tower[0])}
                self._edge((PLACED, tower[-1]), (PLACED, base), tuple(below))
            if tower[0] in pile and tower[0] not in self._forced:
                stays = self._unless(self._if_removed(tower[0]))
                self._edge((PLACED, tower[-1]), (PLACED, base), (*conditions, *stays))

    def _relate_order(self) -> None:
        """Say that of two towers at one location the lower is whole before the upper one is begun."""
        for (lower, upper), under in self.under.items():
            self._edge((PLACED, self._top[lower]), (PLACED, upper), (under,))

    def _edge(self, earlier: Event, later: Event, conditions: tuple[int, ...], mover: str | None = None) -> Edge:
        edge = later, conditions, mover
        self._edges.setdefault(earlier, []).append(edge)
        return edge

    def hit(self, cycle: Iterable[str]) -> bool:
        """Ask that a block of a cycle that holds in any case is freed; whether that is new."""
        return self.clauses.ask(literal for block in cycle for literal in self._frees[block])

    def places(self, values: Floats) -> Places:
        """Return what a solution keeps and builds where."""
        instance = self.problem.posed
        true = self._true(values)
        kept = {q: sum(not self._is_removed(block, true) for block in pile) for q, pile in instance.start.items()}
        at: dict[str, str] = {}
        for (base, location), place in self._at.items():
            if place in true and self._is_removed(base, true):
                at.setdefault(base, location)

        def height(base: str) -> int:
            return sum(self.under.get((lower, base)) in true for lower in at if at[lower] == at[base])

        return Places(kept, {base: at[base] for base in sorted(at, key=height)})

    def _is_removed(self, block: str, true: set[int]) -> bool:
        return all(literal in true for literal in self._if_removed(block))

    @staticmethod
    def _true(values: Floats) -> set[int]:
        return {number if value > 0.5 else -number for number, value in enumerate(values.tolist(), start=1)}

    def cut_off(self, values: Floats, deadline: float) -> int:
        """Add the cycles that a solution leaves, then those left when a block of each is freed; return how many."""
        true = self._true(values)
        freed = {block for block, literals in self._frees.items() if not true.isdisjoint(literals)}
        edges = {
            event: [edge for edge in following if true.issuperset(edge[1])] for event, following in self._edges.items()
        }
        added = self._cut_off_orders(true)
        while perf_counter() < deadline:
            found = self._cycles_left(edges, true, freed, deadline)
            if not found:
                break
            for clause, movers in found:
                added += self.clauses.ask(clause)
                if freed.isdisjoint(movers):
                    freed.add(min(movers))
        return added

    def violated(self, values: Floats, most: float, deadline: float) -> Iterable[Loop]:
        """Yield short cycles whose clauses values fulfil to less than `most`, one a block or order of two towers.

        Args:
            values: per variable, from 0 to 1.
            most: see above.
            deadline: when to stop [s, `perf_counter`].
        """
        missing = [0.0, *(1.0 - values).tolist(), *reversed(values.tolist())]  # by literal, negative ones from the end
        freed = {block: sum(values[literal - 1] for literal in literals) for block, literals in self._frees.items()}
        weighed = {
            event: [
                (long, edge)
                for edge in following
                if (long := self._missing(edge, missing) + (freed[edge[2]] if edge[2] else 0.0)) < most
            ]
            for event, following in self._edges.items()
        }
        searches: list[tuple[Event, Event, float, Edge | None, frozenset[int]]] = [
            ((REMOVED, block), (PLACED, block), freed[block], self._forward[block], frozenset())
            for block in self._frees
            if block in self._named
        ]
        for (lower, upper), literal in self.under.items():
            searches.append(((PLACED, upper), (PLACED, self._top[lower]), missing[literal], None, frozenset({literal})))
        for first, last, closing, without, literals in searches:
            if perf_counter() > deadline:
                return
            if closing >= most or (found := _shortest(first, last, weighed, without, most - closing)) is None:
                continue
            way = found[1]
            used = literals.union(*(edge[1] for _, edge in way))
            yield Loop([event for event, _ in way] + [last], used)

    @staticmethod
    def _missing(edge: Edge, missing: Sequence[float]) -> float:
        """Return how far the conditions of an edge are from holding, and a little for each edge."""
        return 1e-5 + sum(missing[literal] for literal in edge[1])

    def _cut_off_orders(self, true: set[int]) -> int:
        """Add that of three towers none is below the next all round, where a solution says so; return how often."""
        above: dict[str, set[str]] = {}
        for (lower, upper), under in self.under.items():
            if under in true:
                above.setdefault(lower, set()).add(upper)
        added = 0
        for lower, middle in [(lower, middle) for lower, over in above.items() for middle in over]:
            for upper in above.get(middle, ()):
                if lower in above.get(upper, ()):
                    pairs = (lower, middle), (middle, upper), (upper, lower)
                    added += self.clauses.ask(self._unless(self.under[pair] for pair in pairs))
        return added

    def _cycles_left(
        self, edges: Mapping[Event, list[Edge]], true: set[int], freed: set[str], deadline: float
    ) -> list[tuple[list[int], list[str]]]:
        """Return a short cycle through each block that is not freed, as clauses, with the blocks that move directly."""
        found = []
        weighed = {
            event: [
                (len(edge[1]) + (edge[2] is not None), edge)
                for edge in following
                if edge[2] is None or edge[2] not in freed
            ]
            for event, following in edges.items()
        }
        for block in self._frees:
            if perf_counter() > deadline:
                break
            if block in freed or block not in self._named or not self._is_removed(block, true):
                continue
            found_way = _shortest((REMOVED, block), (PLACED, block), weighed, self._forward[block], math.inf)
            if found_way is not None:
                edges_used = [edge for _, edge in found_way[1]]
                conditions = [literal for _, literals, _ in edges_used for literal in literals]
                movers = [block, *(mover for _, _, mover in edges_used if mover is not None)]
                clause = [*self._unless(conditions), *(literal for one in movers for literal in self._frees[one])]
                found.append((clause, movers))
        return found


@dataclass(frozen=True, slots=True)
class Loop:
    """A cycle of events, each before the next, and the conditions of that as literals."""

    events: list[Event]
    literals: frozenset[int]


def _shortest(
    first: Event, last: Event, edges: Mapping[Event, Sequence[tuple[float, Edge]]], without: Edge | None, most: float
) -> tuple[float, list[tuple[Event, Edge]]] | None:
    """Return the length and the edges, with the events that they begin at, of a shortest way; None: `most` or longer.

    Args:
        first: where it begins.
        last: where it ends.
        edges: with their lengths, by the earlier event.
        without: one that is not used.
        most: how long it must not be.
    """
    came: dict[Event, tuple[Event, Edge]] = {}
    length = {first: 0.0}
    waiting = [(0.0, first)]
    while waiting:
        so_far, event = heapq.heappop(waiting)
        if event == last:
            break
        if so_far > length[event]:
            continue
        for long, edge in edges.get(event, ()):
            reached = so_far + long
            if edge is not without and reached < min(most, length.get(edge[0], math.inf)):
                length[edge[0]] = reached
                came[edge[0]] = (event, edge)
                heapq.heappush(waiting, (reached, edge[0]))
    if last not in came:
        return None
    way: list[tuple[Event, Edge]] = []
    event = last
    while event != first:
        event, edge = came[event]
        way.append((event, edge))
    return length[last], way[::-1]
