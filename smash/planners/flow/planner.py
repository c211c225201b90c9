"""The planner `smash-flow`: the paper's method on HiGHS, cold or started from another planner's plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING, ClassVar

from smash.planners.protocol import BasePlanner, IncumbentLog, OnIncumbent, PlanResult, SolveOptions
from smash.problem.errors import MalformedFile
from smash.problem.model import Action, Instance, State
from smash.problem.rules import Law

if TYPE_CHECKING:
    from smash.planners.milp.arrays import Milp

MARGIN = 0.04
"""Share of the budget that is left for HiGHS to notice its time limit and for reading the last solution."""
WARM_SHARE = 0.25
"""Share of the budget that the planner of a warm start may take."""


class FlowPlanner(BasePlanner):
    """Time-expanded multi-commodity flow on the gadget ("Computing a candidate task plan"), anytime.

    Every goal kind, starts on buffers and on the table, caps. A horizon that is too short proves nothing by
    itself; see `smash.planners.flow.search` for what it does prove.
    """

    summary: ClassVar[str] = "the paper's time-expanded flow on the gadget, as a MILP (HiGHS)"
    proves: ClassVar[bool] = True
    aggregating: ClassVar[frozenset[str]] = frozenset({"topple", "carry", "lift"})
    weighs: ClassVar[bool] = True

    def prepare(self) -> None:
        """Load numpy and HiGHS."""
        import highspy  # noqa: F401

        import smash.planners.flow.search  # noqa: F401

    def solve(
        self,
        instance: Instance,
        options: SolveOptions,
        budget: float,
        on_incumbent: OnIncumbent | None = None,
    ) -> PlanResult:
        """Plan within `budget` seconds, model building included."""
        deadline = perf_counter() + budget * (1 - MARGIN)
        log = IncumbentLog(instance, options, on_incumbent)
        if Law(instance, options).goal_shortfall(State.start_of(instance)) is None:
            log.offer((), "milp")
            log.prove(0, "start")
            return log.result()
        impossible = log.without_plan()
        if impossible is not None:
            return impossible
        if options.warm_start is not None:
            self._warm(options.warm_start, instance, options, log, WARM_SHARE * budget)
        from smash.planners.flow.search import FlowSearch, TooLarge

        try:
            search = FlowSearch(instance, options, log, deadline)
        except TooLarge as error:
            return log.result(details={"stopped": str(error)})
        try:
            search.run()
        except TooLarge as error:
            search.details["stopped"] = str(error)
        if log.refusals:
            search.details["refusals"] = list(log.refusals)
        return log.result(details=search.details)

    def build_model(self, instance: Instance, options: SolveOptions) -> Milp:
        """Return the model that `solve` starts with (of `options.horizon` steps, if given), without solving it.

        Raises:
            SmashError: where the start is the goal, no plan exists, or the model is too large.
        """
        from smash.planners.flow.search import FlowSearch

        log = IncumbentLog(instance, options)
        if Law(instance, options).goal_shortfall(State.start_of(instance)) is None:
            raise MalformedFile(instance.name, "the start is the goal: there is no model to build")
        if options.warm_start is not None:
            self._warm(options.warm_start, instance, options, log, 1.0)
        search = FlowSearch(instance, options, log, float("inf"))
        return search.model(options.horizon or search.first_horizon()).milp

    @staticmethod
    def _warm(name: str, instance: Instance, options: SolveOptions, log: IncumbentLog, budget: float) -> None:
        """Offer another planner's plans."""
        from smash.planners.registry import get_planner

        def offer(_seconds: float, _cost: int, actions: Sequence[Action]) -> None:
            log.offer(actions, name)

        get_planner(name).solve(instance, replace(options, warm_start=None, horizon=None), budget, offer)
