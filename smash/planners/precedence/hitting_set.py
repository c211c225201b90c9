"""The cheapest choices that hit every cycle: cuts on the LP relaxation, then on integer solutions.

Rows are added as cycles are found violated. Where each block is put aside by itself the choices are a directed feedback
vertex set; if a second does not settle that, an annealed set comes next, and then core-guided MaxSAT where
there are not too many blocks for it, rank inequalities and integer solves elsewhere. Where a topple frees several
blocks there is no annealed set and no rank inequality; the rest is the same.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import islice
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from smash.planners.precedence.compiled import INTERPRETED, Kernels
from smash.planners.precedence.cycles import CycleFinder
from smash.planners.precedence.dive import EventOrder, dive
from smash.planners.precedence.graph import Floats, PrecedenceGraph
from smash.planners.precedence.relaxation import Relaxation, Row

if TYPE_CHECKING:
    from smash.planners.precedence.ranks import RankFinder
    from smash.planners.precedence.turns import TurnGraph

HIGHS, MAXSAT = "HiGHS", "RC2"
"""What proves the bounds: the solver of linear and integer programs, or core-guided MaxSAT."""

TOLERANCE = 1e-4
"""Of a bound, in units: what HiGHS may be wrong by where each reduced cost is wrong by as much as it allows (1e-7)."""
DIVE_SECONDS = 0.3
"""Longest time for making one feasible choice cheaper."""
ROUNDINGS, ROUND_SHARE = 40, 0.1
"""Random roundings of the LP solution from which rows are taken before the integer solves and MaxSAT, and the share of
the time left that they may take before the latter."""
INTERPRETED_SECONDS, INTERPRETED_BLOCKS = 0.5, 500
"""How long, and with how many blocks, the kernels are interpreted: what ends sooner needs no library to be loaded."""
COMPILE_SECONDS, MOST_COMPILE_SECONDS = 1.5, 30.0
"""How long to wait for the compiled kernels: their machine code is loaded by then, unless it must be made; and where
nothing can be done without."""
QUICK_SECONDS, QUICK_CHOICES = 1.0, 150
"""For integer solves on the cycles alone, and with how many choices they have a chance."""
ROUNDS = ((10, 15), (12, 40), (14, 400))
"""The largest sets of the rank inequalities, and the most rounds with each."""
NOISE = (1.0, 3.0, 5.0)
"""How much chance decides about each of the sets grown from one block in a round."""
STALL_ROUNDS, STALL = 6, 5e-4
"""Sets grow larger where so many rounds raised the bound by no more than this share."""
SLACK = 0.2
"""Rows exceeded by more are dropped between rounds."""
TIGHT, LONGEST = 0.05, 14
"""Sets grow along rows that are exceeded by less, of no more blocks."""
MOST_COUNTED, MANY_SHARE = 700, 0.8
"""With more blocks rank inequalities prove more than MaxSAT (with 500 less), as long as they have time: the share of
the time left that they may take then."""
SHORT_SHARE, MOST_SHORT = 0.2, 200_000
"""Short cycles are listed for MaxSAT for no more than this share of the time left, and no more of them."""
MOVES = 10_000
"""Moves of one annealing, per block."""
ANNEALINGS, ANNEAL_SHARE, RANK_SHARE = 4, 0.15, 0.4
"""How many there are at most, as one that finds nothing better is the last, and the shares of the time left that they
and the rank inequalities may take."""


@dataclass(slots=True)
class HittingSet:
    """What is known of the cheapest hitting set.

    Attributes:
        bound: no hitting set costs less (actions on top of the graph's base cost).
        chosen: the cheapest hitting set found.
        rows: the cycles (and forced topples) found, as sets of choices of which one must be taken.
        cycles: for each row the blocks of its back edges (a single loose block for a forced topple).
        rounds: LP and MIP solves, rank inequalities, and answers of the MaxSAT solver.
        prover: what proved the bound, `HIGHS` or `MAXSAT`; None where nothing is proven beyond the base cost.
    """

    bound: int
    chosen: set[int]
    rows: list[Row] = field(default_factory=list)
    cycles: list[tuple[int, ...]] = field(default_factory=list)
    rounds: dict[str, int] = field(default_factory=lambda: {"lp": 0, "mip": 0, "ranks": 0, "maxsat": 0})
    prover: str | None = None


class HittingSetSolver:
    """Branch-and-cut for one graph; `solve` may be stopped at any time and then returns a valid bound.

    Args:
        graph: the precedence graph.
        threads: HiGHS' threads.
        on_bound: called at once with every better bound.
        prover: `HIGHS` or `MAXSAT`; None: the latter where it serves better.
    """

    def __init__(
        self,
        graph: PrecedenceGraph,
        threads: int = 1,
        on_bound: Callable[[int], object] | None = None,
        prover: str | None = None,
    ) -> None:
        self.graph = graph
        self._prover = prover or MAXSAT
        self._most_counted = math.inf if prover else MOST_COUNTED
        self._on_bound = on_bound
        self.finder = CycleFinder(graph)
        self._kernels = INTERPRETED
        self._compile_from = math.inf
        self._order = EventOrder(graph)
        self._costs = graph.costs
        costs = [choice.cost for choice in graph.choices]
        self._unit = math.gcd(*costs) if costs else 1
        self._uses = np.zeros(len(costs))
        self._known: set[Row] = set()
        self._started = False
        self._report: Callable[[set[int]], None] | None = None
        self.state = HittingSet(0, set())
        self._relaxation = Relaxation(self._costs, threads)
        for block in graph.must_free:
            self._add_row((block,))

    def start(self, deadline: float) -> set[int]:
        """Return a first hitting set, at once; `deadline` cuts its improvement short (`time.perf_counter` seconds)."""
        self._started = True
        self._offer(self._dive(None, deadline))
        return self.state.chosen

    def solve(self, deadline: float, on_choice: Callable[[set[int]], None] | None = None) -> HittingSet:
        """Find the cheapest hitting set, or stop at `deadline` (`time.perf_counter` seconds)."""
        self._report = on_choice
        if not self._started:
            self.start(deadline)
        many = len(self.graph.blocks) > INTERPRETED_BLOCKS
        self._compile_from = perf_counter() + (0.0 if many else INTERPRETED_SECONDS)
        if self._proven() or not self._relax(deadline):
            return self.state
        if len(self._costs) <= QUICK_CHOICES and not self._proven():
            self._integrate(min(deadline, perf_counter() + QUICK_SECONDS))
        if not self._proven():
            self._strengthen(deadline)
            self._integrate(deadline)
        return self.state

    def cost(self, chosen: set[int]) -> int:
        """Cost of a hitting set, on top of the base cost."""
        return sum(self.graph.choices[choice].cost for choice in chosen)

    def _dive(self, values: Floats | None, deadline: float) -> set[int]:
        return dive(self.graph, values, self._order, min(deadline, perf_counter() + DIVE_SECONDS))

    def _proven(self) -> bool:
        return self.state.bound >= self.cost(self.state.chosen)

    def _offer(self, chosen: set[int]) -> None:
        if not self.state.chosen or self.cost(chosen) < self.cost(self.state.chosen):
            self.state.chosen = chosen
            if self._report is not None:
                self._report(chosen)

    def _raise_bound(self, value: float, prover: str = HIGHS) -> None:
        if not math.isfinite(value):
            return
        units = math.ceil(value / self._unit - TOLERANCE)
        if units * self._unit > self.state.bound:
            self.state.bound = units * self._unit
            self.state.prover = prover
            if self._on_bound is not None:
                self._on_bound(self.state.bound)

    def _add_row(self, cycle: tuple[int, ...]) -> bool:
        row = self.graph.row(cycle)
        if row not in self._known:
            self._known.add(row)
            self._uses[list(row)] += 1
            self.state.rows.append(row)
            self.state.cycles.append(cycle)
        return self._relaxation.add(row)

    def _compile(self, wait: float) -> None:
        """Take the compiled kernels if they are there within `wait` seconds."""
        from smash.planners.precedence.compiler import GraphCompiler

        kernels: Kernels | None = GraphCompiler.code(perf_counter() + wait)
        if kernels is not None:
            self._kernels = kernels
            self.finder.use(kernels)

    def _relax(self, deadline: float, below: float = 1.0 - 1e-3) -> bool:
        """Cut the LP relaxation until no cycle is violated; whether that was reached in time."""
        while perf_counter() < deadline:
            if not self._kernels.compiled and perf_counter() > self._compile_from:
                many = len(self.graph.blocks) > INTERPRETED_BLOCKS
                self._compile(min(MOST_COMPILE_SECONDS if many else COMPILE_SECONDS, 0.2 * (deadline - perf_counter())))
                self._compile_from = perf_counter() + COMPILE_SECONDS
            values = self._relaxation.values
            for cycle in self.finder.violated(self.graph.freedom(values), below, deadline):
                self._add_row(cycle)
            if not self._relaxation.waiting:
                return True
            if not self._relaxation.solve(deadline):
                return False
            self.state.rounds["lp"] += 1
            self._raise_bound(self._relaxation.objective)
            if below > 0.99:
                self._offer(self._dive(self._relaxation.values, deadline))
            if self._proven():
                return True
        return False

    def _strengthen(self, deadline: float) -> None:
        """Bring bound and cost nearer to each other: by annealing where the choices are blocks, by MaxSAT or ranks."""
        from smash.planners.precedence.turns import turn_graph

        turns = turn_graph(self.graph)
        if (turns is None and self._prover != MAXSAT) or (turns is not None and len(turns.free) == 0):
            return
        self._compile(min(MOST_COMPILE_SECONDS, 0.2 * (deadline - perf_counter())))
        if not self._kernels.compiled:
            return
        if turns is not None:
            self._anneal(turns, _share(deadline, ANNEAL_SHARE))
        many = turns is not None and len(turns.free) > self._most_counted
        if turns is None or (self._prover == MAXSAT and not many):
            self._count(turns, deadline)
            return
        from smash.planners.precedence.ranks import RankFinder

        until = _share(deadline, MANY_SHARE if many else RANK_SHARE)
        self._rank(RankFinder(turns, self._kernels), until, deadline, patient=many)

    def _anneal(self, turns: TurnGraph, until: float) -> None:
        """Look for fewer choices, until one annealing finds nothing better."""
        from smash.planners.precedence.annealing import Annealing

        for seed in range(ANNEALINGS):
            if perf_counter() > until or self._proven():
                return
            before = self.state.chosen
            self._offer(Annealing(turns, self._kernels, seed).run(MOVES * len(turns.free), until))
            if seed and self.state.chosen is before:
                return

    def _count(self, turns: TurnGraph | None, deadline: float) -> None:
        """Find the cheapest choices by MaxSAT, adding the cycles that each answer leaves, until one leaves none.

        An answer is there only once all is proven, so that cycles of four and more blocks have to be known before.
        """
        from smash.planners.precedence.maxsat import MaxSat, clause_of, short_cycles

        self._round(_share(deadline, ROUND_SHARE))
        rows = self.state.rows

        def tell(units: int) -> bool:
            self._raise_bound(units * self._unit, MAXSAT)
            return not self._proven()

        clauses = [clause_of(row) for row in rows]
        if turns is not None:
            clauses += [clause_of((choice,)) for choice in sorted(turns.forced)]
            short = islice(short_cycles(turns, _share(deadline, SHORT_SHARE)), MOST_SHORT)
            clauses += [clause_of(cycle) for cycle in short]
        weights = [choice.cost // self._unit for choice in self.graph.choices]
        solver = MaxSat(weights, clauses, (), tell)
        while (values := solver.solve(deadline)) is not None:
            self.state.rounds["maxsat"] += 1
            known = len(rows)
            self._offer(self._dive(values, deadline))
            self._cut_off(values, deadline)
            if self._proven() or len(rows) == known:
                break
            for row in rows[known:]:
                solver.add(clause_of(row))
        solver.close()

    def _rank(self, finder: RankFinder, until: float, deadline: float, *, patient: bool) -> None:
        """Add rank inequalities of growing sets; each round cuts the relaxation by cycles again.

        Args:
            finder: of the inequalities.
            until: when to stop [s, `perf_counter`].
            deadline: of the linear program in hand.
            patient: whether to go on with the largest sets as long as the bound rises at all.
        """
        relaxation = self._relaxation
        for most, rounds in ROUNDS:
            stall = 0.0 if patient and most == ROUNDS[-1][0] else STALL
            bounds: list[float] = []
            for _ in range(rounds):
                if self._proven() or perf_counter() > until:
                    return
                rows = relaxation.tight(TIGHT, LONGEST)
                for noise in NOISE:
                    for row, needed in finder.violated(relaxation.values, rows, most, noise, until):
                        self.state.rounds["ranks"] += relaxation.add(row, needed)
                if not self._relax(deadline, 0.98):
                    return
                relaxation.drop_slack(SLACK)
                bounds.append(relaxation.objective)
                if len(bounds) > STALL_ROUNDS and bounds[-1] - bounds[-1 - STALL_ROUNDS] <= stall * bounds[-1]:
                    break

    def _integrate(self, deadline: float) -> None:
        """Solve with whole choices, adding the cycles that each solution leaves, until it leaves none."""
        self._round(deadline)
        while perf_counter() < deadline and not self._proven():
            values = self._relaxation.solve_whole(deadline, self.state.chosen, self._unit - 0.001, self._raise_bound)
            self.state.rounds["mip"] += 1
            if self._proven() or values is None:
                return
            self._offer(self._dive(values, deadline))
            if not self._proven() and not self._cut_off(values, deadline):
                return

    def _round(self, deadline: float) -> None:
        """Add the cycles that roundings of the LP solution leave: integer solves would ask for them one by one."""
        draw = np.random.default_rng(0)
        values = self._relaxation.values
        for _ in range(ROUNDINGS):
            self._cut_off((values > draw.uniform(0.0, 1.0, len(values))).astype(float), deadline)

    def _cut_off(self, values: Floats, deadline: float) -> int:
        """Add the cycles that an integer solution leaves, then those that are left when these are hit, and so on."""
        added = 0
        values = values.copy()
        while perf_counter() < deadline:
            cycles = self.finder.violated(self.graph.freedom(values), 0.5, deadline)
            if not cycles:
                break
            for cycle in cycles:
                added += self._add_row(cycle)
                row = list(self.graph.row(cycle))
                if not values[row].any():
                    values[min(row, key=lambda choice: (self._costs[choice], -self._uses[choice], choice))] = 1.0
        return added


def _share(deadline: float, share: float) -> float:
    """Return when a share of the time left is over."""
    now = perf_counter()
    return now + share * (deadline - now)
