"""The `astar` planner: greedy for the first plan, then exact search over states."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from smash.planners.astar.driver import StateSearch
from smash.planners.astar.restarts import search_law_states
from smash.planners.greedy import greedy_method
from smash.planners.protocol import Method, MethodPlanner, Settings, SolveLog, left, not_plain, plain
from smash.problem.actions.registry import FAMILY
from smash.problem.problem import Problem

GREEDY_SHARE = 0.1
"""Share of the budget for the first plans."""


class AStarPlanner(MethodPlanner):
    """Exact search over states with a bound from the precedence graph; memory-bounded.

    Where memory or time ends, the bound proven so far is reported.
    """

    summary: ClassVar[str] = "exact search over states; best with few buffers"
    proves: ClassVar[bool] = True
    aggregating: ClassVar[frozenset[str]] = frozenset(FAMILY)
    weighs: ClassVar[bool] = True
    open_goals: ClassVar[bool] = True
    gentle: ClassVar[bool] = True

    def methods(self, problem: Problem, settings: Settings) -> Sequence[Method]:
        """Return the greedy passes, the fast search, and the one that takes any action and any costs."""
        return (
            greedy_method(settings, GREEDY_SHARE),
            Method("numbered states", plain, search_numbered_states),
            Method("the law's states", not_plain, search_law_states),
        )


def search_numbered_states(problem: Problem, log: SolveLog, until: float) -> None:
    """Search for plans cheaper than the log's best until that is proven or `until` [s, clock of `perf_counter`]."""
    if log.upper is None:  # there was no time for a greedy plan, and the search needs one to be cheaper than
        return
    numbered = problem.numbered
    search = StateSearch(numbered, problem.options, log.upper, on_bound=lambda bound: log.prove(bound, "astar"))
    while search.ended is None and left(until) > 0:
        found = search.run(until)
        if found is not None:
            log.offer(numbered.actions(found), "exact")
    log.details |= {"expanded": search.expanded, "ended": search.ended or "budget"}
