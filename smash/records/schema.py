"""The fields of `smash-run/1` and `smash-episode-run/1` as types; `docs/records.md` says what each means and its unit.

Within version 1 fields may be added, so unknown ones are let through; one that goes, or changes what it means,
makes it `smash-run/2`.
"""

from __future__ import annotations

from typing import Any, Literal

import msgspec

from smash.experiments.sweeps.experiment import RunKind
from smash.problem.plan import Status
from smash.records.outcomes import OutcomeName


class VerdictField(msgspec.Struct):
    """The law's verdict; `step` is 1-based, None where the plan as a whole is refused."""

    accepted: bool
    reason: str
    step: int | None


class CommitField(msgspec.Struct):
    """The commit of the code, and whether tracked files were changed; None outside a repository."""

    hash: str | None
    dirty: bool | None


class MachineField(msgspec.Struct):
    """The machine of the process that recorded the run; memory in MiB."""

    processor: str
    cores: int | None
    usable_cores: int | None
    memory_mib: int
    system: str


class RunRecord(msgspec.Struct):
    """One line of `runs.jsonl`."""

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
    max_topple: int | None
    status: Status
    cost: int | None
    lower_bound: int | None
    bound_origin: str | None
    incumbents: list[tuple[float, int, str]]
    actions: list[list[str | int]] | None
    outcome: OutcomeName
    reason: str
    verdict: VerdictField | None
    budget: float
    budgets: list[float]
    memory_limit_mib: int
    warm_start: str | None
    horizon: int | None
    threads: int
    seed: int
    blocks: int
    stacks: int
    buffers: int
    instance_hash: str
    instance_document: dict[str, Any]
    wall_seconds: float | None
    cpu_seconds: float | None
    memory_mib: float | None
    details: dict[str, Any]
    log: str
    started: str
    load_average: tuple[float, float]
    versions: dict[str, str]
    commit: CommitField
    machine: MachineField
    without: list[str] = []


class EpisodeField(msgspec.Struct):
    """What a check asks of a `smash-episode/1` object; `smash.execution.episode` has all of it."""

    success: bool
    failure: dict[str, Any] | None
    actions_executed: int
    actions: list[dict[str, Any]]


class EpisodeRecord(msgspec.Struct):
    """One line of `episodes.jsonl`."""

    format: Literal["smash-episode-run/1"]
    key: str
    run: str
    instance: str
    suite: str
    label: str
    variant: str
    policy: str
    seed: int
    scene: str | None
    blocks: int
    depth: int | None
    cost: int
    status: Status
    budget: float
    first_plan_seconds: float | None
    best_plan_seconds: float | None
    episode: EpisodeField | None
    problem: str
    wall_seconds: float
    started: str
    load_average: tuple[float, float]
    commit: CommitField
    machine: MachineField
    versions: dict[str, str]
