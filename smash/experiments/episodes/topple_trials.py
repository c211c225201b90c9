"""Trials of topples in processes of their own, a line each in `trials.jsonl`; a stopped map goes on where it ended."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from threading import Event

from smash.execution.scene.tabletop import Tabletop
from smash.execution.trials.topple_map import run_trial
from smash.experiments.isolation.lifetime import end_with_parent
from smash.problem.errors import SmashError
from smash.records.trials import Key, Trial, simulated
from smash.records.writing import Writer


def wanted_trials(tabletop: Tabletop, engine: str, highest_cut: int, most: int, seeds: range) -> list[Key]:
    """Return every trial that the scene allows: seeds first, so that a part is a fair sample; stacks in turn."""
    return [
        (simulated(tabletop.fingerprint, engine), seed % len(tabletop.stacks), height, falling, seed)
        for seed in seeds
        for height in range(1, highest_cut + 1)
        for falling in range(1, most + 1)
        if height - 1 + falling <= min(9, tabletop.highest)
    ]


def run_trials(
    tabletop: Tabletop,
    engine: str,
    keys: Sequence[Key],
    records: Writer[Trial],
    jobs: int,
    stop: Event,
    ended: Callable[[Trial], None],
) -> None:
    """Run what is not recorded yet, `jobs` at a time; where `stop` is set, leave what is under way.

    Args:
        tabletop: the scene.
        engine: what simulates them.
        keys: the trials that are wanted.
        records: where each is recorded as it ends.
        jobs: how many run at a time.
        stop: ends it early.
        ended: is told of each.

    Raises:
        SmashError: where a process of the simulator ended badly.
    """
    context = get_context("spawn")
    pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=end_with_parent, initargs=(os.getpid(),))
    left = [key for key in keys if key not in records.finished]
    try:
        waiting: set[Future[Trial]] = {pool.submit(run_trial, tabletop, *key[1:], engine) for key in left}
        while waiting and not stop.is_set():
            done, waiting = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for trial in (future.result() for future in done):
                records.append(trial)
                ended(trial)
    except BrokenProcessPool:
        raise SmashError(f"a trial's process ended badly; start again, {records.path} keeps the others") from None
    finally:
        processes = list((pool._processes or {}).values()) if stop.is_set() else []
        pool.shutdown(wait=not processes, cancel_futures=True)
        for process in processes:
            process.kill()
