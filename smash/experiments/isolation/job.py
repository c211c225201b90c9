"""One run as data: the job that a run is given, the report that it gives back."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from smash.planners.protocol import Settings
from smash.problem.files.instances import instance_document, instance_from_document
from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.plan import Incumbent, Plan, Status
from smash.problem.problem import Problem
from smash.problem.rules import Verdict
from smash.records.outcomes import OUTCOMES, OutcomeName

DEFAULT_MEMORY = 4096
"""Memory limit of a run's whole process tree [MiB], where none is given."""

STARTUP_LIMIT = 120.0
"""Seconds that a planner has for its import and `prepare` (compiling included), before its clock starts."""


def grace(budget: float) -> float:
    """Return how long a planner may run beyond its budget before it is stopped [s]."""
    return max(0.05 * budget, 0.5)


@dataclass(frozen=True, slots=True)
class Job:
    """One call of a planner: `budget` in seconds of wall time, `memory` in MiB over all of its processes."""

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
    """How a run ended and what it left: the best legal plan, every incumbent, and what it used.

    `verdict` is the law's on the plan that the planner answered with, None where it answered with none.
    `memory_mib` is the peak over the process tree; `log` the last lines that the planner's processes printed.
    """

    outcome: OutcomeName
    status: Status
    reason: str = ""
    actions: tuple[Action, ...] | None = None
    lower_bound: int | None = None
    bound_origin: str | None = None
    incumbents: tuple[Incumbent, ...] = ()
    verdict: Verdict | None = None
    details: dict[str, Any] = field(default_factory=dict)
    wall_seconds: float | None = None
    cpu_seconds: float | None = None
    memory_mib: float | None = None
    log: str = ""

    @property
    def exit_code(self) -> int:
        """The exit code of `smash plan` for this end."""
        if self.outcome == "over-budget" and self.actions is not None:
            return 0
        return OUTCOMES[self.outcome].exit_code

    def plan(self, job: Job) -> Plan:
        """Return the plan as it is filed."""
        return Plan(
            instance=job.instance.name,
            planner=job.planner,
            options=job.options,
            status=self.status,
            actions=self.actions,
            lower_bound=self.lower_bound,
            bound_origin=self.bound_origin,
            incumbents=self.incumbents,
            stated_cost=None if self.actions is None else job.problem.law.price(self.actions),
        )
