"""A* over the law's own states, restarted with falling weights of the estimate; the last restart is exact."""

from __future__ import annotations

import math

from smash.planners.astar.law_search import LawSearch
from smash.planners.protocol import SolveLog, left
from smash.problem.problem import Problem

WEIGHTS = ((4.0, 0.1), (1.5, 0.25), (1.0, 1.0))
"""Weights of the estimate, and the share of the time left that the search with each may take."""


def search_law_states(problem: Problem, log: SolveLog, until: float) -> None:
    """Search until the log is settled or `until` [s, clock of `perf_counter`]: any aggregating action, any costs.

    The details get the number of expanded states and the end of the last search.
    """
    for weight, share in WEIGHTS:
        if log.settled:
            return
        search = LawSearch(problem.law, weight=weight, below=math.inf if log.upper is None else log.upper)
        log.prove(search.bound, "places")
        stop = until - (1.0 - share) * left(until)
        while search.ended is None and not log.settled and left(stop) > 0:
            plan = search.run(stop, lambda bound: log.prove(bound, "astar"))
            if plan is None:
                break
            log.offer(plan, "exact")
            if weight > 1.0:
                break
        log.details |= {"expanded": search.expanded, "search": search.ended or "budget", "weight": weight}
        if search.ended == "exhausted":  # whatever the weight, nothing cheaper is left
            if log.upper is None:
                log.refute("astar")
            else:
                log.prove(log.upper, "astar")
            return
