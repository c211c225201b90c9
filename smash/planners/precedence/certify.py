"""Writing certificates: cycles with dual weights, in a tree of cases where the relaxation leaves a gap.

Where the choices are blocks and the cycles leave a gap, rank inequalities (`ranks.py`) come before the cases.

The weights are the LP's dual values, scaled down until they are feasible in whole millionths, so that what is
written is exact whatever the solver's tolerances were. Checked by `smash.problem.certificate`.
"""

from __future__ import annotations

from collections.abc import Iterable
from time import perf_counter
from typing import NamedTuple

import highspy
import numpy as np

from smash.planners.precedence.certify_places import certify_places
from smash.planners.precedence.compiled import Kernels
from smash.planners.precedence.compiler import GraphCompiler
from smash.planners.precedence.cycles import CycleFinder
from smash.planners.precedence.dive import dive
from smash.planners.precedence.emptying import places_decide
from smash.planners.precedence.graph import Floats, PrecedenceGraph, build_graph
from smash.planners.precedence.hitting_set import MOST_COMPILE_SECONDS, STALL, STALL_ROUNDS
from smash.planners.precedence.ranks import MOST_VERTICES, RankFinder
from smash.planners.precedence.turns import turn_graph
from smash.problem.certificate import PLACE_COST, Cases, Certificate, FirstPlace, Leaf, first_problems
from smash.problem.certificate_places import ONE, PlacesProof
from smash.problem.problem import Problem

MOST_ROUNDS = 200
"""Of rank inequalities."""
NEAR, LONGEST = 0.2, 8
"""Sets grow along rows that are exceeded by less, of no more blocks."""
NOISE = (0.5, 1.5, 2.5)
"""How much chance decides about them, round after round: few inequalities are wanted here, each stands in the file."""
CYCLES_SHARE = 0.25
"""Of the time, for the cycles alone where a choice of places may prove more."""
COMPILE_SHARE = 0.2
"""Of the time, to wait for the kernels that find them."""

Fixed = dict[int, int]
"""Choices that a case fixes: 1 taken, 0 not."""


def certify(
    problem: Problem, deadline: float, known: Iterable[tuple[int, ...]] = (), *, cost: int | None = None
) -> Certificate:
    """Prove as good a lower bound as the time allows, and return the proof.

    Args:
        problem: a plain, feasible one.
        deadline: when to stop, in seconds of `time.perf_counter`; the certificate then proves what it can.
        known: cycles found before (`HittingSet.cycles`), to start from; none of a full hand's.
        cost: of a plan that is known; no more than that is proven by a choice of places, where that is part of it.
    """
    part = _Part([], [], Leaf([]), 0)
    firsts: list[FirstPlace] = []
    if problem.instance.hand is None:
        part = _proof(problem, deadline, known, cost)
        bound = part.bound
    else:
        rests = first_problems(problem.instance, problem.options)
        for number, (place, rest) in enumerate(rests.items()):
            until = perf_counter() + max(0.0, deadline - perf_counter()) / (len(rests) - number)
            of_rest = _proof(Problem(rest, problem.options), until, (), None if cost is None else cost - PLACE_COST)
            firsts.append(
                FirstPlace(place, of_rest.bound, of_rest.cycles, of_rest.proof, of_rest.ranks, of_rest.places)
            )
        bound = PLACE_COST + min(first.bound for first in firsts)
    return Certificate(
        format="smash-certificate/1",
        instance=problem.instance.name,
        topple=problem.options.topple,
        max_topple=problem.options.max_topple,
        bound=bound,
        cycles=part.cycles,
        proof=part.proof,
        note="the time ran out before more was proven" if perf_counter() > deadline else "",
        first_places=firsts,
        ranks=part.ranks,
        places=part.places,
    )


class _Part(NamedTuple):
    """A proof for an empty hand: the cycles and ranks that it uses, the proof, its bound, and what stands for them."""

    cycles: list[list[str]]
    ranks: list[list[str]]
    proof: Leaf | Cases
    bound: int
    places: PlacesProof | None = None


def _proof(problem: Problem, deadline: float, known: Iterable[tuple[int, ...]], cost: int | None) -> _Part:
    """Return a proof for an empty hand, one that chooses places where that proves more."""
    if not places_decide(problem):
        return _plain_proof(problem, deadline, known)
    now = perf_counter()
    plain = _plain_proof(problem, now + CYCLES_SHARE * (deadline - now), known)
    chosen = certify_places(problem, deadline, plain.bound, cost)
    return plain if chosen is None else _Part([], [], Leaf([]), chosen[1], chosen[0])


def _plain_proof(problem: Problem, deadline: float, known: Iterable[tuple[int, ...]]) -> _Part:
    """Return a proof by cycles and ranks alone."""
    prover = _Prover(build_graph(problem), deadline)
    for cycle in known:
        prover.add(cycle)
    proof, bound = prover.prove()
    graph = prover.graph
    used = sorted(_rows_of(proof), key=lambda row: (row in prover.ranks, row))
    number = {row: position for position, row in enumerate(used)}
    cycles = [[graph.blocks[block] for block in prover.cycles[row]] for row in used if row not in prover.ranks]
    ranks = [prover.ranks[row] for row in used if row in prover.ranks]
    return _Part(cycles, ranks, _renumbered(proof, number), graph.base_cost + bound)


class _Prover:
    """Branch and bound over the choices with exact bounds; cuts found in one case serve all.

    Attributes:
        cycles: by row, blocks of back edges.
        ranks: of the rows that are rank inequalities, the blocks.
    """

    def __init__(self, graph: PrecedenceGraph, deadline: float) -> None:
        self.graph = graph
        self.deadline = deadline
        self.cycles: dict[int, tuple[int, ...]] = {}
        self.ranks: dict[int, list[str]] = {}
        self._rows: list[list[int]] = []
        self._needed: list[int] = []
        self._known: set[frozenset[int]] = set()
        self._finder = CycleFinder(graph)
        self._costs = graph.costs
        self._unit = int(np.gcd.reduce(self._costs.astype(int))) if len(self._costs) else 1
        self._sent = 0
        self._model = highspy.Highs()
        self._model.silent()
        count = len(self._costs)
        if count:
            self._model.addCols(count, self._costs, np.zeros(count), np.ones(count), 0, [], [], [])
        for block in graph.must_free:
            self.add((block,))

    def add(self, cycle: tuple[int, ...]) -> bool:
        """Take up a cycle; whether it was new."""
        row = self.graph.row(cycle)
        if row in self._known:
            return False
        self._known.add(row)
        self.cycles[len(self._rows)] = cycle
        self._rows.append(sorted(row))
        self._needed.append(1)
        return True

    def _add_rank(self, row: frozenset[int], needed: int) -> bool:
        """Take up a rank inequality; whether it was new."""
        if row in self._known:
            return False
        self._known.add(row)
        self.ranks[len(self._rows)] = [self._blocks_of(choice)[0] for choice in sorted(row)]
        self._rows.append(sorted(row))
        self._needed.append(needed)
        return True

    def prove(self) -> tuple[Leaf | Cases, int]:
        """Return the best proof and the bound that it gives (without the base cost)."""
        graph = self.graph
        best = int(sum(graph.choices[choice].cost for choice in dive(graph)))
        if not best:
            return Leaf([]), 0
        root, values, bound = self._leaf({})
        if values is not None:
            best = min(best, int(sum(graph.choices[choice].cost for choice in dive(graph, values))))
        if bound < best and values is not None:
            root, values, bound = self._strengthen(root, values, bound, best)
        if bound >= best or values is None:
            return root, bound
        proof: Leaf | Cases = root
        proven = bound
        while proven < best and perf_counter() < self.deadline:
            deeper, reached = self._branch({}, proven + self._unit)
            if reached <= proven:
                break
            proof, proven = deeper, reached
        return proof, proven

    def _strengthen(self, root: Leaf, values: Floats, bound: int, best: int) -> tuple[Leaf, Floats | None, int]:
        """Add rank inequalities to the relaxation of the root while they raise it; return what `_leaf` does."""
        turns = turn_graph(self.graph)
        kernels = None if turns is None or not len(turns.free) else self._kernels()
        if turns is None or kernels is None:
            return root, values, bound
        finder = RankFinder(turns, kernels)
        heights = [float(self._costs @ values)]
        for round_ in range(MOST_ROUNDS):
            tight = [
                frozenset(row)
                for row, needed in zip(self._rows, self._needed, strict=True)
                if len(row) <= LONGEST and float(values[row].sum()) - needed < NEAR
            ]
            ranks = finder.violated(values, tight, MOST_VERTICES, NOISE[round_ % len(NOISE)], self.deadline)
            if not sum([self._add_rank(row, needed) for row, needed in ranks]):
                break
            leaf, reached, raised = self._leaf({})
            if raised > bound:
                root, bound = leaf, raised
            if bound >= best or reached is None:
                return root, reached, bound
            values = reached
            heights.append(float(self._costs @ values))
            if len(heights) > STALL_ROUNDS and heights[-1] < (1.0 + STALL) * heights[-1 - STALL_ROUNDS]:
                break
        return root, values, bound

    def _kernels(self) -> Kernels | None:
        """Return the compiled kernels if they are there in a share of the time."""
        now = perf_counter()
        until = now + min(MOST_COMPILE_SECONDS, COMPILE_SHARE * (self.deadline - now))
        kernels: Kernels | None = GraphCompiler.code(until)
        return kernels

    def _branch(self, fixed: Fixed, target: int) -> tuple[Leaf | Cases, int]:
        """Return a proof for the case `fixed` and its bound, below `target` if time ran out or that is not true."""
        leaf, values, bound = self._leaf(fixed)
        if bound >= target or values is None or perf_counter() > self.deadline:
            return leaf, bound
        open_values = np.where(np.isin(np.arange(len(values)), list(fixed)), 0.0, np.abs(values - np.round(values)))
        choice = int(np.argmax(open_values))
        if open_values[choice] < 1e-6:
            return leaf, bound  # an integer solution below the target: the target is not true
        taken, taken_bound = self._branch({**fixed, choice: 1}, target)
        if taken_bound < target:
            return leaf, bound
        untaken, untaken_bound = self._branch({**fixed, choice: 0}, target)
        if untaken_bound < target:
            return leaf, bound
        key = self._key(choice)
        return Cases(key, taken, untaken), min(taken_bound, untaken_bound)

    def _key(self, choice: int) -> list[str | int]:
        location, low, high, topple = self.graph.choices[choice]
        if topple:
            return ["topple", location, low, high]
        return ["aside", next(b for b in self._blocks_of(choice))]

    def _blocks_of(self, choice: int) -> list[str]:
        graph = self.graph
        freed = np.flatnonzero((graph.choice_low <= choice) & (choice < graph.choice_high))
        return [graph.blocks[int(block)] for block in freed]

    def _leaf(self, fixed: Fixed) -> tuple[Leaf, Floats | None, int]:
        """Cut the relaxation of a case until no cycle is violated; its weights, solution (None: no more) and bound."""
        count = len(self._costs)
        # No upper bounds on free choices: their duals would have to go into the certificate too.
        low, high = np.zeros(count), np.full(count, highspy.kHighsInf)
        for choice, value in fixed.items():
            low[choice] = high[choice] = value
        indices = np.arange(count, dtype=np.int32)
        self._model.changeColsBounds(count, indices, low, high)
        leaf, values, bound = Leaf([]), None, 0
        while True:
            self._send()
            left = self.deadline - perf_counter()
            if left <= 0:
                return leaf, None, bound
            self._model.clearSolver()
            self._model.setOptionValue("time_limit", left + self._model.getRunTime())  # it counts all runs together
            self._model.run()
            if self._model.getModelStatus() == highspy.HighsModelStatus.kInfeasible:
                impossible, beyond = self._impossible(fixed)
                return impossible, None, beyond
            if self._model.getModelStatus() != highspy.HighsModelStatus.kOptimal:
                return leaf, None, bound
            solution = self._model.getSolution()
            values = np.array(solution.col_value)
            leaf, bound = self._weights(np.array(solution.row_dual), fixed)
            cycles = self._finder.violated(self.graph.freedom(values), 1.0 - 1e-3, self.deadline)
            if not sum([self.add(cycle) for cycle in cycles]):
                return leaf, values, bound

    def _weights(self, duals: Floats, fixed: Fixed) -> tuple[Leaf, int]:
        """Round dual values to exact weights of the case; return them and the bound that they give."""
        taken = {choice for choice, value in fixed.items() if value}
        needed = [needed - len(taken.intersection(row)) for row, needed in zip(self._rows, self._needed, strict=True)]
        rows = [row for row, dual in enumerate(duals) if dual > 1e-9 and needed[row] > 0]
        load = np.zeros(len(self._costs))
        for row in rows:
            load[self._rows[row]] += duals[row]
        load[list(fixed)] = 0.0
        excess = float((load / self._costs).max(initial=0.0))
        scale = 1.0 / (max(excess, 1.0) * (1.0 + 1e-9))
        weights = [(row, int(duals[row] * scale * ONE)) for row in rows]
        leaf = Leaf([(row, weight) for row, weight in weights if weight])
        total = ONE * int(self._costs[list(taken)].sum()) + sum(weight * needed[row] for row, weight in leaf.weights)
        return leaf, -(-total // (ONE * self._unit)) * self._unit

    def _impossible(self, fixed: Fixed) -> tuple[Leaf, int]:
        """Close a case that bans all that hits some cycle: no weight on that cycle is too much."""
        banned = {choice for choice, value in fixed.items() if not value}
        while (row := self._banned_row(banned)) is None:  # the ranks alone say so: a cycle that does is there too
            allowed = np.ones(len(self._costs))
            allowed[list(banned)] = 0.0
            if not [cycle for cycle in self._finder.violated(self.graph.freedom(allowed), 0.5) if self.add(cycle)]:
                return Leaf([]), 0
        bound = int(self._costs.sum()) + self._unit
        return Leaf([(row, ONE * bound)]), bound

    def _banned_row(self, banned: set[int]) -> int | None:
        """Return a cycle that nothing but banned choices hits, None where none is known."""
        return next((row for row in self.cycles if banned.issuperset(self._rows[row])), None)

    def _send(self) -> None:
        fresh = self._rows[self._sent :]
        if not fresh:
            return
        starts = np.concatenate(([0], np.cumsum([len(row) for row in fresh])[:-1])).astype(np.int32)
        columns = np.array([choice for row in fresh for choice in row], dtype=np.int32)
        count = len(fresh)
        infinity = np.full(count, highspy.kHighsInf)
        needed = np.array(self._needed[self._sent :], dtype=float)
        self._model.addRows(count, needed, infinity, len(columns), starts, columns, np.ones(len(columns)))
        self._sent = len(self._rows)


def _rows_of(proof: Leaf | Cases) -> set[int]:
    if isinstance(proof, Leaf):
        return {row for row, _ in proof.weights}
    return _rows_of(proof.taken) | _rows_of(proof.untaken)


def _renumbered(proof: Leaf | Cases, rank: dict[int, int]) -> Leaf | Cases:
    if isinstance(proof, Leaf):
        return Leaf([(rank[row], weight) for row, weight in proof.weights])
    return Cases(proof.choice, _renumbered(proof.taken, rank), _renumbered(proof.untaken, rank))
