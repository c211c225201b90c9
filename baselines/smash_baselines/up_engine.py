"""The testbed's planners as a unified-planning engine.

    from unified_planning.shortcuts import *
    get_environment().factory.add_engine("smash", "smash_baselines.up_engine", "SmashEngine")
    result = OneshotPlanner(name="smash").solve(problem)

`problem` is of one of our domains; anything else is answered by `UNSUPPORTED_PROBLEM`.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from queue import SimpleQueue
from typing import IO, Any

from unified_planning.engines import AnytimeGuarantee, Credits, Engine, OptimalityGuarantee
from unified_planning.engines.mixins import AnytimePlannerMixin, OneshotPlannerMixin
from unified_planning.engines.results import (
    LogLevel,
    LogMessage,
    PlanGenerationResult,
    PlanGenerationResultStatus,
)
from unified_planning.model import AbstractProblem, Problem, ProblemKind

from smash.planners.protocol import OnIncumbent, Settings, ask, why_refused
from smash.planners.registry import DEFAULT, get_planner
from smash.problem.errors import MalformedFile, SmashError, Unsupported
from smash.problem.model import Action
from smash.problem.plan import Plan
from smash.problem.problem import Problem as SmashProblem
from smash_baselines.read_problem import ReadProblem
from smash_baselines.read_up import read_up_problem
from smash_baselines.steps import steps_of
from smash_baselines.up_problem import up_plan

DEFAULT_BUDGET = 30.0
"""Seconds that a call without a timeout may take."""

_STATUS = {
    "optimal": PlanGenerationResultStatus.SOLVED_OPTIMALLY,
    "feasible": PlanGenerationResultStatus.SOLVED_SATISFICING,
    "infeasible": PlanGenerationResultStatus.UNSOLVABLE_PROVEN,
    "unknown": PlanGenerationResultStatus.TIMEOUT,
}


class SmashEngine(Engine, OneshotPlannerMixin, AnytimePlannerMixin):  # type: ignore[misc]
    """Solves problems of our domains with a planner of the registry.

    Args:
        planner: its name; an engine parameter, `OneshotPlanner(name="smash", params={"planner": "precedence"})`.
    """

    def __init__(self, planner: str = DEFAULT, **options: Any) -> None:
        Engine.__init__(self)
        OneshotPlannerMixin.__init__(self)
        AnytimePlannerMixin.__init__(self)
        self._planner = planner

    @property
    def name(self) -> str:
        """The engine's name."""
        return "smash"

    @staticmethod
    def supported_kind() -> ProblemKind:
        """Return the features of our domains."""
        kind = ProblemKind(version=2)
        kind.set_problem_class("ACTION_BASED")
        kind.set_typing("FLAT_TYPING")
        kind.set_typing("HIERARCHICAL_TYPING")
        kind.set_effects_kind("CONDITIONAL_EFFECTS")
        kind.set_effects_kind("FORALL_EFFECTS")
        kind.set_quality_metrics("ACTIONS_COST")
        kind.set_actions_cost_kind("INT_NUMBERS_IN_ACTIONS_COST")
        return kind

    @staticmethod
    def supports(problem_kind: ProblemKind) -> bool:
        """Return whether problems of this kind can be of our domains."""
        return bool(problem_kind <= SmashEngine.supported_kind())

    @staticmethod
    def satisfies(optimality_guarantee: OptimalityGuarantee) -> bool:
        """Return False for optimality: what is proven is said in the result, but not promised before."""
        return bool(optimality_guarantee == OptimalityGuarantee.SATISFICING)

    @staticmethod
    def ensures(anytime_guarantee: AnytimeGuarantee) -> bool:
        """Return True for plans that get better and better."""
        return bool(anytime_guarantee == AnytimeGuarantee.INCREASING_QUALITY)

    @staticmethod
    def get_credits(**kwargs: Any) -> Credits:
        """Return whose work this is."""
        return Credits(
            "smash",
            "The smash developers",
            "",
            "",
            "MIT",
            "Planning with topple actions in tabletop stack rearrangement.",
            "The SMASH gadget and exact methods of the testbed for stack rearrangement with topple actions.",
        )

    def _solve(
        self,
        problem: AbstractProblem,
        heuristic: Callable[[Any], float | None] | None = None,
        timeout: float | None = None,
        output_stream: IO[str] | None = None,
    ) -> PlanGenerationResult:
        *_, last = self._get_solutions(problem, timeout, output_stream)
        return last

    def _get_solutions(
        self,
        problem: AbstractProblem,
        timeout: float | None = None,
        output_stream: IO[str] | None = None,
    ) -> Iterator[PlanGenerationResult]:
        """Yield each better plan at once, and the final answer with what is proven last."""
        try:
            read = read_up_problem(problem)
        except (Unsupported, MalformedFile) as error:
            yield self._failed(PlanGenerationResultStatus.UNSUPPORTED_PROBLEM, error)
            return
        heard: SimpleQueue[Sequence[Action] | Plan | Exception] = SimpleQueue()
        budget = DEFAULT_BUDGET if timeout is None else timeout
        threading.Thread(target=self._run, args=(read, budget, heard), daemon=True).start()
        while True:
            news = heard.get()
            if isinstance(news, Plan):
                yield self._final(news, read, problem)
                return
            if isinstance(news, Exception):
                yield self._failed(_status_of(news), news)
                return
            yield self._intermediate(news, read, problem)

    def _run(self, read: ReadProblem, budget: float, heard: SimpleQueue[Any]) -> None:
        asked, settings = SmashProblem(read.instance, read.options), Settings()
        report: OnIncumbent = lambda _seconds, _cost, actions: heard.put(tuple(actions))  # noqa: E731
        try:
            planner = get_planner(self._planner)
            reason = why_refused(planner, asked, settings)
            if reason:
                raise Unsupported(reason)
            heard.put(ask(planner, asked, settings, budget, report, name=self._planner))
        except Exception as error:  # whatever ends the thread must reach the caller, who waits for it
            heard.put(error)

    def _intermediate(self, actions: Sequence[Action], read: ReadProblem, problem: Problem) -> PlanGenerationResult:
        plan = up_plan(steps_of(actions, read.task), problem)
        return PlanGenerationResult(PlanGenerationResultStatus.INTERMEDIATE, plan, self.name)

    def _final(self, result: Plan, read: ReadProblem, problem: Problem) -> PlanGenerationResult:
        plan = None if result.actions is None else up_plan(steps_of(result.actions, read.task), problem)
        metrics = {"planner": self._planner}
        if result.lower_bound is not None:
            metrics |= {"lower_bound": str(result.lower_bound), "bound_origin": str(result.bound_origin)}
        return PlanGenerationResult(_STATUS[result.status], plan, self.name, metrics)

    def _failed(self, status: PlanGenerationResultStatus, error: Exception) -> PlanGenerationResult:
        return PlanGenerationResult(status, None, self.name, log_messages=[LogMessage(LogLevel.ERROR, str(error))])


def _status_of(error: Exception) -> PlanGenerationResultStatus:
    if isinstance(error, Unsupported):
        return PlanGenerationResultStatus.UNSUPPORTED_PROBLEM
    if not isinstance(error, SmashError):
        raise error
    return PlanGenerationResultStatus.INTERNAL_ERROR
