"""Runs as tidy tables: one row a run, one an incumbent, one an action of the best plan."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from smash.records.runs import RunRecord
from smash_analysis.metrics import metric_columns
from smash_analysis.tables.actions import ACTION_COLUMNS, named

NESTED = (
    *("incumbents", "actions", "verdict", "budgets", "instance_document", "details", "load_average", "versions"),
    *("commit", "machine", "without"),
)
"""Fields of a run that do not fit into a cell."""
MOST = 2**53
"""Largest number that every table holds exactly; of a field that is not known a larger one is shown as text."""


def runs_table(records: Sequence[RunRecord]) -> pd.DataFrame:
    """Return one row a run; nested fields (versions, machine, details, actions) stay in the records.

    Columns of the record, fields included that this version does not know, and: `first_seconds`, `best_seconds` (time
    of the first and of the best incumbent, NaN without a plan), `solved` (a plan that the law accepts), `proven` (its
    status is optimal), and `metric.NAME` for every registered metric.
    """
    table = pd.DataFrame(_plain(records))
    traces = [record.trace for record in records]
    table["first_seconds"] = [trace[0][0] if trace else float("nan") for trace in traces]
    table["best_seconds"] = [trace[-1][0] if trace else float("nan") for trace in traces]
    table["solved"] = [bool(trace) for trace in traces]
    table["proven"] = table["solved"] & (table["status"] == "optimal")
    table["cost"] = [trace[-1][1] if trace else float("nan") for trace in traces]
    table["commit"] = [record.commit.hash for record in records]
    for name, values in metric_columns(records).items():
        table[name] = values
    return table


def _plain(records: Sequence[RunRecord]) -> dict[str, list[Any]]:
    """Return the columns of the fields that fit into a cell; a field that a record does not have is NaN there."""
    names = [name for name in RunRecord.__struct_fields__ if name not in NESTED]
    columns: dict[str, list[Any]] = {name: [getattr(record, name) for record in records] for name in names}
    for row, record in enumerate(records):
        for name, value in record.further.items():
            if value is None or isinstance(value, str | int | float):
                large = type(value) is int and abs(value) > MOST
                column = columns.setdefault(name, [float("nan")] * len(records))
                column[row] = str(value) if large else value
    return columns


def incumbents_table(records: Sequence[RunRecord]) -> pd.DataFrame:
    """Return one row an incumbent: run key, number (from 1), seconds, cost, origin."""
    rows = [
        (record.key, number, float(seconds), int(cost), origin)
        for record in records
        for number, (seconds, cost, origin) in enumerate(record.incumbents, start=1)
    ]
    types = {"key": "string", "number": "int64", "seconds": "float64", "cost": "int64", "origin": "string"}
    return pd.DataFrame(rows, columns=list(types)).astype(types)


def steps_table(records: Sequence[RunRecord]) -> pd.DataFrame:
    """Return one row an action of the best plan: run key, step (from 1), the columns of `tables.actions`."""
    numbers: dict[tuple[str | int, ...], int] = {}  # of each different action
    different: list[dict[str, str | int | None]] = []
    which: list[int] = []
    for record in records:
        for action in record.actions or []:
            number = numbers.setdefault(tuple(action), len(different))
            if number == len(different):
                different.append(named(action))
            which.append(number)
    lengths = [len(record.actions or []) for record in records]
    keys = pd.Series([record.key for record in records], dtype="string")
    told = pd.DataFrame(different, columns=list(ACTION_COLUMNS)).astype(dict(ACTION_COLUMNS)).take(which)
    told.insert(0, "key", keys.repeat(lengths).set_axis(told.index))
    told.insert(1, "step", np.concatenate([np.arange(1, length + 1) for length in (*lengths, 0)]).astype("int64"))
    return told.reset_index(drop=True)
