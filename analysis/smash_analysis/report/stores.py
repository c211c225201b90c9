"""Stores: one row a run, an episode or a topple, as a reader sees it who asks what is behind a figure."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from smash.records.episodes import EpisodeRecord
from smash.records.runs import RunRecord
from smash.records.trials import Trial
from smash_analysis.report.blocks import Store

RUN_COLUMNS = [
    "instance", "planner", "variant", "B", "budget [s]", "cost", "bound", "status", "first plan [s]", "took [s]",
    "outcome", "reason",
]  # fmt: skip
EPISODE_COLUMNS = [
    "instance", "planner", "variant", "policy", "seed", "result", "actions", "execution [s]", "replans", "reason",
]  # fmt: skip
TRIAL_COLUMNS = ["stack", "cut at", "falling", "seed", "result", "graspable", "below moved [cm]", "reason"]


def run_store(records: Sequence[RunRecord]) -> Store:
    """Return a row a record, in their order."""
    return Store(RUN_COLUMNS, [_run(record) for record in records])


def _run(record: RunRecord) -> list[Any]:
    trace = record.trace
    seed = f" (seed {record.seed})" if record.seed else ""
    return [
        shown(record.instance) + seed,
        record.label,
        record.variant,
        record.buffers,
        f"{record.budget:g}" + (" (cut off)" if record.kind == "cutoff" else ""),
        trace[-1][1] if trace else "–",
        "–" if record.lower_bound is None else record.lower_bound,
        record.status,
        seconds(trace[0][0]) if trace else "–",
        seconds(record.wall_seconds),
        record.outcome,
        reason(record),
    ]


def reason(record: RunRecord) -> str:
    """Return why a run has no plan, or ended badly; empty where there is nothing to explain."""
    if record.reason:
        return record.reason
    if record.outcome in ("budget-spent", "over-budget") and not record.incumbents:
        return "no plan by the budget"
    return ""


def episode_store(records: Sequence[EpisodeRecord]) -> Store:
    """Return a row an episode, in their order."""
    return Store(EPISODE_COLUMNS, [_episode(record) for record in records])


def _episode(record: EpisodeRecord) -> list[Any]:
    episode = record.episode
    failure = None if episode is None else episode.failure
    bad = "crashed" if failure is None else failure.name
    result = "success" if episode is not None and episode.success else bad
    why = record.problem if failure is None else failure.reason
    if failure is not None and failure.action:
        why = f"{why} (step {failure.step}: {' '.join(map(str, failure.action))})"
    return [
        shown(record.instance),
        record.label,
        record.variant,
        record.policy,
        record.seed,
        result,
        f"{0 if episode is None else episode.actions_executed} of {record.cost}",
        seconds(None if episode is None else episode.times.execution),
        "–" if episode is None else episode.replans,
        why,
    ]


def trial_store(records: Sequence[Trial]) -> Store:
    """Return a row a topple, in their order."""
    return Store(TRIAL_COLUMNS, [_trial(record) for record in records])


def _trial(record: Trial) -> list[Any]:
    landings = record.landings
    graspable = sum(landing.graspable for landing in landings)
    result = "success" if record.success else "failure"
    why = record.problem
    if not why and not record.stands:
        why = "what should stand does not"
    elif not why and graspable < len(landings):
        why = f"{len(landings) - graspable} cannot be grasped from above"
    return [
        record.stack, record.height, record.falling, record.seed, result,
        f"{graspable}/{len(landings)}", f"{100 * record.moved:.1f}", why,
    ]  # fmt: skip


def shown(name: str) -> str:
    """Return a name as it can be seen: an empty one, or one of spaces, in quotes."""
    return name if name.strip() == name and name else json.dumps(name, ensure_ascii=False)


def seconds(value: float | None) -> str:
    """Return seconds with three figures, or a dash."""
    if value is None:
        return "–"
    return f"{value:.1e}" if 0 < value < 0.0001 else f"{value:.3g}"
