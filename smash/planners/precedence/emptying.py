"""Which piles to empty: a bound for `on` goals where locations are few, joined with the hitting set in one model.

Each block that has to be at a bottom, and is not or leaves its own, needs a location that was empty from the start or
whose lowest block leaves. Which piles those are is chosen, together with what hits the cycles: per block b

- `removed[b]`: b leaves its start pile; so does all that stood on it;
- `moved[b]` (2 actions): b is picked and placed; what the goal gives a place must be if it is removed;
- `fallen[b]`: a topple is b's first removal, one of the `topples` (1 action each) of neighbours in the start pile;
- `aside[b]` (2 more): b is picked and placed twice; on each cycle some block is put aside or falls (`docs/theory.md`).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np

from smash.planners.milp.arrays import MilpBuilder, OutOfTime
from smash.planners.milp.solvers import highs
from smash.planners.precedence.cycles import CycleFinder
from smash.planners.precedence.graph import ASIDE_COST, MOVE_COST, TOPPLE_COST, Floats, PrecedenceGraph
from smash.problem.model import Instance, OnGoal
from smash.problem.problem import Problem


def bases(problem: Problem) -> frozenset[str]:
    """Return the blocks of an `on` goal that have to be at the bottom of a location at the end of every plan."""
    goal = problem.posed.goal
    assert isinstance(goal, OnGoal)
    loaded = frozenset(goal.on.values())
    falls = problem.options.topple
    lying = frozenset(problem.posed.table)
    return frozenset(goal.bottom) | {b for b in goal.ontable if b in loaded or not (falls or b in lying)}


def piles_decide(problem: Problem) -> bool:
    """Whether more locations have to be emptied than are empty or emptied in any case."""
    instance = problem.posed
    if not isinstance(instance.goal, OnGoal):
        return False
    wanted, keep = bases(problem), problem.demands.keep
    stay = {instance.start[q][0] for q in instance.locations if keep[q]}
    free = sum(not keep[q] for q in instance.locations)
    return len(wanted - stay) > free


def emptying_bound(
    problem: Problem,
    graph: PrecedenceGraph,
    cycles: Iterable[tuple[int, ...]],
    deadline: float,
    on_bound: Callable[[int], object],
    threads: int = 1,
    on_choice: Callable[[dict[str, int]], object] | None = None,
) -> int:
    """Return a bound on the cost of every plan of an `on` goal; 0 where there was no time for one.

    Args:
        problem: a feasible one.
        graph: its precedence graph.
        cycles: those known of it.
        deadline: when to stop, in seconds of `time.perf_counter`.
        on_bound: called with every better bound at once.
        threads: the solver's threads.
        on_choice: called with what each solution keeps: per location how many of its lowest blocks.
    """
    finder = CycleFinder(graph)
    known = list(cycles)
    unit = 1 if problem.options.topple else MOVE_COST
    bound = 0
    while perf_counter() < deadline:
        try:
            model = _Model(problem, graph, deadline)
            for cycle in known:
                model.hit(cycle)
            milp = model.builder.build()
        except OutOfTime:
            break
        solved = highs.solve(
            milp, time_limit=deadline - perf_counter(), threads=threads, seed=1, absolute_gap=unit - 0.001
        )
        if math.isfinite(solved.bound):
            proven = unit * math.ceil(solved.bound / unit - 1e-6)
            if proven > bound:
                bound = proven
                on_bound(bound)
        if solved.status != "optimal" or solved.vector is None:
            break
        if on_choice is not None:
            on_choice(model.kept(solved.vector))
        left = _left(finder, model.freedom(solved.vector), deadline)
        if not left:
            break
        known.extend(left)
    return bound


def _left(finder: CycleFinder, freedom: Floats, deadline: float) -> list[tuple[int, ...]]:
    """Return the cycles that a solution leaves, then those left when a block of each is freed, and so on."""
    found: list[tuple[int, ...]] = []
    while cycles := finder.violated(freedom, 0.5, deadline):
        found.extend(cycles)
        for cycle in cycles:
            if not freedom[list(cycle)].any():
                freedom[min(cycle)] = 1.0
    return found


@dataclass(slots=True)
class _Model:
    """The model of one problem: columns by block, and the rows of the cycles."""

    problem: Problem
    graph: PrecedenceGraph
    deadline: float
    builder: MilpBuilder = field(init=False)
    removed: dict[str, int] = field(default_factory=dict)
    moved: dict[str, int] = field(default_factory=dict)
    fallen: dict[str, int] = field(default_factory=dict)
    aside: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.builder = MilpBuilder(self.deadline)
        instance, demands = self.problem.posed, self.problem.demands
        leaving = {block for pile in demands.leaving.values() for block in pile}
        placed = _placed_if_removed(instance)
        for block in instance.blocks:
            lies = block in instance.table
            must = block in leaving or (lies and block in demands.placed)
            self.removed[block] = self._column(0, lower=float(must))
            self.moved[block] = self._column(MOVE_COST)
            if block in placed or lies:
                self._row([(self.moved[block], 1), (self.removed[block], -1)], 0)
        for index, block in enumerate(self.graph.blocks):
            if self.graph.placed[index] and block not in instance.table:
                self.aside[block] = self._column(ASIDE_COST)
        for location in instance.locations:
            self._pile(instance, location)
        self._empty_places(instance)

    def _pile(self, instance: Instance, location: str) -> None:
        """Add what a start pile's blocks wait for, and its topples."""
        pile, options = instance.start[location], self.problem.options
        for under, upper in itertools.pairwise(pile):
            self._row([(self.removed[upper], 1), (self.removed[under], -1)], 0)
        topples: list[int] = []
        size = min(len(pile), options.max_topple or len(pile))
        if options.topple and location in instance.stacks and pile:
            topples = [self._column(TOPPLE_COST) for _ in range(len(pile) - size + 1)]
        for height, block in enumerate(pile):
            if not topples:
                self._row([(self.moved[block], 1), (self.removed[block], -1)], 0)
                continue
            self.fallen[block] = self._column(0)
            self._row([(self.moved[block], 1), (self.fallen[block], 1), (self.removed[block], -1)], 0)
            taking = topples[max(0, height - size + 1) : height + 1]
            self._row([*((topple, 1.0) for topple in taking), (self.fallen[block], -1)], 0)

    def _empty_places(self, instance: Instance) -> None:
        """As many locations are empty from the start, or emptied, as bottoms are made."""
        wanted = bases(self.problem)
        made, entries = 0, []
        for pile in instance.start.values():
            if not pile:
                made -= 1
            elif pile[0] not in wanted:
                entries.append((self.removed[pile[0]], 1.0))
        # A bottom that stays in its place needs no other; one that leaves it frees a place and needs one.
        at_bottom = {pile[0] for pile in instance.start.values() if pile}
        made += len(wanted - at_bottom)
        self._row(entries, made)

    def hit(self, cycle: Iterable[int]) -> None:
        """Add the row of a cycle."""
        blocks = [self.graph.blocks[block] for block in cycle]
        columns = [column[block] for block in blocks for column in (self.aside, self.fallen) if block in column]
        self._row([(column, 1.0) for column in columns], 1)

    def kept(self, vector: Floats) -> dict[str, int]:
        """Return per location how many of its lowest blocks a solution leaves where they are."""
        start = self.problem.posed.start
        return {at: sum(vector[self.removed[block]] < 0.5 for block in pile) for at, pile in start.items()}

    def freedom(self, vector: Floats) -> Floats:
        """Return per block of the graph 1 where it does not move directly in a solution."""
        freed = [
            sum(vector[column[block]] for column in (self.aside, self.fallen) if block in column)
            for block in self.graph.blocks
        ]
        rounded: Floats = np.round(np.minimum(1.0, np.array(freed, dtype=float)))
        return rounded

    def _column(self, cost: float, lower: float = 0.0) -> int:
        return int(self.builder.add_columns(1, cost=cost, lower=lower)[0])

    def _row(self, entries: Iterable[tuple[int, float]], lower: float) -> None:
        listed = list(entries)
        columns, values = [column for column, _ in listed], [value for _, value in listed]
        self.builder.add_rows([0] * len(listed), columns, values, count=1, lower=lower)


def _placed_if_removed(instance: Instance) -> frozenset[str]:
    """Return the blocks that the goal wants in some pile: the table region is no place for them."""
    goal = instance.goal
    assert isinstance(goal, OnGoal)
    return frozenset(goal.on) | frozenset(goal.on.values()) | frozenset(goal.bottom)
