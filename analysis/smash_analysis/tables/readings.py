"""What each run says about each budget: one anytime run stands for every budget up to its own.

A run counts as solved at budget b where it had an incumbent, accepted by the law, by b seconds; its cost
there is that of the best one by then.
"""

from __future__ import annotations

from typing import Any

import pandas as pd

from smash.records.runs import RunRecord

SETTING = ["label", "suite", "buffers", "variant", "instance", "seed"]
"""What names one problem put to one planner."""


def readings(records: list[RunRecord]) -> pd.DataFrame:
    """Return one row per run and budget that it stands for: `SETTING`, budget, solved, cost (NaN), seconds, run.

    `run` is the record's place in `records`.
    """
    rows = [
        _reading(record, budget, run)
        for run, record in enumerate(records)
        if record.kind != "cutoff"
        for budget in record.budgets
    ]
    return _table(rows)


def cutoff_check(records: list[RunRecord]) -> pd.DataFrame:
    """Return the runs that were really cut off, beside what the anytime run says about that budget.

    Columns: `SETTING`, budget, and solved, cost as read and as cut off (`_read`, `_cut`).
    """
    rows = [_reading(r, r.budget, run) for run, r in enumerate(records) if r.kind == "cutoff"]
    return readings(records).merge(_table(rows), on=[*SETTING, "budget"], suffixes=("_read", "_cut"))


def _reading(record: RunRecord, budget: float, run: int) -> dict[str, Any]:
    within = [(seconds, cost) for seconds, cost in record.trace if seconds <= budget]
    setting = {name: getattr(record, name) for name in SETTING}
    seconds, cost = within[-1] if within else (float("nan"), float("nan"))
    reading = {"budget": float(budget), "solved": bool(within), "cost": float(cost), "seconds": seconds, "run": run}
    return setting | reading


def _table(rows: list[dict[str, Any]]) -> pd.DataFrame:
    return pd.DataFrame(rows, columns=[*SETTING, "budget", "solved", "cost", "seconds", "run"])
