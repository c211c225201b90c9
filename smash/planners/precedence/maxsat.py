"""The cheapest choices that hit every cycle, by core-guided MaxSAT.

RC2 (A. Ignatiev, A. Morgado and J. Marques-Silva, JSAT 2019) of python-sat: a clause a cycle, a soft clause a choice;
each unsatisfiable core raises the bound, which holds whatever cycles are still unknown. Where the choices are blocks
the cycles of two and three of them can be listed; others are added where an answer leaves them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from time import perf_counter
from typing import Any

import numpy as np
from pysat.card import CardEnc, EncType
from pysat.examples.rc2 import RC2
from pysat.formula import WCNF

from smash.planners.precedence.graph import Floats
from smash.planners.precedence.turns import TurnGraph

SOLVER = "m22"
"""MiniSat 2.2: it looks at its conflicts one by one; Glucose only where it restarts, which may be minutes from now."""
CONFLICTS = 5_000
"""Between two looks at the clock: a fraction of a second."""


class Stopped(Exception):
    """The deadline has passed, or the bound is enough; the one that was told last holds."""


class MaxSat:
    """The clauses known so far; `solve` finds the cheapest variables that fulfil them.

    Args:
        weights: what each variable costs where it is true.
        clauses: of literals from 1 on, those of false variables negative.
        counts: pairs of variables and how many of them must be true.
        on_bound: called at once with every better bound on the cost; says whether to go on.
    """

    def __init__(
        self,
        weights: Sequence[int],
        clauses: Iterable[Sequence[int]],
        counts: Iterable[tuple[Sequence[int], int]],
        on_bound: Callable[[int], bool],
    ) -> None:
        self._size = top = len(weights)
        formula = WCNF()
        formula.extend([list(clause) for clause in clauses])
        for variables, count in counts:
            encoded = CardEnc.atleast(list(variables), count, top_id=top, encoding=EncType.seqcounter)
            top = max(top, encoded.nv)
            formula.extend(encoded.clauses)
        costly = [(-(number + 1), weight) for number, weight in enumerate(weights) if weight]
        formula.extend([[literal] for literal, _ in costly], weights=[weight for _, weight in costly])
        self._solver = _CoreGuided(formula, on_bound)

    def add(self, clause: Sequence[int]) -> None:
        """Ask for one of the literals of a clause too."""
        self._solver.add_clause(list(clause))

    def solve(self, deadline: float) -> Floats | None:
        """Return the cheapest variables that fulfil all clauses, 1 where true; None where it was stopped before.

        Args:
            deadline: when to stop [s, `perf_counter`]; not to be called again once it was stopped.
        """
        self._solver.deadline = deadline
        try:
            literals = self._solver.compute()
            self._solver.tell()
        except Stopped:
            return None
        values = np.zeros(self._size)
        values[[literal - 1 for literal in literals if 0 < literal <= self._size]] = 1.0
        return values

    def close(self) -> None:
        """Free the solver's memory."""
        self._solver.delete()


class _CoreGuided(RC2):  # type: ignore[misc]
    """RC2 that tells each better bound and looks at the clock."""

    deadline = np.inf

    def __init__(self, formula: Any, on_bound: Callable[[int], bool]) -> None:
        self._on_bound = on_bound
        self._told = 0
        self._minimizing = False
        super().__init__(formula, solver=SOLVER, adapt=True, exhaust=True, minz=True)

    def tell(self) -> None:
        """Tell the bound where it is better than the last one.

        Raises:
            Stopped: where it is enough.
        """
        if self.cost > self._told:
            self._told = self.cost
            if not self._on_bound(self._told):
                raise Stopped

    def minimize_core(self) -> None:
        """Leave out of a core what can be, within the conflicts that RC2 allows for it."""
        self._minimizing = True
        super().minimize_core()
        self._minimizing = False

    def _call_oracle(self, assumptions: Any = (), expect_interrupt: bool = False) -> bool | None:
        """Ask the SAT solver, some conflicts at a time.

        Raises:
            Stopped: where the deadline has passed, or the bound is enough.
        """
        self.tell()
        while perf_counter() <= self.deadline:
            if not self._minimizing:
                self.oracle.conf_budget(CONFLICTS)
            answer: bool | None = self.oracle.solve_limited(assumptions=assumptions)
            if answer is not None or self._minimizing:
                return answer
        raise Stopped


def short_cycles(turns: TurnGraph, deadline: float = np.inf) -> Iterator[tuple[int, ...]]:
    """Yield the cycles of two and of three free choices that hold no shorter one, until `deadline`.

    Args:
        turns: the turn graph.
        deadline: when to stop [s, `perf_counter`].
    """
    leads = np.zeros(turns.edges.shape, dtype=bool)
    inner = np.ix_(turns.free, turns.free)
    leads[inner] = turns.edges[inner] == 1
    both = leads & leads.T
    if perf_counter() > deadline:
        return
    yield from map(tuple, np.argwhere(np.triu(both)).tolist())
    one_way = leads & ~both
    for first in range(len(leads)):
        later = np.arange(len(leads)) > first
        closing = one_way[:, first] & later
        for second in np.flatnonzero(one_way[first] & later).tolist():
            if perf_counter() > deadline:
                return
            for third in np.flatnonzero(one_way[second] & closing).tolist():
                yield first, second, third


def clause_of(row: Iterable[int]) -> list[int]:
    """Return the clause that asks for one of the choices of a row."""
    return [choice + 1 for choice in sorted(row)]
