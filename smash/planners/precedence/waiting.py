"""Where the blocks wait that do not move directly: a bound for `stacks` and `positions` goals without topple.

The precedence graph counts the blocks that are put aside and not the places where they wait. Here each leaving block
has transfers in an order of its own, and a total order over all of them, as clauses over

- `before[e, f]`: transfer e is before transfer f;
- `more[b, i]` (2 actions each): block b waits at least i times before it is placed for good;
- `waits[b, i, q]`: its i-th wait is at location q;
- `rests[b, q]`: block b, to which the goal gives no place, is at q at the end.

A pile gives back its blocks from the top: of two waits at one location one is over before the other begins, or lies
within it; and nothing leaves a start pile, or is placed for good, beneath a block that waits (`docs/theory.md`). So
many waits of a block are told apart; one that waits more often is left free. Where no block of a solution does, the
solution is a plan.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from time import perf_counter
from typing import Any

from smash.planners.precedence.clauses import Cheapest, Clauses
from smash.planners.precedence.graph import ASIDE_COST, MOVE_COST, Floats
from smash.problem.model import TABLE, Action, OnGoal, Pick, Place
from smash.problem.problem import Problem

MOST_WAITS = 4
"""Of one block that are told apart: the model grows with the third power of them."""
MOST_CLAUSES = 2_500_000
"""Larger models take longer to build than they are worth: about 190 transfers."""
CLAUSE_SECONDS = 6e-6
"""To build a clause and hand it to the solver, which nobody can interrupt."""
HANDING = 2.5
"""How often as long as building the clauses it takes to hand them over, whatever else the machine does."""


def waits_decide(problem: Problem) -> bool:
    """Whether blocks may have to wait in piles alone, and the transfers are few enough to be put in order."""
    if problem.options.topple or isinstance(problem.posed.goal, OnGoal):
        return False
    return 0 < _size(problem, 1) <= MOST_CLAUSES


def waiting_bound(
    problem: Problem,
    deadline: float,
    on_bound: Callable[[int], object],
    threads: int = 1,
    on_plan: Callable[[Sequence[Action]], object] | None = None,
    maxsat: bool = True,
) -> int:
    """Return a bound on the cost of every plan without topple; 0 where there was no time for one.

    Args:
        problem: a feasible one of a `stacks` or `positions` goal.
        deadline: when to stop, in seconds of `time.perf_counter`.
        on_bound: called with every better bound at once.
        threads: the solver's threads.
        on_plan: called with the plan that a solution is, which no other beats.
        maxsat: whether core-guided MaxSAT solves the model, or HiGHS.
    """
    best = 0

    def tell(cost: int) -> bool:
        nonlocal best
        if base + cost > best:
            best = base + cost
            on_bound(best)
        return perf_counter() < deadline

    for waits in range(1, MOST_WAITS + 1):
        size = _size(problem, waits)
        began = perf_counter()
        if size > MOST_CLAUSES or began + CLAUSE_SECONDS * size > deadline:
            break
        model = _Model(problem, waits)
        base = model.base
        tell(0)
        built = perf_counter()
        if built + HANDING * (built - began) > deadline:
            break
        solver = Cheapest(model.clauses, tell, threads, maxsat)
        values = solver.solve(deadline)
        solver.close()
        if values is None:
            break
        plan = model.plan(values)
        if plan is not None:
            if on_plan is not None:
                on_plan(plan)
            break
    return best


def _size(problem: Problem, waits: int) -> int:
    """Return about how many clauses the model has; 0 where no block leaves a pile and none waits."""
    leaving = sum(map(len, problem.demands.leaving.values()))
    if not leaving:
        return 0
    lying = len(problem.demands.placed.intersection(problem.posed.table))
    transfers = leaving * (waits + 1) + lying
    order = transfers**3 // 3
    return order + len(problem.posed.locations) * (leaving * waits) ** 2


class _Model:
    """The clauses of one problem.

    Attributes:
        clauses: all of them.
        base: what every plan costs beyond them.
    """

    def __init__(self, problem: Problem, waits: int) -> None:
        demands = problem.demands
        self.problem = problem
        self.clauses = Clauses()
        self.base = MOVE_COST * (len(demands.placed) + len(demands.loose))
        self._waits = waits
        self._source = {block: q for q, pile in demands.leaving.items() for block in pile}
        self._target = {block: q for q, chain in demands.build.items() for block in chain}
        self._transfers: dict[str, list[int]] = {}
        count = itertools.count()
        for block in self._source:
            self._transfers[block] = [next(count) for _ in range(waits + 1)]
        for block in demands.placed - self._source.keys():
            self._transfers[block] = [next(count)]
        self._before = {pair: self.clauses.variable() for pair in itertools.combinations(range(next(count)), 2)}
        self._more: dict[tuple[str, int], int] = {}
        self._at: dict[tuple[str, int, str], int] = {}
        self._rests: dict[tuple[str, str], int] = {}
        self._order()
        for block in self._source:
            self._add_waits(block)
            if block in demands.loose:
                self._add_rest(block)
        for location in problem.posed.locations:
            self._keep_apart(location)

    def _first(self, block: str) -> int:
        return self._transfers[block][0]

    def _last(self, block: str) -> int:
        return self._transfers[block][-1]

    def _is_before(self, earlier: int, later: int) -> int:
        """Return the literal that says so."""
        return self._before[earlier, later] if earlier < later else -self._before[later, earlier]

    def _order(self) -> None:
        """Say that the order has no circle, and what comes before what in every plan."""
        for one, two, three in itertools.combinations(range(1 + max(map(self._last, self._transfers))), 3):
            first, second, both = self._before[one, two], self._before[two, three], self._before[one, three]
            self.clauses.ask((-first, -second, both))
            self.clauses.ask((first, second, -both))
        demands = self.problem.demands
        for transfers in self._transfers.values():
            self._follow(transfers)
        for location in self.problem.posed.locations:
            pile, chain = demands.leaving[location], demands.build.get(location, ())
            self._follow([self._first(block) for block in reversed(pile)])
            self._follow([self._last(block) for block in chain])
            if pile and chain and pile[0] != chain[0]:
                self._follow([self._first(pile[0]), self._last(chain[0])])

    def _follow(self, transfers: Sequence[int]) -> None:
        for earlier, later in itertools.pairwise(transfers):
            self.clauses.ask((self._is_before(earlier, later),))

    def _add_waits(self, block: str) -> None:
        """Say how often a block waits and where; transfers that it does not make are one with its last."""
        transfers, last = self._transfers[block], self._last(block)
        others = [transfer for own in self._transfers.values() if own is not transfers for transfer in own]
        for number in range(1, self._waits + 2):
            more = self._more[block, number] = self.clauses.variable(ASIDE_COST)
            if number > 1:
                self.clauses.ask((-more, self._more[block, number - 1]))
            if number <= self._waits:
                for other in others:
                    here, there = self._is_before(transfers[number - 1], other), self._is_before(last, other)
                    self.clauses.ask((more, -here, there))
        if self._source[block] == self._target.get(block):
            self.clauses.ask((self._more[block, 1],))
        for number in range(1, self._waits + 1):
            self._add_places(block, number)

    def _add_places(self, block: str, number: int) -> None:
        """Say where a block may wait for the `number`-th time: not where it comes from or goes to next."""
        last = number == self._waits
        target = self._target.get(block)
        places = []
        for location in self.problem.posed.locations:
            if (number == 1 and location == self._source[block]) or (last and location == target):
                continue
            at = self._at[block, number, location] = self.clauses.variable()
            places.append(at)
            if location == target:
                self.clauses.ask((-at, self._more[block, number + 1]))
            before = self._at.get((block, number - 1, location))
            if before is not None:
                self.clauses.ask((-at, -before))
        beyond = (self._more[block, number + 1],) if last else ()
        self.clauses.ask((-self._more[block, number], *beyond, *places))

    def _add_rest(self, block: str) -> None:
        """Say where a block may be at the end that the goal gives no place."""
        for location in self.problem.posed.locations:
            self._rests[block, location] = self.clauses.variable()
        self.clauses.ask(self._rests[block, location] for location in self.problem.posed.locations)
        self.clauses.ask((-self._rests[block, self._source[block]], self._more[block, 1]))
        for (waiting, number, location), at in self._at.items():
            if waiting == block:
                self.clauses.ask((-at, -self._rests[block, location], self._more[block, number + 1]))

    def _waits_at(self, location: str) -> Iterator[tuple[str, int, int, int]]:
        """Yield the waits that may be at a location: block, literal, the transfers with which it begins and ends."""
        for block, transfers in self._transfers.items():
            for number, (begin, end) in enumerate(itertools.pairwise(transfers), start=1):
                at = self._at.get((block, number, location))
                if at is not None:
                    yield block, at, begin, end

    def _keep_apart(self, location: str) -> None:
        """Say that whatever is on a pile is taken off from the top, and nothing is built on what leaves again."""
        demands = self.problem.demands
        fixed = [(block, self._first(block)) for block in demands.leaving[location]]
        fixed += [(block, self._last(block)) for block in demands.build.get(location, ())]
        waits = list(self._waits_at(location))
        rests = [(block, self._last(block), at) for (block, q), at in self._rests.items() if q == location]
        for (block, last, at), (other, transfer) in itertools.product(rests, fixed):
            if block != other:
                self.clauses.ask((-at, self._is_before(transfer, last)))
        moments: list[tuple[str, int, tuple[int, ...]]] = [(block, transfer, ()) for block, transfer in fixed]
        moments += [(block, last, (-at,)) for block, last, at in rests]
        for (block, at, begin, end), (other, transfer, unless) in itertools.product(waits, moments):
            if block != other:
                self.clauses.ask((-at, *unless, self._is_before(transfer, begin), self._is_before(end, transfer)))
        for (block, at, begin, end), (other, there, its_begin, its_end) in itertools.permutations(waits, 2):
            if block != other:
                crossed = self._is_before(its_begin, begin), self._is_before(end, its_begin)
                self.clauses.ask((-at, -there, *crossed, self._is_before(its_end, end)))

    def plan(self, values: Floats) -> list[Action] | None:
        """Return the plan that a solution is, or None where a block waits more often than is told apart."""
        true = {number for number, value in enumerate(values.tolist(), start=1) if value > 0.5}
        steps: dict[int, tuple[str, str, str]] = {}
        for block, transfers in self._transfers.items():
            times = sum(self._more.get((block, number)) in true for number in range(1, self._waits + 2))
            if times > self._waits:
                return None
            here = self._source.get(block, TABLE)
            stops = [self._location(true, self._at, (block, number)) for number in range(1, times + 1)]
            stops.append(self._target.get(block) or self._location(true, self._rests, (block,)))
            for transfer, there in zip([*transfers[:times], transfers[-1]], stops, strict=True):
                steps[transfer] = block, here, there
                here = there
        earlier = dict.fromkeys(steps, 0)
        for (one, other), variable in self._before.items():
            for transfer in {other if variable in true else one} & steps.keys():
                earlier[transfer] += 1
        actions: list[Action] = []
        for transfer in sorted(steps, key=earlier.__getitem__):
            block, here, there = steps[transfer]
            actions += [Pick(block, here), Place(block, there)]
        return actions

    def _location(self, true: set[int], places: Mapping[Any, int], key: tuple[Any, ...]) -> str:
        """Return a location at which a solution has what `key` says."""
        return next(q for q in self.problem.posed.locations if places.get((*key, q)) in true)
