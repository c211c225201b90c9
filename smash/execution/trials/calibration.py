"""An outcome model held against trials that it was not made from: does it say what will happen, and how surely?

A new landing lies between the least and the greatest of n earlier ones with probability (n - 1) / (n + 1), whatever the
distribution: the share that does is what a calibrated model shows, and needs no curve through the points.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import hypot, nan

import numpy as np

from smash.forecast.model import OutcomeModel, Toppled
from smash.motion.poses import Vector
from smash.problem.errors import SmashError
from smash.records.trials import Trial


@dataclass(frozen=True, slots=True)
class Calibration:
    """A model beside new trials of some size.

    Attributes:
        size: blocks that fell; None for all sizes.
        trials: new ones.
        blocks: that fell in them.
        away: median distance of a landing from the model's mean [m].
        within: share of landings that lie within the model's range along the push.
        within_expected: the share that a calibrated model shows.
        graspable: share of blocks that could be grasped at once.
        graspable_expected: what the model says.
        brier: mean squared error of that probability, for each block.
        stands: share of trials in which a push was found and the rest stood as it should.
        stands_expected: what the model says.
        seconds_off: median relative error of a topple's time.

    What no block has landed for is not a number.
    """

    size: int | None
    trials: int
    blocks: int
    away: float
    within: float
    within_expected: float
    graspable: float
    graspable_expected: float
    brier: float
    stands: float
    stands_expected: float
    seconds_off: float


def require_comparable(model: OutcomeModel, layout: str, engine: str, seeds: range) -> None:
    """Refuse a model that trials to come say nothing about, before any is done.

    Args:
        model: Of a scene.
        layout: The fingerprint of the trials' scene.
        engine: What simulates them.
        seeds: Of the trials.

    Raises:
        SmashError: where the model is of another scene or engine, has no topples, or was made from these seeds.
    """
    common = {trial.seed for trial in model.topples}.intersection(seeds)
    if not any(trial.landed for trial in model.topples):
        raise SmashError("no block has landed in its topples: there is nothing to hold against trials")
    if model.layout != layout:
        raise SmashError(f"it is of scene {model.scene!r} ({model.layout}), the trials are of another one ({layout})")
    if model.engine != engine:
        raise SmashError(f"it is of the engine {model.engine}, the trials are of {engine}: --engine {model.engine}")
    if common:
        after = max(trial.seed for trial in model.topples) + 1
        raise SmashError(f"it was made from trials with seed {min(common)}, too: --first-seed {after} takes others")


def calibrations(model: OutcomeModel, trials: Iterable[Trial]) -> list[Calibration]:
    """Hold a model against new trials, by size and as a whole; those with landings and without a time are left out.

    Args:
        model: Of the scene.
        trials: Others than it was made from.
    """
    new = [trial for trial in trials if trial.seconds is not None or not trial.landings]
    sizes = sorted({trial.falling for trial in new})
    parts = [(size, [trial for trial in new if trial.falling == size]) for size in sizes]
    return [_calibration(model, part, size) for size, part in [*parts, *([(None, new)] if len(parts) > 1 else [])]]


def _calibration(model: OutcomeModel, trials: Sequence[Trial], size: int | None) -> Calibration:
    blocks, whole, times = [], [], []
    for trial in trials:
        tried = model.trials(trial.height, trial.falling)
        known = [earlier for earlier in tried if earlier.landed]
        if tried:
            whole.append((trial.stands, sum(earlier.stands for earlier in tried) / len(tried)))
        if known and trial.landings:
            blocks += [_block(known, trial, level) for level in range(len(trial.landings))]
            times.append(_off(known, trial))
    away, within, range_, good, good_expected = np.array(blocks, dtype=float).reshape(-1, 5).T
    stands, stands_expected = np.array(whole, dtype=float).reshape(-1, 2).T
    return Calibration(
        size,
        len(trials),
        len(blocks),
        _middle(away),
        _mean(within),
        _mean(range_),
        _mean(good),
        _mean(good_expected),
        _mean((good - good_expected) ** 2),
        _mean(stands),
        _mean(stands_expected),
        _middle(times),
    )


def _mean(values: Vector) -> float:
    return float(values.mean()) if values.size else nan


def _middle(values: Vector | Sequence[float]) -> float:
    return float(np.median(values)) if len(values) else nan


def _block(known: Sequence[Toppled], trial: Trial, level: int) -> tuple[float, ...]:
    """How far from the mean, whether within the range, how probably that, whether graspable, how probably that."""
    seen = [earlier.landed[min(level, len(earlier.landed) - 1)] for earlier in known]
    new = trial.landings[level]
    along, aside = [block.along for block in seen], [block.aside for block in seen]
    count = len(seen)
    return (
        hypot(new.along - sum(along) / count, new.aside - sum(aside) / count),
        min(along) <= new.along <= max(along),
        (count - 1) / (count + 1),
        new.graspable,
        sum(block.graspable for block in seen) / count,
    )


def _off(known: Sequence[Toppled], trial: Trial) -> float:
    """How far off the time was, as a share of it."""
    assert trial.seconds is not None
    return abs(sum(earlier.seconds for earlier in known) / len(known) / trial.seconds - 1.0)


def table(rows: Iterable[Calibration]) -> str:
    """The rows as Markdown; in each cell what was seen, and what the model says after it."""
    lines = [
        "| falling | trials | blocks | off by [cm] | within the range | graspable | Brier | rest stands | time off |",
        "|---|---:|---:|---:|---:|---:|---:|---:|---:|",
    ]
    lines += [
        f"| {row.size or 'all'} | {row.trials} | {row.blocks} | {100 * row.away:.1f} "
        f"| {row.within:.2f} ({row.within_expected:.2f}) | {row.graspable:.3f} ({row.graspable_expected:.3f}) "
        f"| {row.brier:.3f} | {row.stands:.2f} ({row.stands_expected:.2f}) | {100 * row.seconds_off:.1f} % |"
        for row in rows
    ]
    return "\n".join(lines)
