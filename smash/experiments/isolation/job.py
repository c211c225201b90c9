"""One run as data: the job that a run is given, the report that it gives back."""

from __future__ import annotations

import os
import sys
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from smash.planners.protocol import Settings
from smash.problem.files.instances import instance_document, instance_from_document
from smash.problem.model import Instance, PlanOptions
from smash.problem.plan import Plan
from smash.problem.problem import Problem
from smash.problem.rules import Verdict
from smash.problem.words import counted
from smash.records.outcomes import OUTCOMES, OutcomeName

DEFAULT_MEMORY = 4096
"""Memory limit of a run's whole process tree [MiB], where none is given."""

STARTUP_LIMIT = 120.0
"""Seconds that a planner has for its import and `prepare` (compiling included), before its clock starts."""

_PATIENCE = 20.0
"""Seconds beyond all limits after which whoever guards a run, and says nothing, is given up."""


def grace(budget: float) -> float:
    """Return how long a planner may run beyond its budget before it is stopped [s]."""
    return max(0.05 * budget, 0.5)


def still_running(after: float, budget: float) -> str:
    """Say that a planner was stopped beyond its budget [s]."""
    return f"still running after {after:.1f} s on a budget of {budget:g} s: stopped"


def load() -> str:
    """Say how busy the machine is: where it is, work begins late, and that is no fault of the work's."""
    usable = os.sched_getaffinity(0) if sys.platform == "linux" else range(os.cpu_count() or 1)
    return f"load {os.getloadavg()[0]:.1f} on {counted(len(usable), 'processor')}"


def longest(budget: float) -> float:
    """Return how long a run can take at most, start and end included, before something has gone wrong [s]."""
    return STARTUP_LIMIT + budget + grace(budget) + _PATIENCE


@dataclass(frozen=True, slots=True)
class Job:
    """One call of a planner: `budget` in seconds of wall time, `memory` in MiB over all of its processes."""

    done_by: ClassVar[str] = "smash.experiments.isolation.solving:solve"
    loaded_by: ClassVar[str] = "smash.experiments.isolation.solving:load"

    planner: str
    problem: Problem
    settings: Settings
    budget: float
    memory: int = DEFAULT_MEMORY

    @property
    def instance(self) -> Instance:
        """The instance of its problem."""
        return self.problem.instance

    @property
    def options(self) -> PlanOptions:
        """What a plan of its problem may use."""
        return self.problem.options

    def document(self) -> dict[str, Any]:
        """Return the job as JSON data."""
        return {
            "planner": self.planner,
            "instance": instance_document(self.instance),
            "options": asdict(self.options),
            "settings": asdict(self.settings),
            "budget": self.budget,
            "memory": self.memory,
        }

    @classmethod
    def from_document(cls, document: dict[str, Any]) -> Job:
        """Build a job from its JSON data."""
        options = document["options"] | {"without": tuple(document["options"]["without"])}
        return cls(
            document["planner"],
            Problem(instance_from_document(document["instance"]), PlanOptions(**options)),
            Settings(**document["settings"]),
            document["budget"],
            document["memory"],
        )


@dataclass(frozen=True, slots=True)
class Report:
    """How a run ended and what it left.

    Attributes:
        outcome: its end, by name.
        plan: the best legal plan and the best bound, with every incumbent.
        reason: why it ended so, in one line; empty where there is nothing to explain.
        verdict: the law's on the plan that the planner answered with, None where it answered with none.
        wall_seconds: from the start of its clock to its end.
        cpu_seconds: of the planner's process.
        memory_mib: peak over the process tree.
        log: the last lines that the planner's processes printed.
    """

    outcome: OutcomeName
    plan: Plan
    reason: str = ""
    verdict: Verdict | None = None
    wall_seconds: float | None = None
    cpu_seconds: float | None = None
    memory_mib: float | None = None
    log: str = ""

    @property
    def exit_code(self) -> int:
        """The exit code of `smash plan` for this end."""
        if self.outcome == "over-budget" and self.plan.actions is not None:
            return 0
        return OUTCOMES[self.outcome].exit_code
