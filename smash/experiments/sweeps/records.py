"""Records: `runs.jsonl`, one `smash-run/1` object a line, on disk as each run ends; resumed after any kill."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from smash.experiments.environment import commit, load, machine, versions
from smash.experiments.isolation.job import Report
from smash.experiments.sweeps.experiment import Run, instance_hash
from smash.problem.errors import MalformedFile
from smash.problem.files.instances import instance_document
from smash.problem.files.plans import PLAN_FORMAT_2, plan_document, plan_from_document
from smash.problem.plan import Plan
from smash.records.json_lines import set_damaged_aside
from smash.records.locking import hold

RUN_FORMAT = "smash-run/1"
RUNS = "runs.jsonl"
DAMAGED = "runs.damaged"
PLAN_FIELDS = (
    *("instance", "planner", "topple", "max_topple", "status", "cost"),
    *("lower_bound", "bound_origin", "incumbents", "actions"),
)


def record_of(run: Run, report: Report, started: datetime, load_before: float) -> dict[str, Any]:
    """Return the `smash-run/1` object of a finished run: the plan's fields, and all that it took to make it."""
    job = run.job
    document = plan_document(report.plan(job))
    del document["format"]
    verdict = report.verdict
    return {
        "format": RUN_FORMAT,
        "key": run.key,
        "experiment": run.experiment,
        "label": run.label,
        "suite": run.suite,
        "variant": run.variant,
        "kind": run.kind,
        **document,
        "without": list(job.options.without),
        "outcome": report.outcome,
        "reason": report.reason,
        "verdict": None
        if verdict is None
        else {"accepted": verdict.accepted, "reason": verdict.reason, "step": verdict.step},
        "budget": job.budget,
        "budgets": list(run.budgets),
        "memory_limit_mib": job.memory,
        "warm_start": job.settings.warm_start,
        "horizon": job.settings.horizon,
        "threads": job.settings.threads,
        "seed": job.settings.seed,
        "blocks": len(job.instance.blocks),
        "stacks": len(job.instance.stacks),
        "buffers": len(job.instance.buffers),
        "instance_hash": instance_hash(job.instance),
        "instance_document": instance_document(job.instance),
        "wall_seconds": report.wall_seconds,
        "cpu_seconds": report.cpu_seconds,
        "memory_mib": report.memory_mib,
        "details": report.details,
        "log": report.log if report.outcome in ("crashed", "memory", "refused") else "",
        "started": started.astimezone(UTC).isoformat(timespec="milliseconds"),
        "load_average": [load_before, load()],
        "versions": versions(job.planner),
        "commit": commit(),
        "machine": machine(),
    }


def recorded_plan(record: dict[str, Any]) -> Plan:
    """Return the plan that a record holds.

    Raises:
        MalformedFile: where it is malformed.
    """
    fields = {name: record[name] for name in PLAN_FIELDS} | {"without": record.get("without", [])}
    return plan_from_document({"format": PLAN_FORMAT_2, **fields})


class Records:
    """The records of one directory, open for one writer; what an earlier sweep finished is kept.

    Raises:
        InUse: where another sweep has it open.
        MalformedFile: where the file is damaged elsewhere than in its last line, or cannot be written.
    """

    def __init__(self, directory: Path, name: str = RUNS, wanted: str = RUN_FORMAT) -> None:
        self.path = directory / name
        self.wanted = wanted
        self._lock = hold(directory)
        try:
            self.set_aside = set_damaged_aside(self.path, lambda line: _is_record(line, wanted))
            self._file = open(self.path, "ab")  # noqa: SIM115 - open until `__exit__`
        except OSError as error:
            raise MalformedFile(str(self.path), f"cannot be written: {error.strerror}") from None
        self.commits = {
            record["key"]: (record.get("commit") or {}).get("hash") for record in read_records(self.path, wanted)
        }
        self.finished = set(self.commits)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
        self._lock.close()

    def append(self, record: dict[str, Any]) -> None:
        """Write one record and have it on disk before this returns; nothing is written twice.

        Raises:
            MalformedFile: where it cannot be written (a full disk).
        """
        if record["key"] in self.finished:
            return
        try:
            self._file.write(json.dumps(record).encode() + b"\n")
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise MalformedFile(str(self.path), f"cannot be written: {error.strerror}") from None
        self.finished.add(record["key"])


def read_records(path: Path, wanted: str = RUN_FORMAT) -> Iterator[dict[str, Any]]:
    """Yield the records of a `runs.jsonl`, or of another file of objects that have a `key` and the format `wanted`.

    Raises:
        MalformedFile: where a line is no such object.
    """
    with open(path, "rb") as lines:
        for number, line in enumerate(lines, start=1):
            if not _is_record(line, wanted):
                raise MalformedFile(f"{path}:{number}", f"no {wanted} object; set the line aside and run again")
            yield json.loads(line)


def _is_record(line: bytes, wanted: str) -> bool:
    try:
        record = json.loads(line)
    except ValueError:
        return False
    return isinstance(record, dict) and record.get("format") == wanted and isinstance(record.get("key"), str)
