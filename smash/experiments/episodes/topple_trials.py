"""Trials of topples in processes of their own, a line each in `trials.jsonl`; a stopped map goes on where it ended."""

from __future__ import annotations

from threading import Event

import msgspec

from smash.execution.scene.tabletop import Tabletop
from smash.experiments.episodes.question import TrialRun
from smash.experiments.episodes.simulation import Simulation
from smash.experiments.isolation.hearing import done
from smash.problem.errors import SmashError
from smash.problem.files.typed import typed
from smash.records.trials import Trial, simulated

HIGHEST = 9
"""Blocks of the highest pile that is tried."""


def wanted_trials(tabletop: Tabletop, engine: str, highest_cut: int, most: int, seeds: range) -> list[TrialRun]:
    """Return every trial that the scene allows: seeds first, so that a part is a fair sample; stacks in turn.

    Raises:
        SmashError: where the scene has no strip to topple into, or no pile that is toppled fits its slot.
    """
    stacks = [number for number, slot in enumerate(tabletop.stacks) if slot.directions]
    if not stacks:
        raise SmashError(f"scene {tabletop.name!r} has no landing strip: nothing is toppled there")
    rooms = {number: min(HIGHEST, tabletop.room(tabletop.stacks[number])) for number in stacks}
    document, layout = msgspec.to_builtins(tabletop), simulated(tabletop.fingerprint, engine)
    wanted = [
        TrialRun((layout, stack, height, falling, seed), document, engine)
        for seed, stack in ((seed, stacks[seed % len(stacks)]) for seed in seeds)
        for height in range(1, highest_cut + 1)
        for falling in range(1, most + 1)
        if height - 1 + falling <= rooms[stack]
    ]
    if not wanted:
        raise SmashError(f"scene {tabletop.name!r} has no room for a pile where one is toppled")
    return wanted


def run_apart(run: TrialRun, stop: Event | None = None) -> Trial | None:
    """Do one trial in processes of its own; None where `stop` was set before it ended.

    Raises:
        SmashError: where those processes ended badly.
    """
    if stop is not None and stop.is_set():
        return None
    ended = done(Simulation(run), stop)
    if ended.interrupted:
        return None
    if ended.answer is None:
        _, stack, height, falling, seed = run.key
        which = f"cut {height}, {falling} falling, stack {stack}, seed {seed}"
        raise SmashError(f"a trial's process ended badly ({which}): {ended.reason}; start again, the others are kept")
    return typed(ended.answer, Trial)
