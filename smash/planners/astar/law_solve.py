"""One solve over the family: the plain twin's plan at once, then A* with falling weights, the last one exact."""

from __future__ import annotations

import math
from time import perf_counter
from typing import Any

from smash.planners.astar.law_search import FamilySearch
from smash.planners.greedy import twin_plans
from smash.planners.protocol import IncumbentLog, SolveOptions
from smash.problem.model import Instance

WEIGHTS = ((4.0, 0.1), (1.5, 0.25))
"""Weights of the estimate in the first searches, and the share of the time left that each may take."""


def offer_twin(instance: Instance, options: SolveOptions, log: IncumbentLog, until: float) -> None:
    """Offer the greedy planner's plans of the plain twin until `until` [s, clock of `perf_counter`]."""
    for actions in twin_plans(instance, options, until, options.seed):
        log.offer(actions, "greedy")


def search_family(
    instance: Instance, options: SolveOptions, log: IncumbentLog, until: float, details: dict[str, Any]
) -> bool:
    """Search until proven or `until`; return whether it is proven that there is no plan.

    Args:
        instance: the problem.
        options: what a plan may use.
        log: takes the plans and the bounds.
        until: when to stop [s, clock of `perf_counter`].
        details: gets the number of expanded states and the end of the exact search.
    """
    for weight, share in (*WEIGHTS, (1.0, 1.0)):
        if log.proven:
            break
        below = math.inf if log.cost is None else log.cost
        search = FamilySearch(instance, options, weight=weight, below=below)
        log.prove(search.bound, "places")
        stop = perf_counter() + share * (until - perf_counter())
        while search.ended is None and not log.proven and perf_counter() < stop:
            plan = search.run(stop, lambda bound: log.prove(bound, "astar"))
            if plan is None:
                break
            log.offer(plan, "exact")
            if weight > 1.0:
                break
        details |= {"expanded": search.expanded, "search": search.ended or "budget", "weight": weight}
        if search.ended == "exhausted":  # whatever the weight, nothing cheaper is left
            if log.cost is None:
                return True
            log.prove(log.cost, "astar")
    return False
