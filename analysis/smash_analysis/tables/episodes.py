"""Episodes as tidy tables: one row an episode, one row an action that was carried out."""

from __future__ import annotations

import json
from typing import Any

import pandas as pd

from smash_analysis.tables.actions import ACTION_COLUMNS, named

EPISODES = "episodes.jsonl"
EPISODE_FORMAT = "smash-episode-run/1"
TIMES = ("offline", "offline_cpu", "online", "online_cpu", "execution")
EPISODE_TYPES = {
    **dict.fromkeys(("key", "run", "suite", "instance", "label", "variant", "policy", "scene", "status"), "string"),
    **dict.fromkeys(("seed", "blocks", "cost"), "int64"),
    "depth": "Int64",
    **dict.fromkeys(("budget", "first_plan_seconds", "best_plan_seconds"), "float64"),
    "success": "boolean",
    **dict.fromkeys(("failure", "failure_reason"), "string"),
    **dict.fromkeys(("failure_step", "actions_executed", "replans", "retries"), "Int64"),
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
    "begun_seconds": "float64",
    **{f"{name}_seconds": "float64" for name in TIMES},
}
"""Columns of `actions`, and their types."""


def episodes_table(records: list[dict[str, Any]]) -> pd.DataFrame:
    """Return one row an episode: the record's plain fields, the episode's, what it failed of, its times [s].

    Where a process ended without an episode `success` is false, and `problem` says why.
    """
    return _typed([_episode_row(record) for record in records], EPISODE_TYPES)


def _episode_row(record: dict[str, Any]) -> dict[str, Any]:
    episode = record["episode"] or {}
    failure, times = episode.get("failure") or {}, episode.get("times") or {}
    before, after = record["load_average"]
    return {
        **{name: record.get(name) for name in EPISODE_TYPES},
        "success": bool(episode.get("success", False)),
        "failure": failure.get("name"),
        "failure_reason": failure.get("reason"),
        "failure_step": failure.get("step"),
        **{name: episode.get(name) for name in ("actions_executed", "replans", "retries")},
        **{f"{name}_seconds": times.get(name) for name in (*TIMES, "task")},
        "load_before": before,
        "load_after": after,
        "started": pd.Timestamp(record["started"]),
        "commit_hash": record["commit"]["hash"],
        "commit_dirty": record["commit"]["dirty"],
        "machine_processor": record["machine"]["processor"],
        "versions": json.dumps(record["versions"]),
    }


def actions_table(records: list[dict[str, Any]]) -> pd.DataFrame:
    """Return one row an action that an episode carried out, recovery moves included: what, how it went, its times [s].

    `smash_analysis.tables.actions` says what the columns of an action hold.
    """
    rows = []
    for record in records:
        for performed in (record["episode"] or {}).get("actions", []):
            times = performed.get("times", {})
            rows.append(
                {
                    **{name: performed.get(name) for name in ACTION_TYPES},
                    "key": record["key"],
                    **named(performed["action"]),
                    "begun_seconds": performed.get("begun"),
                    **{f"{name}_seconds": times.get(name) for name in TIMES},
                }
            )
    return _typed(rows, ACTION_TYPES)


def _typed(rows: list[dict[str, Any]], types: dict[str, str]) -> pd.DataFrame:
    return pd.DataFrame(rows, columns=list(types)).astype(types)
