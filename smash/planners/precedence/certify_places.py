"""Writing the part of certificates that chooses places: a tree of cases with dual weights, best bound first.

The relaxation of the model of `emptying.py` is cut by conditional cycles wherever it violates some, and branched on
where none is left. Rows, costs and the bound of each leaf are those of the checker
(`smash.problem.certificate_places`), so whatever the solver's tolerances were, what is written proves what it says.
"""

from __future__ import annotations

import heapq
import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter

import highspy
import numpy as np

from smash.planners.precedence.emptying import Loop, PlacesModel, places_decide, too_large
from smash.planners.precedence.graph import Floats
from smash.problem.certificate_places import (
    ONE,
    REMOVED,
    ConditionalCycle,
    Key,
    NamedCases,
    NamedLeaf,
    PlacesChecker,
    PlacesProof,
    Row,
)
from smash.problem.errors import RefusedCertificate
from smash.problem.problem import Problem

VIOLATED = 0.98
"""Cycles that are fulfilled to less than this are cut off."""
ROUNDS, DEEP_ROUNDS = 60, 4
"""Of cycles at the root, and at a case where fractions are left."""
INTEGRAL = 1e-6
RAY = 10_000
"""What the weights of a case without values are multiplied by: they prove whatever is asked for."""


def certify_places(
    problem: Problem, deadline: float, known: int, cost: int | None = None
) -> tuple[PlacesProof, int] | None:
    """Return a proof that chooses the towers' places, and its bound; None where it proves no more than is known.

    Args:
        problem: a plain, feasible one with an empty hand.
        deadline: when to stop [s, `perf_counter`]; what is proven until then is returned.
        known: a bound that is proven otherwise.
        cost: of a plan that is known: a proof of it is enough.
    """
    if known == cost or not places_decide(problem) or too_large(problem):
        return None
    prover = _PlacesProver(problem, deadline)
    bound = prover.prove(cost)
    return None if bound <= known else (prover.stated(), bound)


@dataclass(slots=True)
class _Case:
    """What a case fixes, its weights and bound, where to branch (None: closed), and the two cases it falls into."""

    fixed: dict[Key, int]
    leaf: NamedLeaf
    bound: int
    choice: Key | None
    parts: tuple[_Case, _Case] | None = None


class _PlacesProver:
    """Branch and bound over the choices with exact bounds; cycles found in one case serve all."""

    def __init__(self, problem: Problem, deadline: float) -> None:
        self._deadline = deadline
        self._model = PlacesModel(problem)
        self._checker = PlacesChecker(problem.posed, problem.options)
        self._cycles: list[ConditionalCycle] = []
        self._known: set[tuple[int, frozenset[tuple[Key, int]]]] = set()
        self._names: list[Key] = []
        self._column = {key: number for number, key in enumerate(self._model.names)}
        self._free_low = np.zeros(len(self._column))
        self._free_high = np.ones(len(self._column))
        self._solver = highspy.Highs()
        self._solver.silent()
        self._solver.setOptionValue("presolve", "off")  # so that a case without values comes with weights that say so
        costs = np.array([self._checker.cost(key) for key in self._model.names], dtype=float)
        if len(costs):
            self._solver.addCols(len(costs), costs, self._free_low, self._free_high, 0, [], [], [])
        for name in self._structure():
            self._send(name, self._checker.row(name))
        self._root = _Case({}, NamedLeaf([]), 0, None)
        self._proven = 0

    def _structure(self) -> Iterator[Key]:
        """Yield the names of the rows that need no cycle."""
        checker = self._checker
        yield from (("place", base) for base in [*checker.bottoms, *checker.loose])
        yield from (("floor", location) for location in checker.piles)
        yield from (("falls", block) for block in sorted(checker.falls))
        for key in self._model.names:
            if key[0] == REMOVED and checker.spot[str(key[1])][1]:
                yield "above", key[1]
        for one, other in self._model.under:
            if one < other:
                yield from (("order", one, other, location) for location in checker.piles)

    def _send(self, name: Key, row: Row) -> None:
        columns = np.array([self._column[key] for key in row.signs], dtype=np.int32)
        high = float(row.least) if row.equal else highspy.kHighsInf
        self._solver.addRow(
            float(row.least), high, len(columns), columns, np.array(list(row.signs.values()), dtype=float)
        )
        self._names.append(name)

    def prove(self, cost: int | None) -> int:
        """Branch until the least case is closed or reaches `cost`, or time is out; return the bound."""
        enough = math.inf if cost is None else cost - self._checker.base
        ties = itertools.count(step=-1)
        self._root = self._case({}, self._root.leaf, ROUNDS)
        waiting = [(self._root.bound, next(ties), self._root)]
        while (case := waiting[0][2]).choice is not None and case.bound < enough and perf_counter() < self._deadline:
            heapq.heappop(waiting)
            fixed = [{**case.fixed, case.choice: value} for value in (1, 0)]
            taken, untaken = (self._case(values, case.leaf, DEEP_ROUNDS) for values in fixed)
            case.parts = taken, untaken
            for part in case.parts:
                heapq.heappush(waiting, (part.bound, next(ties), part))
        self._proven = waiting[0][0]
        return self._checker.base + self._proven

    def _case(self, fixed: dict[Key, int], leaf: NamedLeaf, rounds: int) -> _Case:
        """Cut the relaxation of a case until no cycle is violated, or `rounds` times while fractions are left.

        Args:
            fixed: the choices that are made.
            leaf: weights that close the case as far as nothing better is found.
            rounds: see above.
        """
        low, high = self._free_low.copy(), self._free_high.copy()
        for key, value in fixed.items():
            low[self._column[key]] = high[self._column[key]] = value
        self._solver.changeColsBounds(len(low), np.arange(len(low), dtype=np.int32), low, high)
        best = _Case(fixed, leaf, self._checker.least(leaf, fixed), None)
        for round_ in itertools.count():
            left = self._deadline - perf_counter()
            if left <= 0:
                return best
            self._solver.setOptionValue("time_limit", left + self._solver.getRunTime())  # it counts all runs together
            self._solver.run()
            status = self._solver.getModelStatus()
            if status == highspy.HighsModelStatus.kInfeasible:
                return self._without_values(fixed, best)
            if status != highspy.HighsModelStatus.kOptimal:
                return best
            solution = self._solver.getSolution()
            self._weigh(best, np.array(solution.row_dual), ONE)
            values = np.clip(np.array(solution.col_value), 0.0, 1.0)
            best.choice = self._fractional(values)
            if round_ >= rounds and best.choice is not None:
                return best
            if not sum([self._add(loop) for loop in self._model.violated(values, VIOLATED, self._deadline)]):
                return best
        raise AssertionError

    def _weigh(self, case: _Case, duals: Floats, scale: int) -> None:
        """Give a case the weights of dual values, where they prove more."""
        rows = []
        for row, dual in enumerate(duals.tolist()):
            weight = round(dual * scale)
            if weight > 0 or (weight and self._named(row).equal):
                rows.append((list(self._names[row]), weight))
        leaf = NamedLeaf(rows)
        bound = self._checker.least(leaf, case.fixed)
        if bound > case.bound:
            case.leaf, case.bound = leaf, bound

    def _named(self, row: int) -> Row:
        return self._checker.row(self._names[row])

    def _without_values(self, fixed: dict[Key, int], best: _Case) -> _Case:
        """Close a case that no values fulfil by the weights that say so."""
        best.choice = None
        _, found, ray = self._solver.getDualRay()
        if found:
            duals = np.array(ray)
            duals /= max(1e-9, np.abs(duals).max(initial=0.0))
            self._weigh(best, duals, ONE * RAY)
            self._weigh(best, -duals, ONE * RAY)
        return best

    def _fractional(self, values: Floats) -> Key | None:
        """Return the choice to branch on, None where all are whole: a place, where one is open."""
        open_values = np.abs(values - np.round(values))
        fractional = np.flatnonzero(open_values > INTEGRAL).tolist()
        names = self._model.names
        choice = max(fractional, key=lambda number: (names[number][0] == "at", open_values[number]), default=None)
        return None if choice is None else names[choice]

    def _add(self, loop: Loop) -> bool:
        """Take up a cycle, less the events and conditions that it does not need; whether it was new."""
        given = [self._condition(literal) for literal in sorted(loop.literals)]
        cycle = ConditionalCycle(loop.events, given)
        row = self._checker.cycle_row(len(self._cycles), cycle)
        for event in loop.events:
            shorter = ConditionalCycle([one for one in cycle.events if one != event], cycle.given)
            cycle, row = self._shorter(shorter) or (cycle, row)
        for condition in given:
            shorter = ConditionalCycle(cycle.events, [one for one in cycle.given if one != condition])
            cycle, row = self._shorter(shorter) or (cycle, row)
        content = row.least, frozenset(row.signs.items())
        if content in self._known:
            return False
        self._known.add(content)
        self._checker.cycles.append(row)
        self._send(("cycle", len(self._cycles)), row)
        self._cycles.append(cycle)
        return True

    def _shorter(self, cycle: ConditionalCycle) -> tuple[ConditionalCycle, Row] | None:
        """Return a cycle and its row, None where it is none."""
        try:
            return cycle, self._checker.cycle_row(len(self._cycles), cycle)
        except RefusedCertificate:
            return None

    def _condition(self, literal: int) -> list[str]:
        key = self._model.names[abs(literal) - 1]
        return ["stays", str(key[1])] if literal < 0 else [str(part) for part in key]

    def stated(self) -> PlacesProof:
        """Return the proof, with the cycles that it uses."""
        proof = self._without_idle_cases(self._root, self._proven)
        used = sorted({int(name[1]) for name in _rows_of(proof) if name[0] == "cycle"})
        number = {cycle: position for position, cycle in enumerate(used)}
        return PlacesProof([self._cycles[cycle] for cycle in used], _renumbered(proof, number))

    def _without_idle_cases(self, case: _Case, proven: int) -> NamedLeaf | NamedCases:
        """Return the tree of a case; where the weights of one of two cases prove as much for both, they stand alone."""
        if case.parts is None or case.choice is None:
            return case.leaf
        taken, untaken = (self._without_idle_cases(part, proven) for part in case.parts)
        for leaf in (case.leaf, taken, untaken):
            if isinstance(leaf, NamedLeaf) and self._checker.least(leaf, case.fixed) >= proven:
                return leaf
        return NamedCases(list(case.choice), taken, untaken)


def _rows_of(proof: NamedLeaf | NamedCases) -> Iterator[list[str | int]]:
    if isinstance(proof, NamedCases):
        yield from _rows_of(proof.taken)
        yield from _rows_of(proof.untaken)
    else:
        yield from (name for name, _ in proof.rows)


def _renumbered(proof: NamedLeaf | NamedCases, number: dict[int, int]) -> NamedLeaf | NamedCases:
    if isinstance(proof, NamedCases):
        return NamedCases(proof.choice, _renumbered(proof.taken, number), _renumbered(proof.untaken, number))
    return NamedLeaf(
        [(["cycle", number[int(name[1])]] if name[0] == "cycle" else name, weight) for name, weight in proof.rows]
    )
