"""Planning from a start with a block in the hand: a problem for each place where it can be put, under one budget.

The optimum is the least, over the places, of what the place costs and the optimum from there; one of each class of
equal locations is enough. So any planner that plans with an empty hand plans with a full one, and proves as much.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter

from smash.planners.protocol.clock import left
from smash.planners.protocol.log import SolveLog
from smash.problem.hand import after_place, distinct_locations
from smash.problem.model import Action, Place, State
from smash.problem.problem import Problem

FIRST_SECONDS = 0.1
"""For the first look at each place; what is still open then gets `GROWTH` times as long, and so on."""
GROWTH = 4.0
ENDED_SHARE = 0.5
"""A look that took no more than this share of its time ended by itself: only far more time may help it."""
ORDER_SHARE = 0.1
"""Share of the time in which the places are put in order; the others come last."""

PlanRest = Callable[[SolveLog, float], object]
"""Plans the problem of a log, whose hand is empty, until a time [s, clock of `perf_counter`]."""


@dataclass(slots=True)
class _First:
    """A first place: what it costs, and what the rest costs at least.

    `guess` is what the rest seems to cost; `ended` where the last look left time over.
    """

    problem: Problem
    place: Place
    price: int
    guess: float = math.inf
    bound: float = 0.0
    origin: str = "start"
    ended: bool = False

    def rest(self) -> Problem:
        """Return what is left to plan: made anew for each look, as there may be as many places as blocks."""
        return Problem(after_place(self.problem.instance, self.place.target), self.problem.options)

    @property
    def least(self) -> float:
        """What a plan that begins so costs at least."""
        return self.price + self.bound

    @property
    def promise(self) -> tuple[float, float]:
        """What the places are looked at in the order of."""
        return self.least, self.price + self.guess


def plan_first_places(log: SolveLog, deadline: float, plan_rest: PlanRest) -> None:
    """Plan from every first place, the most promising first, until the best plan is proven or `deadline`.

    At least one of them is looked at, however late it is.

    Args:
        log: takes plans and bounds; its problem has a block in the hand at the start.
        deadline: when to stop [s, clock of `perf_counter`].
        plan_rest: plans from where the hand is empty.
    """
    firsts = _firsts(log.problem, perf_counter() + ORDER_SHARE * max(0.0, left(deadline)))
    seconds, looked = FIRST_SECONDS, False
    while not log.settled:
        _prove(firsts, log)
        waiting = sorted((first for first in firsts if _open(first, log)), key=lambda first: first.promise)
        if not waiting:
            return
        last = all(first.ended for first in waiting)  # all the time that is left, and that is it
        for number, first in enumerate(waiting):
            if looked and left(deadline) <= 0:
                return
            if _open(first, log):
                most = left(deadline) / (len(waiting) - number)
                _look(first, firsts, log, most if last or len(waiting) == 1 else min(seconds, most), plan_rest)
                looked = True
        if last:
            return
        seconds *= GROWTH


def _open(first: _First, log: SolveLog) -> bool:
    """Whether a look at a first place may find a better plan."""
    return first.least < (math.inf if log.upper is None else log.upper)


def _firsts(problem: Problem, until: float) -> list[_First]:
    instance, law = problem.instance, problem.law
    assert instance.hand is not None
    start = State.start_of(instance)
    firsts: list[_First] = []
    for target in (*distinct_locations(instance), *law.open_carriers(start)):
        place = Place(instance.hand, target)
        first = _First(problem, place, law.cost(start, place))
        if left(until) > 0 or not firsts:
            _judge(first)
        firsts.append(first)
    return firsts


def _judge(first: _First) -> None:
    """Guess what is left to do: two actions a block that has to be put, one a stack of which some fall."""
    rest = first.rest()
    if rest.infeasible is not None:
        first.bound, first.origin = math.inf, "feasibility"
        return
    demands = rest.demands
    disturbed = sum(bool(pile) for pile in demands.leaving.values())
    first.guess = 2 * len(demands.placed) + (disturbed if rest.options.topple else 2 * len(demands.loose))


def _look(first: _First, firsts: Sequence[_First], log: SolveLog, seconds: float, plan_rest: PlanRest) -> None:
    """Plan from a first place for some seconds; keep what that proves, at once."""
    relay = _Relayed(first, firsts, log)
    worth = None if log.upper is None else log.upper - first.price
    relay.inner = inner = SolveLog(first.rest(), relay, gentle=log.gentle, worth=worth)
    inner.doubt = log.doubt
    began = perf_counter()
    plan_rest(inner, began + seconds)
    if inner.refuted is not None:
        first.bound, first.origin = math.inf, inner.refuted
    _prove(firsts, log)
    first.ended = perf_counter() - began < ENDED_SHARE * seconds
    log.details.setdefault("first_places", {})[first.place.target] = inner.details


@dataclass(slots=True)
class _Relayed:
    """Hands what is found and proven from a first place to the log of the whole problem."""

    first: _First
    firsts: Sequence[_First]
    log: SolveLog
    inner: SolveLog | None = None

    def __call__(self, seconds: float, cost: int, actions: Sequence[Action]) -> None:
        """Take a plan, under the origin that it has in the log of the rest."""
        assert self.inner is not None
        self.log.offer((self.first.place, *actions), self.inner.entries[-1].origin)

    def bound(self, seconds: float, bound: int, origin: str) -> None:
        """Take a lower bound."""
        if bound > self.first.bound:
            self.first.bound, self.first.origin = bound, origin
            _prove(self.firsts, self.log)


def _prove(firsts: Sequence[_First], log: SolveLog) -> None:
    """Take the least that any first place leaves as the bound of all."""
    least = min(firsts, key=lambda first: first.least)
    if least.least == math.inf:
        log.refute(least.origin)
    elif least.bound > 0 or (log.cost is not None and least.least >= log.cost):
        log.prove(int(least.least), least.origin)
