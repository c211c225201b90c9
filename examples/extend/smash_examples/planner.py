"""A planner: weighted A* over the law's states, anytime, restarted with smaller and smaller weights."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter

from smash.planners.protocol import BasePlanner, IncumbentLog, OnIncumbent, PlanResult, SolveOptions
from smash.problem import Action, Instance, Law, State
from smash.problem.views.demands import demands_of

WEIGHTS = (5, 2, 1)
"""How much the estimate counts against the cost so far; with 1 the first plan found is optimal."""


class BestFirst(BasePlanner):
    """Restarting weighted A*: a plan soon, better ones while the budget lasts, a proof where it lasts long enough."""

    summary = "example: restarting weighted A* over states"
    proves = True

    def solve(
        self, instance: Instance, options: SolveOptions, budget: float, on_incumbent: OnIncumbent | None = None
    ) -> PlanResult:
        """Plan for at most `budget` seconds."""
        deadline = perf_counter() + budget
        log = IncumbentLog(instance, options, on_incumbent)  # its clock runs; the law checks what it is offered
        impossible = log.without_plan()
        if impossible is not None:
            return impossible
        for weight in WEIGHTS:
            searched = search(Law(instance, options), weight, deadline, log)
            if not searched:
                return log.result()
            if log.cost is None:  # every state was seen
                return log.result(infeasible=True, bound_origin="best-first")
        if log.cost is not None:
            log.prove(log.cost, origin="best-first")
        return log.result()


def search(law: Law, weight: int, deadline: float, log: IncumbentLog) -> bool:
    """Search until a plan better than the log's best is found, or none is left; False where the time is up."""
    start = State.start_of(law.instance)
    ticket = itertools.count()  # equal priorities: the newest state first
    queue: list[tuple[int, int, int, State, Sequence[Action]]] = [(0, 0, 0, start, ())]
    reached = {start.key(): 0}
    while queue:
        if perf_counter() >= deadline:
            return False
        _, _, cost, state, actions = heapq.heappop(queue)
        if law.goal_shortfall(state) is None:
            log.offer(actions, origin="best-first")
            return True
        for action in list(law.legal_actions(state)):
            after = state.copy()
            law.apply(after, action)
            rest = estimate(law.instance, after)
            better = log.cost is None or cost + 1 + rest < log.cost
            if better and cost + 1 < reached.get(after.key(), cost + 2):
                reached[after.key()] = cost + 1
                entry = (cost + 1 + weight * rest, -next(ticket), cost + 1, after, [*actions, action])
                heapq.heappush(queue, entry)
    return True


def estimate(instance: Instance, state: State) -> int:
    """Return a lower bound on what is left: two actions a block to be placed, one a pile to be cleared."""
    held = () if state.hand is None else (state.hand,)
    piles = {location: tuple(pile) for location, pile in state.piles.items()}
    here = replace(instance, start=piles, table=(*state.table, *held))
    left = demands_of(here)
    blocked = sum(not left.loose.isdisjoint(pile) for pile in left.leaving.values())
    in_hand = sum(-1 if block in left.placed else 1 for block in held)
    return 2 * len(left.placed) + blocked + in_hand
