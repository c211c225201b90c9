"""The greedy planner: a feasible plan at any size, wherever one exists, and better ones by a few more passes."""

from __future__ import annotations

from collections.abc import Sequence
from time import perf_counter
from typing import ClassVar

from smash.planners.greedy.passes import GreedyRun
from smash.planners.protocol import Method, MethodPlanner, Settings, SolveLog, anything
from smash.problem.actions.registry import FAMILY
from smash.problem.problem import Problem


class GreedyPlanner(MethodPlanner):
    """Direct moves first; else topple, or put aside where it costs the least later; then passes that improve.

    It plans with pick, place and topple alone: whatever else there is, such a plan remains one.
    """

    summary: ClassVar[str] = "a plan at any size in near-linear time; infeasibility decided at once"
    aggregating: ClassVar[frozenset[str]] = frozenset(FAMILY)
    weighs: ClassVar[bool] = True
    open_goals: ClassVar[bool] = True
    gentle: ClassVar[bool] = True

    def methods(self, problem: Problem, settings: Settings) -> Sequence[Method]:
        """Return its passes, which take every problem."""
        return (greedy_method(settings),)


def greedy_method(settings: Settings, share: float = 1.0) -> Method:
    """Return the greedy passes as a method, for the first plans of other planners too."""

    def run(problem: Problem, log: SolveLog, until: float) -> None:
        for actions in GreedyRun(problem, settings.seed).plans(until, first_until=end_of(until, share)):
            log.offer(actions, "greedy")

    return Method("greedy", anything, run, share)


def end_of(until: float, share: float) -> float:
    """Return when all of the time is over of which a `share` ends at `until` [s, `perf_counter`]."""
    now = perf_counter()
    return now + (until - now) / share
