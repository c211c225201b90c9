"""What a run costs beside its planner: processor time of the caller, the fork server and the guardian together."""

from __future__ import annotations

import resource
import statistics
from collections.abc import Iterator

from smash.experiments.isolation.caller import run_isolated
from smash.experiments.isolation.job import Job
from smash.experiments.isolation.starting import shared_server
from smash.planners.protocol import Settings
from smash.problem.problem import Problem
from smash.problem.sets.suites import read_suite

PLANNERS = ("greedy", "smash")
SUITE = "multi-4"
RUNS = 10
ROUNDS = 5


def overhead_rows() -> Iterator[str]:
    """Yield the table: medians over rounds of tiny runs, the start of the server (once in a process) apart."""
    yield "| planner | CPU a run [s] | of it the planner's own [s] | overhead [s] | start of the server [s] |"
    yield "|---|---|---|---|---|"
    for planner in PLANNERS:
        rounds = [_round(planner) for _ in range(ROUNDS)]
        whole, own, start = (statistics.median(column) for column in zip(*rounds, strict=True))
        beside = statistics.median(all_of_it - its for all_of_it, its, _ in rounds)
        yield f"| {planner} | {whole:.3f} | {own:.3f} | {beside:.3f} | {start:.3f} |"


def _round(planner: str) -> tuple[float, float, float]:
    """Return the processor time of a run, what of it is the planner's own, and that of starting the server [s]."""
    once, _ = _processor_time(planner, 1)
    many, own = _processor_time(planner, 1 + RUNS)
    each = (many - once) / RUNS
    return each, own, once - each


def _processor_time(planner: str, runs: int) -> tuple[float, float]:
    """Return the processor time of so many runs with a server of their own, and the planner's own in one [s]."""
    job = Job(planner, Problem(read_suite(SUITE)[0]), Settings(), 5.0)
    shared_server(Job.loaded_by).close()
    before = _spent()
    own = statistics.fmean(run_isolated(job).cpu_seconds or 0.0 for _ in range(runs))
    shared_server(Job.loaded_by).close()  # its own time, and that of its children, counts once it has been waited for
    return _spent() - before, own


def _spent() -> float:
    """Return the processor time of this process and of its children that have ended [s]."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)
