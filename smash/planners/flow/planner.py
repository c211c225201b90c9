"""The planner `smash-flow`: the paper's method, cold or started from another planner's plan."""

from __future__ import annotations

import math
from collections.abc import Sequence
from time import perf_counter
from typing import TYPE_CHECKING, ClassVar

from smash.planners.milp.planner import MilpPlanner
from smash.planners.milp.warm_start import warm_starts
from smash.planners.protocol import Method, Settings, SolveLog, anything, plan_options, settings_of
from smash.problem.errors import MalformedFile
from smash.problem.model import Instance, PlanOptions
from smash.problem.problem import Problem

if TYPE_CHECKING:
    from smash.planners.milp.arrays import Milp

MARGIN = 0.04
"""Share of the budget that is left for a solver to notice its time limit and for reading the last solution."""
WARM_SHARE = 0.25
"""Share of the budget that the planner of a warm start may take."""
MODEL_WARM_SECONDS = 1.0
"""For the planner of a warm start where the model is built and not solved."""


class FlowPlanner(MilpPlanner):
    """Time-expanded multi-commodity flow on the gadget ("Computing a candidate task plan"), anytime.

    Every goal kind, starts on buffers and on the table, caps. A horizon that is too short proves nothing by
    itself; see `smash.planners.flow.search` for what it does prove.
    """

    summary: ClassVar[str] = "the paper's time-expanded flow on the gadget, as a MILP"
    proves: ClassVar[bool] = True
    aggregating: ClassVar[frozenset[str]] = frozenset({"topple", "carry", "lift"})
    weighs: ClassVar[bool] = True
    kept_back: ClassVar[float] = MARGIN

    def prepare(self) -> None:
        """Load numpy and the model."""
        import smash.planners.flow.search  # noqa: F401

    def methods(self, problem: Problem, settings: Settings) -> Sequence[Method]:
        """Return the warm start, where one is asked for, and the flow models of growing horizon."""

        def flow(problem: Problem, log: SolveLog, until: float) -> None:
            from smash.planners.flow.search import FlowSearch, TooLarge

            try:
                FlowSearch(problem, settings, log, until).run()
            except TooLarge as error:
                log.details["stopped"] = str(error)
            if log.refusals:
                log.details["refusals"] = list(log.refusals)

        return (*warm_starts(settings, WARM_SHARE), Method("flow", anything, flow))

    def build_model(self, instance: Instance, options: PlanOptions) -> Milp:
        """Return the model that planning starts with (of the options' horizon, if they have one), without solving it.

        Raises:
            SmashError: where the start is the goal, no plan exists, or the model is too large.
        """
        from smash.planners.flow.search import FlowSearch

        problem, settings = Problem(instance, plan_options(options)), settings_of(options)
        if problem.solved:
            raise MalformedFile(instance.name, "the start is the goal: there is no model to build")
        log = SolveLog(problem)
        for method in warm_starts(settings, WARM_SHARE):
            if method.takes(problem) is None:
                method.run(problem, log, perf_counter() + MODEL_WARM_SECONDS)
        search = FlowSearch(problem, settings, log, math.inf)
        return search.model(settings.horizon or search.first_horizon()).milp
