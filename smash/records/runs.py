"""A run: `smash-run/1`, one line of `runs.jsonl`: an encoded plan and how it ended."""

from __future__ import annotations

import hashlib
import json
from typing import Any, Final, Literal

import msgspec

from smash.problem.files.instances import instance_document
from smash.problem.files.plans import PLAN_FORMAT_2, plan_document, plan_from_document
from smash.problem.model import Instance
from smash.problem.plan import Plan, Status
from smash.records.outcomes import OutcomeName
from smash.records.record import Amount, Commit, Count, Machine, Record, Seconds

RUN_FORMAT: Final = "smash-run/1"
RunKind = Literal["anytime", "budget", "cutoff"]
"""`anytime`: stands for every smaller budget too; `budget`: for its own alone; `cutoff`: checks that reading."""
PLAN_FIELDS = (
    *("instance", "planner", "topple", "max_topple", "without", "status", "cost"),
    *("lower_bound", "bound_origin", "incumbents", "actions"),
)


class VerdictField(msgspec.Struct, frozen=True):
    """The law's verdict; `step` is 1-based, None where the plan as a whole is refused."""

    accepted: bool
    reason: str
    step: int | None


class RunRecord(Record, kw_only=True, frozen=True):
    """One run; `docs/records.md` says what each field means and its unit."""

    format: Literal["smash-run/1"]
    key: str
    experiment: str
    label: str
    suite: str
    variant: str
    kind: RunKind
    instance: str
    planner: str
    topple: bool
    max_topple: Count | None
    status: Status
    cost: Count | None
    lower_bound: Count | None
    bound_origin: str | None
    incumbents: list[tuple[Seconds, Count, str]]
    actions: list[list[str | Count]] | None
    outcome: OutcomeName
    reason: str
    verdict: VerdictField | None
    budget: Seconds
    budgets: list[Seconds]
    memory_limit_mib: Count
    warm_start: str | None
    horizon: Count | None
    threads: Count
    seed: Count
    blocks: Count
    stacks: Count
    buffers: Count
    instance_hash: str
    instance_document: dict[str, Any]
    wall_seconds: Seconds | None
    cpu_seconds: Seconds | None
    memory_mib: Amount | None
    details: dict[str, Any]
    log: str
    started: str
    load_average: tuple[float, float]
    versions: dict[str, str]
    commit: Commit
    machine: Machine
    without: list[str] = msgspec.field(default_factory=list)
    command: str | None = None
    solver: str = "highs"
    objective: str = "actions"
    robust: bool = False
    expected_seconds: Seconds | None = None

    @property
    def trace(self) -> list[tuple[float, int]]:
        """(seconds, cost) of the incumbents that count: none where the law refused what the planner answered.

        Of a plan for seconds, which may have more actions than the planner's best, no incumbent counts for less than
        that plan.
        """
        least = self.cost if self.objective == "seconds" and self.cost is not None else 0
        found: dict[int, float] = {}
        for seconds, cost, _ in self.incumbents if self.outcome != "refused" else ():
            found.setdefault(max(cost, least), seconds)
        return [(seconds, cost) for cost, seconds in found.items()]

    @property
    def plan(self) -> Plan:
        """The plan that it holds.

        Raises:
            MalformedFile: where it is malformed.
        """
        fields = {name: getattr(self, name) for name in PLAN_FIELDS} | {"expected_seconds": self.expected_seconds}
        return plan_from_document({"format": PLAN_FORMAT_2, **fields}, "record")


def instance_hash(instance: Instance) -> str:
    """Return a hash of the whole instance, its name included."""
    return hashlib.sha256(json.dumps(instance_document(instance)).encode()).hexdigest()[:16]


def plan_fields(plan: Plan) -> dict[str, Any]:
    """Return the fields of a record that hold a plan."""
    document = plan_document(plan)
    return {name: document.get(name, []) for name in PLAN_FIELDS}
