"""Trials of topples in processes of their own, a line each in `trials.jsonl`; a stopped map goes on where it ended."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path
from threading import Event

import msgspec

from smash.execution.scene.tabletop import Tabletop
from smash.execution.trials.topple_map import Key, Trial, run_trial
from smash.experiments.isolation.lifetime import end_with_parent
from smash.problem.errors import MalformedFile, SmashError
from smash.records.json_lines import set_damaged_aside


def wanted_trials(tabletop: Tabletop, highest_cut: int, most: int, seeds: int) -> list[Key]:
    """Return every trial that the scene allows: seeds first, so that a part is a fair sample; stacks in turn."""
    return [
        (tabletop.fingerprint, seed % len(tabletop.stacks), height, falling, seed)
        for seed in range(seeds)
        for height in range(1, highest_cut + 1)
        for falling in range(1, most + 1)
        if height - 1 + falling <= min(9, tabletop.highest)
    ]


def read_trials(path: Path) -> tuple[dict[Key, Trial], bool]:
    """Return the trials of a file, and whether a damaged last line was set aside.

    Raises:
        MalformedFile: where another line is damaged.
    """
    damaged = set_damaged_aside(path, _is_trial)
    lines = path.read_bytes().splitlines() if path.exists() else []
    try:
        found = [msgspec.json.decode(line, type=Trial) for line in lines]
    except msgspec.MsgspecError as error:
        raise MalformedFile(str(path), f"holds a line that is no trial: {error}") from None
    return {trial.key: trial for trial in found}, damaged


def run_trials(
    tabletop: Tabletop, keys: Sequence[Key], path: Path, jobs: int, stop: Event, ended: Callable[[Trial], None]
) -> None:
    """Run trials, `jobs` at a time, and append each to `path`; where `stop` is set, leave what is under way.

    Raises:
        SmashError: where a process of the simulator ended badly.
    """
    context = get_context("spawn")
    pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=end_with_parent, initargs=(os.getpid(),))
    with path.open("ab") as file:
        try:
            waiting: set[Future[Trial]] = {pool.submit(run_trial, tabletop, *key[1:]) for key in keys}
            while waiting and not stop.is_set():
                done, waiting = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
                for trial in (future.result() for future in done):
                    file.write(msgspec.json.encode(trial) + b"\n")
                    file.flush()
                    ended(trial)
        except BrokenProcessPool:
            raise SmashError(f"a trial's process ended badly; start again, {path} keeps the others") from None
        finally:
            processes = list((pool._processes or {}).values()) if stop.is_set() else []
            pool.shutdown(wait=not processes, cancel_futures=True)
            for process in processes:
                process.kill()


def _is_trial(line: bytes) -> bool:
    try:
        msgspec.json.decode(line, type=Trial)
    except msgspec.MsgspecError:
        return False
    return True
