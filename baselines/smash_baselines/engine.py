"""What all PDDL baselines share: compile, run an engine within the budget, read its plans back through the law."""

from __future__ import annotations

import tempfile
from abc import abstractmethod
from collections.abc import Iterable
from copy import copy
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Any, ClassVar, Self

from smash.planners.protocol import OnIncumbent, ProblemPlanner, Settings, SolveLog
from smash.planners.protocol.tested import most_sum
from smash.problem.errors import IllegalAction, PlannerCrashed, PlannerOutOfMemory, Unsupported
from smash.problem.feasibility import why_contradictory
from smash.problem.model import Instance
from smash.problem.plan import Plan
from smash.problem.problem import Problem
from smash_baselines.encodings import COMPOSED, UnknownEncoding, encoding_names, get_encoding, unsupported_reason
from smash_baselines.engines.outcomes import Outcome
from smash_baselines.engines.process import MEMORY_LIMIT
from smash_baselines.engines.tested import beyond_tests
from smash_baselines.facts import named_blocks, trim_buffers
from smash_baselines.goal_words import told
from smash_baselines.names import Step
from smash_baselines.parts.registry import TOLD
from smash_baselines.steps import actions_of
from smash_baselines.task import PddlTask, compile_instance


@dataclass(slots=True)
class Run:
    """One run of an engine on one task: its limits, the plans that it reports, what it measures.

    Attributes:
        infeasible: whether the engine says that there is no plan.
    """

    task: PddlTask
    log: SolveLog
    origin: str
    directory: Path
    deadline: float
    memory: int
    infeasible: bool = False

    @property
    def details(self) -> dict[str, Any]:
        """What only this engine measures."""
        return self.log.details

    def offer(self, steps: Iterable[Step]) -> None:
        """Take a plan of the engine; one that does not fit the encoding or the law is recorded as refused."""
        try:
            self.log.offer(actions_of(steps, self.task), self.origin)
        except IllegalAction as error:
            self.log.refusals.append(f"{self.origin}: {error}")

    def raise_bound(self, bound: int) -> None:
        """Take a lower bound that the engine proved; where it is not believed it is noted as a claim."""
        self.log.conclude(bound, self.origin)


MOST_SUM = 2**31 - 1
"""Highest sum of costs that engines are trusted with: theirs are 32-bit integers, which wrap around unsaid."""


def beyond_integers(instance: Instance) -> str | None:
    """Return why the costs of an instance are beyond what engines can sum, or None."""
    most = most_sum(instance)
    if most <= MOST_SUM:
        return None
    return f"its costs may add up to {most:,}; engines count to {MOST_SUM:,}"


class EnginePlanner(ProblemPlanner):
    """A planner that hands the compiled problem to an engine outside of this process."""

    name: str
    """The engine's name in incumbents and bounds."""
    encoding: str
    """How topples are told to it: `conditional`, `chain`, or an encoding that others registered."""
    falls_back: bool = False
    """Whether it takes the chain for problems that its encoding cannot say because they go beyond topple at cost 1."""
    aggregating: ClassVar[frozenset[str]] = TOLD
    weighs: ClassVar[bool] = True
    open_goals: ClassVar[bool] = True
    holds: ClassVar[bool] = True

    def __init__(self, memory: int = MEMORY_LIMIT) -> None:
        """Make the planner.

        Args:
            memory: limit for all processes of the engine together [bytes].
        """
        self.memory = memory

    def refuses(self, problem: Problem, settings: Settings) -> str | None:
        """Return why the encoding cannot say the problem, or None."""
        encoding = self.encoding_of(problem)
        reason = unsupported_reason(problem, encoding) or beyond_integers(problem.instance)
        if reason is not None or not problem.options.topple or self.takes_conditional_effects():
            return reason
        if get_encoding(encoding).conditional_effects:
            return f"it takes no conditional effects, which the {encoding} encoding has; use the chain encoding"
        return None

    def encoding_of(self, problem: Problem) -> str:
        """Return how this problem is told to it."""
        return self.encoding if not self.falls_back or problem.plain else COMPOSED

    def with_encoding(self, encoding: str) -> Self:
        """Return the same planner on another encoding: what `NAME:ENCODING` means.

        Raises:
            UnknownEncoding: where none is called so.
        """
        if encoding not in encoding_names():
            raise UnknownEncoding(encoding, encoding_names())
        other = copy(self)
        other.falls_back = False
        other.name, other.encoding = f"{self.name.partition(':')[0]}:{encoding}", encoding
        return other

    def takes_conditional_effects(self) -> bool:
        """Return whether it takes encodings with conditional effects."""
        return True

    def plan(
        self, problem: Problem, settings: Settings, budget: float, on_incumbent: OnIncumbent | None = None
    ) -> Plan:
        """Plan for at most `budget` seconds, compilation and the engine's translation included.

        A goal that contradicts itself is answered at once; every other proof is the engine's own.

        Args:
            problem: what to plan.
            settings: nothing of them means anything to an engine.
            budget: seconds of wall time.
            on_incumbent: called with every better plan.

        Raises:
            Unsupported: where the encoding or the engine cannot take the problem.
            PlannerCrashed: where the engine ends abnormally or at its memory limit without a plan.
        """
        deadline = monotonic() + budget
        log = SolveLog(problem, on_incumbent)
        if problem.solved:
            log.offer((), "start")
            log.prove(0, "start")
            return log.plan()
        contradiction = why_contradictory(problem.instance.goal)
        if contradiction is not None:
            log.refute("feasibility", contradiction)
            return log.plan()
        instance = told(problem)
        task = compile_instance(
            trim_buffers(instance), problem.options, self.encoding_of(problem), named_blocks(instance)
        )
        with tempfile.TemporaryDirectory(prefix="smash-", ignore_cleanup_errors=True) as folder:
            log.doubt = beyond_tests(self.name, problem.instance)
            run = Run(task, log, self.name, Path(folder), deadline, self.memory)
            run.details["encoding"] = task.encoding.name
            run.details["compile_seconds"] = round(log.elapsed, 4)
            outcome = self.run(run)
        return self._answer(run, outcome)

    @abstractmethod
    def run(self, run: Run) -> Outcome:
        """Run the engine: offer its plans and bounds to `run` as they come, and say how it ended."""

    def _answer(self, run: Run, outcome: Outcome) -> Plan:
        run.details["outcome"] = outcome.text
        if run.log.refusals:
            run.details["refused"] = list(run.log.refusals)
        if run.log.best is None and outcome.kind == "memory":
            raise PlannerOutOfMemory(f"{self.name}: {outcome.text} ({run.memory >> 20} MiB)")
        if run.log.best is None and outcome.kind == "crashed":
            raise PlannerCrashed(f"{self.name}: {outcome.text}{_last_words(run)}")
        if run.log.best is None and outcome.kind == "unsupported":
            raise Unsupported(f"{self.name}: {outcome.text}")
        if run.infeasible:
            run.log.conclude_none(self.name)
        return run.log.plan()


def _last_words(run: Run) -> str:
    words = run.details.get("last_words")
    return f" ({words})" if words else ""
