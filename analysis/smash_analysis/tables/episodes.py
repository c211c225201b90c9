"""Episodes as tidy tables: one row an episode, one row an action that was carried out."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import pandas as pd

from smash.records.episodes import Episode, EpisodeRecord
from smash_analysis.tables.actions import ACTION_COLUMNS, named

TIMES = ("offline", "offline_cpu", "online", "online_cpu", "execution")
EPISODE_TYPES = {
    **dict.fromkeys(
        ("key", "run", "suite", "instance", "label", "variant", "policy", "scene", "engine", "robot", "status"),
        "string",
    ),
    **dict.fromkeys(("seed", "blocks", "cost"), "int64"),
    "depth": "Int64",
    **dict.fromkeys(("budget", "first_plan_seconds", "best_plan_seconds"), "float64"),
    "success": "boolean",
    **dict.fromkeys(("failure", "failure_reason"), "string"),
    **dict.fromkeys(
        ("failure_step", "actions_executed", "replans", "retries", "disturbed", "touched", "aside"), "Int64"
    ),
    **{f"{name}_seconds": "float64" for name in (*TIMES, "task")},
    "problem": "string",
    "wall_seconds": "float64",
    "started": "datetime64[ms, UTC]",
    **dict.fromkeys(("load_before", "load_after"), "float64"),
    **dict.fromkeys(("commit_hash", "machine_processor", "versions"), "string"),
    "commit_dirty": "boolean",
}
"""Columns of `episodes`, and their types whatever the records hold."""
ACTION_TYPES = {
    "key": "string",
    "step": "int64",
    **ACTION_COLUMNS,
    **dict.fromkeys(("origin", "outcome", "reason"), "string"),
    "attempts": "Int64",
    **dict.fromkeys(("gap", "repaired"), "boolean"),
    **dict.fromkeys(("disturbed", "touched", "aside"), "string"),
    "begun_seconds": "float64",
    **{f"{name}_seconds": "float64" for name in TIMES},
}
"""Columns of `actions`, and their types."""


def episodes_table(records: Sequence[EpisodeRecord]) -> pd.DataFrame:
    """Return one row an episode: the record's plain fields, the episode's, what it failed of, its times [s].

    `disturbed` counts the blocks that were moved by an action they are no part of, once for each such action;
    `touched` those that the arm touched unmeant, `aside` those that lay on a block that was picked, and were set aside
    first. Where a process ended without an episode `success` is false, and `problem` says why.
    """
    return _typed([_episode_row(record) for record in records], EPISODE_TYPES)


def _episode_row(record: EpisodeRecord) -> dict[str, Any]:
    episode = record.episode
    failure, times = (None, None) if episode is None else (episode.failure, episode.times)
    before, after = record.load_average
    return {
        **{name: getattr(record, name, None) for name in EPISODE_TYPES},
        "success": episode is not None and episode.success,
        "failure": None if failure is None else failure.name,
        "failure_reason": None if failure is None else failure.reason,
        "failure_step": None if failure is None else failure.step,
        **{name: getattr(episode, name, None) for name in ("actions_executed", "replans", "retries")},
        **{name: _named(episode, name) for name in ("disturbed", "touched", "aside")},
        **{f"{name}_seconds": getattr(times, name, None) for name in (*TIMES, "task")},
        "load_before": before,
        "load_after": after,
        "started": pd.Timestamp(record.started),
        "commit_hash": record.commit.hash,
        "commit_dirty": record.commit.dirty,
        "machine_processor": record.machine.processor,
        "versions": json.dumps(record.versions),
    }


def _named(episode: Episode | None, what: str) -> int | None:
    """How many blocks its actions name as disturbed, touched or set aside."""
    return None if episode is None else sum(len(getattr(performed, what)) for performed in episode.actions)


def actions_table(records: Sequence[EpisodeRecord]) -> pd.DataFrame:
    """Return one row an action that an episode carried out, recovery moves included: what, how it went, its times [s].

    `smash_analysis.tables.actions` says what the columns of an action hold.
    """
    rows = [
        {
            **{name: getattr(performed, name, None) for name in ACTION_TYPES},
            "key": record.key,
            **named(performed.action),
            "disturbed": json.dumps(performed.disturbed),
            "touched": json.dumps(performed.touched),
            "aside": json.dumps(performed.aside),
            "begun_seconds": performed.begun,
            **{f"{name}_seconds": getattr(performed.times, name) for name in TIMES},
        }
        for record in records
        for performed in (record.episode.actions if record.episode is not None else [])
    ]
    return _typed(rows, ACTION_TYPES)


def _typed(rows: list[dict[str, Any]], types: dict[str, str]) -> pd.DataFrame:
    return pd.DataFrame(rows, columns=list(types)).astype(types)
