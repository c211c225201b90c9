"""Planning from a start with a block in the hand: a problem for each place where it can be put, under one budget.

The optimum is the least, over the places, of what the place costs and the optimum from there; one of each class of
equal locations is enough. So any planner that plans with an empty hand plans with a full one, and proves as much.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from smash.planners.protocol.answer import OnIncumbent
from smash.planners.protocol.clock import left
from smash.planners.protocol.log import SolveLog
from smash.problem.hand import after_place, distinct_locations
from smash.problem.model import Action, Place, State
from smash.problem.plan import Plan
from smash.problem.problem import Problem

FIRST_SECONDS = 0.05
"""For the first look at each place; what is still open then gets `GROWTH` times as long, and so on."""
GROWTH = 4.0

PlanRest = Callable[[Problem, float, OnIncumbent], Plan]
"""Plans a problem whose hand is empty, within a budget [s]."""


@dataclass(slots=True)
class _First:
    """A first place: what it costs, what is left to plan, and what the rest costs at least."""

    place: Place
    price: int
    rest: Problem
    bound: float = 0.0
    origin: str | None = None

    @property
    def least(self) -> float:
        """What a plan that begins so costs at least."""
        return self.price + self.bound


def plan_first_places(problem: Problem, log: SolveLog, deadline: float, plan_rest: PlanRest) -> None:
    """Plan from every first place, the most promising first, until the best plan is proven or `deadline`.

    Args:
        problem: one with a block in the hand at the start.
        log: takes plans and bounds.
        deadline: when to stop [s, clock of `perf_counter`].
        plan_rest: plans from where the hand is empty.
    """
    firsts = _firsts(problem)
    seconds = FIRST_SECONDS
    while True:
        open_firsts = [first for first in firsts if log.cost is None or first.least < log.cost]
        _prove(firsts, log)
        if not open_firsts or log.settled:
            return
        for number, first in enumerate(sorted(open_firsts, key=lambda first: first.least)):
            if left(deadline) <= 0:
                return
            if log.cost is not None and first.least >= log.cost:
                continue
            last = len(open_firsts) == 1
            share = left(deadline) if last else min(seconds, left(deadline) / (len(open_firsts) - number))
            _look(first, log, share, plan_rest)
            _prove(firsts, log)
        seconds *= GROWTH


def _firsts(problem: Problem) -> list[_First]:
    instance, law = problem.instance, problem.law
    assert instance.hand is not None
    start = State.start_of(instance)
    firsts = []
    for target in (*distinct_locations(instance), *law.open_carriers(start)):
        place = Place(instance.hand, target)
        rest = Problem(after_place(instance, target), problem.options)
        firsts.append(_First(place, law.cost(start, place), rest))
    return firsts


def _look(first: _First, log: SolveLog, seconds: float, plan_rest: PlanRest) -> None:
    """Plan from a first place for some seconds; keep what that proves."""

    def found(_seconds: float, _cost: int, actions: Sequence[Action]) -> None:
        log.offer((first.place, *actions), log_origin)

    log_origin = "exact"
    answer = plan_rest(first.rest, seconds, found)
    if answer.actions is not None:
        log.offer((first.place, *answer.actions), answer.incumbents[-1].origin if answer.incumbents else log_origin)
    if answer.status == "infeasible":
        first.bound, first.origin = math.inf, answer.bound_origin or "start"
    elif answer.lower_bound is not None and (first.origin is None or answer.lower_bound > first.bound):
        first.bound, first.origin = answer.lower_bound, answer.bound_origin or "start"
    log.details.setdefault("first_places", {})[first.place.target] = dict(answer.details)


def _prove(firsts: Sequence[_First], log: SolveLog) -> None:
    """Take the least that any first place leaves as the bound of all."""
    least = min(firsts, key=lambda first: first.least)
    if least.least == math.inf:
        log.refute(least.origin or "start")
    elif least.origin is not None:
        log.prove(int(least.least), least.origin)
