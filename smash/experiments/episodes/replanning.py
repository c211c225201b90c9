"""Planners as the executor wants them: a function from an observed instance to a plan."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from smash.experiments.isolation.caller import run_isolated
from smash.experiments.isolation.job import Job
from smash.planners.protocol import Settings
from smash.planners.registry import why_unknown
from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.problem import Problem

FALLBACK = "greedy"
"""Plans at once, any start and goal: asked where the chosen planner has no answer."""


def replanner(planner: str, budget: float, seed: int = 0) -> Callable[[Instance, PlanOptions], Sequence[Action] | None]:
    """Return a function that plans by `planner`, in processes of its own, and by `FALLBACK` where that fails.

    Args:
        planner: A registered name; `FALLBACK` alone is used where nobody is called so.
        budget: Seconds of wall time for each plan.
        seed: For planners that draw.
    """
    names = [name for name in dict.fromkeys((planner, FALLBACK)) if why_unknown(name) is None]

    def plan(instance: Instance, options: PlanOptions) -> Sequence[Action] | None:
        for name in names:
            report = run_isolated(Job(name, Problem(instance, options), Settings(seed=seed), budget))
            if report.actions is not None:
                return report.actions
        return None

    return plan
