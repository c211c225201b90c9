"""`precedence`: proven optima without a time index, from the cycles of one precedence graph (`docs/theory.md`)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from time import perf_counter
from typing import Any, ClassVar

from smash.planners.protocol import BasePlanner, IncumbentLog, OnIncumbent, PlanResult, SolveOptions
from smash.problem.model import Action, Instance

SPARE_SECONDS = 0.05
"""Kept back from the budget for the end of the solver's last run and for checking the last plan."""


GREEDY_SHARE = 0.1
"""Share of the time left that the greedy planner gets where the exact choices need more buffers than there are."""


class PrecedencePlanner(BasePlanner):
    """Fewest choices that hit every cycle of the precedence graph, scheduled with the locations there are.

    Where the schedule fits, its plan is optimal. Where it needs more buffers than there are, the value
    is a lower bound, and the details say so.
    """

    summary: ClassVar[str] = "exact: cheapest hitting set of the precedence graph's cycles (HiGHS), no time index"
    proves: ClassVar[bool] = True

    def prepare(self) -> None:
        """Load the solver and the arrays, so that no import is counted as planning."""
        from smash.planners.precedence import bound  # noqa: F401

    def solve(
        self,
        instance: Instance,
        options: SolveOptions,
        budget: float,
        on_incumbent: OnIncumbent | None = None,
    ) -> PlanResult:
        """Plan for at most `budget` seconds of wall time."""
        deadline = perf_counter() + budget - min(SPARE_SECONDS, budget / 10)
        log = IncumbentLog(instance, options, on_incumbent, gentle=True)
        impossible = log.without_plan()
        if impossible is not None:
            return impossible
        from smash.planners.precedence.bound import ORIGIN, precedence_bound

        def fall_back() -> None:
            for actions in _greedy_plans(instance, options, (deadline - perf_counter()) * GREEDY_SHARE):
                log.offer(actions, "greedy")

        found = precedence_bound(
            instance,
            options,
            deadline,
            lambda actions: log.offer(actions, "exact"),
            options.threads,
            fall_back,
            lambda bound: log.prove(bound, ORIGIN),
        )
        details: dict[str, Any] = {
            "choices": len(found.graph.choices),
            "rows": len(found.hitting_set.rows),
            "rounds": dict(found.hitting_set.rounds),
            "relaxed_cost": found.relaxed_cost,
        }
        if found.actions is None:
            details["reason"] = (
                f"no plan of cost {found.relaxed_cost} found with {len(instance.buffers)} buffers; "
                "the value is a lower bound"
            )
        return log.result(details=details)


def _greedy_plans(instance: Instance, options: SolveOptions, seconds: float) -> Iterator[Sequence[Action]]:
    from smash.planners.greedy import greedy_steps
    from smash.problem.views.numbered import Indexed

    problem = Indexed.of(instance)
    for steps in greedy_steps(problem, options, perf_counter() + seconds, options.seed):
        yield problem.actions(steps)
