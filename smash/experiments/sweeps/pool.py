"""Where a sweep's runs go: on threads here, each with processes of its own, or to a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass

from smash.experiments.sweeps.cluster import WORKERS_OWN_SECONDS, connected
from smash.experiments.sweeps.cluster_executor import ClusterExecutor
from smash.experiments.sweeps.standstill import watched


@dataclass(frozen=True, slots=True)
class Pool:
    """An executor.

    Attributes:
        executor: takes the runs.
        width: how many run at a time, as far as that is known now.
        here: whether they run in this process's threads, where they can be stopped and tell when they begin.
    """

    executor: Executor
    width: int
    here: bool


@contextmanager
def pool(jobs: int, dask: str | None, most: float, tell: Callable[[str], object]) -> Iterator[Pool]:
    """A pool here, or that of a Dask cluster, whose workers are watched as long as it lasts.

    Args:
        jobs: runs at a time, here.
        dask: address of a scheduler, or the file that it has written; None: here.
        most: seconds that a run can take at most.
        tell: is told in a line what the user should know.

    Raises:
        MissingExtra: where Dask is wanted and not installed.
        SmashError: where no scheduler answers.
    """
    if dask is None:
        with ThreadPoolExecutor(jobs) as threads:
            yield Pool(threads, jobs, here=True)
        return
    with connected(dask) as client:
        width = sum(client.nthreads().values())
        if not width:
            tell("no worker is there yet; the runs wait for the first")
        executor = ClusterExecutor(client, tell)
        with watched(client, most + WORKERS_OWN_SECONDS, tell, executor.give_up):
            yield Pool(executor, width, here=False)
