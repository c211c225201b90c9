"""The `astar` planner: greedy for the first plan, then exact search over states."""

from __future__ import annotations

from time import perf_counter
from typing import Any, ClassVar

from smash.planners.astar.driver import StateSearch
from smash.planners.astar.law_solve import offer_twin, search_family
from smash.planners.greedy import greedy_steps
from smash.planners.protocol import BasePlanner, IncumbentLog, OnIncumbent, PlanResult, SolveOptions
from smash.problem.actions.registry import FAMILY, is_plain
from smash.problem.model import Instance
from smash.problem.views.numbered import Indexed


class AStarPlanner(BasePlanner):
    """Exact search over states with a bound from the precedence graph; memory-bounded."""

    summary: ClassVar[str] = "exact search over states; best with few buffers"
    proves: ClassVar[bool] = True
    aggregating: ClassVar[frozenset[str]] = frozenset(FAMILY)
    weighs: ClassVar[bool] = True

    def solve(
        self,
        instance: Instance,
        options: SolveOptions,
        budget: float,
        on_incumbent: OnIncumbent | None = None,
    ) -> PlanResult:
        """Search for at most `budget` seconds; where memory or time ends, the bound proven so far is reported."""
        log = IncumbentLog(instance, options, on_incumbent, gentle=True)
        deadline = perf_counter() + budget
        if not is_plain(instance, options):
            return self._family(instance, options, log, deadline)
        impossible = log.without_plan()
        if impossible is not None:
            return impossible
        problem = Indexed.of(instance)
        for steps in greedy_steps(problem, options, perf_counter() + budget / 10, options.seed):
            log.offer(problem.actions(steps), "greedy")
        assert log.cost is not None
        log.prove(0, "start")
        search = StateSearch(problem, options, log.cost, on_bound=lambda bound: log.prove(bound, "astar"))
        while search.ended is None and perf_counter() < deadline:
            found = search.run(deadline)
            if found is not None:
                log.offer(problem.actions(found), "exact")
        details = {"expanded": search.expanded, "ended": search.ended or "budget"}
        return log.result(details=details)

    def _family(self, instance: Instance, options: SolveOptions, log: IncumbentLog, deadline: float) -> PlanResult:
        """Search over the law's states: slower, for any aggregating action and any costs."""
        details: dict[str, Any] = {}
        offer_twin(instance, options, log, perf_counter() + (deadline - perf_counter()) / 10)
        if search_family(instance, options, log, deadline, details):
            return log.result(infeasible=True, bound_origin="astar", details=details)
        return log.result(details=details)
