"""A sweep: the runs of an experiment on a pool, each recorded as it ends.

The pool is any `concurrent.futures` executor: threads here (every run has processes of its own), or that of a
Dask client. Nothing but this process writes records, so a run that a dead worker's successor repeats is
recorded once.
"""

from __future__ import annotations

import queue
from collections.abc import Callable, Hashable, Iterable
from concurrent.futures import Executor, Future
from datetime import UTC, datetime
from functools import partial
from threading import Event
from typing import Protocol, TypeVar

from smash.experiments.environment import commit, load, machine, versions
from smash.experiments.isolation.job import Job, Report
from smash.experiments.sweeps.experiment import Run
from smash.experiments.weighing.weighed import run_job
from smash.problem.errors import Interrupted, SmashError, Unsupported
from smash.problem.files.instances import instance_document
from smash.problem.plan import Plan
from smash.problem.words import counted
from smash.records.files import R
from smash.records.record import Record
from smash.records.runs import RUN_FORMAT, RunRecord, VerdictField, instance_hash, plan_fields
from smash.records.writing import Writer


class Wanted(Protocol):
    """What a sweep does: it has the key of the record that it becomes."""

    @property
    def key(self) -> Hashable:
        """The key."""


W = TypeVar("W", bound=Wanted)
_Wanted = TypeVar("_Wanted", bound=Wanted, contravariant=True)
_Made = TypeVar("_Made", bound=Record, contravariant=True)


class WorkersLost(SmashError):
    """Some runs were lost with their workers, more than once; they are not recorded."""

    exit_code = 7


class Display(Protocol[_Wanted, _Made]):
    """Whoever shows how a sweep goes."""

    def ended(self, run: _Wanted, record: _Made, /) -> None:
        """A run has ended and is recorded."""


class RunDisplay(Display[Run, RunRecord], Protocol):
    """Whoever is told, too, when a run starts."""

    def begun(self, run: Run) -> None:
        """A run has started."""


def record_of(run: Run, report: Report, started: datetime, load_before: float) -> RunRecord:
    """Return the record of a finished run: the plan, and all that it took to make it."""
    job, verdict = run.job, report.verdict
    return RunRecord(
        format=RUN_FORMAT,
        key=run.key,
        experiment=run.experiment,
        label=run.label,
        suite=run.suite,
        variant=run.variant,
        kind=run.kind,
        **plan_fields(report.plan),
        outcome=report.outcome,
        reason=report.reason,
        verdict=None if verdict is None else VerdictField(verdict.accepted, verdict.reason, verdict.step),
        budget=job.budget,
        budgets=list(run.budgets),
        memory_limit_mib=job.memory,
        warm_start=job.settings.warm_start,
        horizon=job.settings.horizon,
        threads=job.settings.threads,
        seed=job.settings.seed,
        solver=job.settings.solver,
        blocks=len(job.instance.blocks),
        stacks=len(job.instance.stacks),
        buffers=len(job.instance.buffers),
        instance_hash=instance_hash(job.instance),
        instance_document=instance_document(job.instance),
        wall_seconds=report.wall_seconds,
        cpu_seconds=report.cpu_seconds,
        memory_mib=report.memory_mib,
        details=dict(report.plan.details),
        log=report.log if job.settings.command or report.outcome in ("crashed", "memory", "refused") else "",
        started=started.astimezone(UTC).isoformat(timespec="milliseconds"),
        load_average=(load_before, load()),
        versions=versions(job.planner),
        commit=commit(),
        machine=machine(),
        command=job.settings.command,
        objective=job.settings.objective,
        robust=job.settings.robust,
        expected_seconds=report.plan.expected_seconds,
    )


def weighed_or_not(job: Job, stop: Event | None) -> Report:
    """Run a job; where it asks for seconds or risk, and nothing is known of its scene, say `unsupported`."""
    try:
        return run_job(job, stop=stop)
    except Unsupported as error:
        empty = Plan(job.instance.name, job.planner, job.options, "unknown", None)
        return Report("unsupported", empty, reason=str(error))


def execute(run: Run, stop: Event | None = None, begun: Callable[[Run], None] | None = None) -> RunRecord | None:
    """Do one run and return its record; None where `stop` was set before it ended."""
    if stop is not None and stop.is_set():
        return None
    if begun is not None:
        begun(run)
    started, load_before = datetime.now(UTC), load()
    report = weighed_or_not(run.job, stop)
    return None if report.outcome == "interrupted" else record_of(run, report, started, load_before)


def local_task(stop: Event, display: RunDisplay) -> Callable[[Run], RunRecord | None]:
    """Return the task for a pool in this process: it can be stopped, and tells the display when it begins."""
    return partial(execute, stop=stop, begun=display.begun)


def sweep(
    runs: Iterable[W],
    records: Writer[R],
    executor: Executor,
    task: Callable[[W], R | None],
    display: Display[W, R],
    stop: Event,
) -> None:
    """Do all runs that are not recorded yet.

    Args:
        runs: what is wanted: runs of planners, episodes, trials.
        records: where each is recorded as it ends.
        executor: the pool.
        task: does one; None where it was stopped before its end.
        display: is told of each.
        stop: ends the sweep early.

    Raises:
        Interrupted: where `stop` was set before the last run had ended.
        WorkersLost: where the executor gave runs up.
    """
    ended: queue.SimpleQueue[Future[R | None]] = queue.SimpleQueue()
    waiting: dict[Future[R | None], W] = {}
    try:
        for run in runs:
            if run.key not in records.finished:
                future = executor.submit(task, run)
                waiting[future] = run
                future.add_done_callback(ended.put)
        lost = _collect(waiting, ended, records, display, stop)
    except BaseException:
        stop.set()
        _cancel(waiting)
        raise
    if stop.is_set():
        raise Interrupted("interrupted; every finished run is recorded, start again to do the rest")
    if lost:
        raise WorkersLost(f"lost {counted(len(lost), 'run')} ({lost[0]}); start again to do what is left")


def _collect(
    waiting: dict[Future[R | None], W],
    ended: queue.SimpleQueue[Future[R | None]],
    records: Writer[R],
    display: Display[W, R],
    stop: Event,
) -> list[BaseException]:
    """Record each run as it ends; return the errors of those that the executor gave up."""
    lost: list[BaseException] = []
    while waiting:
        if stop.is_set():
            _cancel(waiting)
        try:
            future = ended.get(timeout=0.5)
        except queue.Empty:
            continue
        run = waiting.pop(future)
        if future.cancelled():
            if not stop.is_set():  # the scheduler is gone, and what it had with it
                lost.append(ConnectionError("the scheduler is gone"))
            continue
        error = future.exception()
        if isinstance(error, SmashError):
            raise error
        if error is not None:
            lost.append(error)
        elif (record := future.result()) is not None:
            records.append(record)
            display.ended(run, record)
    return lost


def _cancel(waiting: Iterable[Future[R | None]]) -> None:
    for future in list(waiting):
        future.cancel()
