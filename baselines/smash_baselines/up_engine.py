"""The testbed's planners as a unified-planning engine.

    from unified_planning.shortcuts import *
    get_environment().factory.add_engine("smash", "smash_baselines.up_engine", "SmashEngine")
    result = OneshotPlanner(name="smash").solve(problem)

`problem` is of one of our domains, or a classical blocks world; anything else is answered by `UNSUPPORTED_PROBLEM`.
"""

from __future__ import annotations

import json
import math
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import IO, Any

from unified_planning.engines import (
    AnytimeGuarantee,
    Credits,
    Engine,
    OptimalityGuarantee,
    SequentialPlanValidator,
)
from unified_planning.engines.mixins import AnytimePlannerMixin, OneshotPlannerMixin
from unified_planning.engines.results import (
    LogLevel,
    LogMessage,
    PlanGenerationResult,
    PlanGenerationResultStatus,
    ValidationResultStatus,
)
from unified_planning.exceptions import UPUsageError
from unified_planning.model import AbstractProblem, Problem, ProblemKind

from smash.planners.registry import DEFAULT
from smash.problem.errors import IllegalAction, Infeasible, MalformedFile, Unsupported
from smash.problem.files.documents import write_text
from smash.problem.files.plans import action_from_list, plan_from_document
from smash.problem.model import Action, Place
from smash.problem.problem import Problem as SmashProblem
from smash_baselines.engines.process import EngineProcess
from smash_baselines.read_up import Reading, reading_of
from smash_baselines.up_problem import up_plan
from smash_baselines.up_solver import JOB, job_document

NAME = "smash"
START_SECONDS = 120.0
"""Seconds that the solver has to load what it needs, before its clock starts."""
DEFAULT_BUDGET = 30.0
"""Seconds that a call without a timeout may take."""

_STATUS = {
    "optimal": PlanGenerationResultStatus.SOLVED_OPTIMALLY,
    "feasible": PlanGenerationResultStatus.SOLVED_SATISFICING,
    "infeasible": PlanGenerationResultStatus.UNSOLVABLE_PROVEN,
    "unknown": PlanGenerationResultStatus.TIMEOUT,
}


class SmashEngine(Engine, OneshotPlannerMixin, AnytimePlannerMixin):  # type: ignore[misc]
    """Solves problems of our domains and of classical blocks worlds with a planner of the registry.

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
        return NAME

    @staticmethod
    def supported_kind() -> ProblemKind:
        """Return the features of our domains and of blocks worlds, with costs, with a length, and without a metric."""
        kind = ProblemKind(version=2)
        kind.set_problem_class("ACTION_BASED")
        kind.set_typing("FLAT_TYPING")
        kind.set_typing("HIERARCHICAL_TYPING")
        for dress in ("NEGATIVE", "DISJUNCTIVE", "EXISTENTIAL", "UNIVERSAL"):
            kind.set_conditions_kind(f"{dress}_CONDITIONS")
        kind.set_conditions_kind("EQUALITIES")
        kind.set_effects_kind("CONDITIONAL_EFFECTS")
        kind.set_effects_kind("FORALL_EFFECTS")
        kind.set_quality_metrics("ACTIONS_COST")
        kind.set_quality_metrics("PLAN_LENGTH")
        kind.set_problem_type("SIMPLE_NUMERIC_PLANNING")
        kind.set_fluents_type("REAL_FLUENTS")
        kind.set_fluents_type("INT_FLUENTS")
        kind.set_effects_kind("INCREASE_EFFECTS")
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
        """Yield each better plan at once, and the final answer with what is proven last; closed, it stops the solver.

        Raises:
            UPUsageError: where the timeout is no span of time.
        """
        budget = DEFAULT_BUDGET if timeout is None else timeout
        if not 0 < budget < math.inf:
            raise UPUsageError(f"timeout: {timeout!r} is not allowed; seconds above 0")
        try:
            answers = _Answers(reading_of(problem), problem, self._planner)
        except (Unsupported, MalformedFile) as error:
            yield _failed(PlanGenerationResultStatus.UNSUPPORTED_PROBLEM, str(error))
            return
        except Infeasible as error:
            yield _failed(PlanGenerationResultStatus.UNSOLVABLE_PROVEN, str(error))
            return
        yield from answers.until(budget)


@dataclass(slots=True)
class _Answers:
    """The results of one problem, as a process of its own finds them; the library's validator judges every plan."""

    reading: Reading
    problem: Problem
    planner: str

    def until(self, budget: float) -> Iterator[PlanGenerationResult]:
        """Yield results until the last, or until nothing is to be expected any more."""
        asked = SmashProblem(self.reading.instance, self.reading.options)
        with tempfile.TemporaryDirectory(prefix="smash-", ignore_cleanup_errors=True) as folder:
            write_text(Path(folder) / JOB, json.dumps(job_document(asked, self.planner, budget)))
            with EngineProcess(
                [sys.executable, "-W", "ignore", "-m", "smash_baselines.up_solver"],
                directory=Path(folder),
                deadline=monotonic() + START_SECONDS,
                memory=sys.maxsize,
                limit_address_space=False,
                environment={"PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))},
            ) as solver:
                for line in solver.lines():
                    words = _words(line)
                    if "ready" in words:
                        solver.deadline = monotonic() + budget + max(0.05 * budget, 0.5)
                    elif "actions" in words:
                        found = self._intermediate(words["actions"])
                        if found.plan is not None:
                            yield found
                    elif words:
                        yield self._last(words)
                        return
                code = solver.returncode()
        yield self._silent(code, solver)

    def _intermediate(self, listed: Sequence[Any]) -> PlanGenerationResult:
        actions = [action_from_list(entry, "plan") for entry in listed]
        return self._checked(PlanGenerationResultStatus.INTERMEDIATE, actions, {})

    def _last(self, words: Mapping[str, Any]) -> PlanGenerationResult:
        if "failed" in words:
            unsupported = words["failed"] == "unsupported"
            status = PlanGenerationResultStatus
            return _failed(status.UNSUPPORTED_PROBLEM if unsupported else status.INTERNAL_ERROR, words["reason"])
        answer = plan_from_document(words["end"], "plan")
        metrics = {"planner": self.planner}
        if answer.lower_bound is not None:
            metrics |= {
                "lower_bound": str(self.reading.bound(answer.lower_bound)),
                "bound_origin": str(answer.bound_origin),
            }
        if answer.actions is None:
            return PlanGenerationResult(_STATUS[answer.status], None, NAME, metrics)
        actions = self._shortened(answer.actions)
        status = _STATUS[answer.status]
        longer = len(actions) == len(answer.actions) and self.reading.may_end_full
        if status == PlanGenerationResultStatus.SOLVED_OPTIMALLY and (longer or not self.reading.exact):
            status = PlanGenerationResultStatus.SOLVED_SATISFICING
        return self._checked(status, actions, metrics)

    def _shortened(self, actions: Sequence[Action]) -> Sequence[Action]:
        """Return a plan without its last place where the problem's goal holds with the block in the hand."""
        if self.reading.keeps_hand or not actions or not isinstance(actions[-1], Place):
            return actions
        shorter = self._checked(PlanGenerationResultStatus.INTERMEDIATE, actions[:-1], {})
        return actions if shorter.plan is None else actions[:-1]

    def _checked(
        self, status: PlanGenerationResultStatus, actions: Sequence[Action], metrics: dict[str, str]
    ) -> PlanGenerationResult:
        wrong = PlanGenerationResultStatus.INTERNAL_ERROR
        try:
            plan = up_plan(self.reading.steps(actions), self.problem)
        except (IllegalAction, Unsupported) as error:
            return _failed(wrong, f"the plan has no form in the problem's actions: {error}")
        verdict = SequentialPlanValidator().validate(self.problem, plan)
        if verdict.status != ValidationResultStatus.VALID:
            return _failed(wrong, f"the library's validator refuses the plan: {verdict}")
        return PlanGenerationResult(status, plan, NAME, metrics)

    def _silent(self, code: int | None, solver: EngineProcess) -> PlanGenerationResult:
        if solver.timed_out:
            return _failed(PlanGenerationResultStatus.TIMEOUT, "stopped: it did not end in time")
        words = next((line.strip() for line in reversed(solver.tail) if line.strip()), "no word")
        return _failed(PlanGenerationResultStatus.INTERNAL_ERROR, f"the solver ended with exit code {code}: {words}")


def _failed(status: PlanGenerationResultStatus, words: str) -> PlanGenerationResult:
    return PlanGenerationResult(status, None, NAME, log_messages=[LogMessage(LogLevel.ERROR, words)])


def _words(line: str) -> dict[str, Any]:
    try:
        words = json.loads(line)
    except ValueError:  # what a planner prints
        return {}
    return words if isinstance(words, dict) else {}
