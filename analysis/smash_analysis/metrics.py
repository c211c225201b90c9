"""Metrics of others: functions from a run's record to a number, by the `smash.metrics` entry-point group.

Every metric becomes a column `metric.NAME` of the table of runs, so that comparison, report and export have it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import pandas as pd

from smash.problem.entry_points import entry_points_of
from smash.records.runs import RunRecord

GROUP = "smash.metrics"
PREFIX = "metric."
"""Before the name of a metric in a table's columns: no field of a record is called so."""
Metric = Callable[[dict[str, Any]], float | None]
"""A function from a `smash-run/1` object, as plain JSON data (`record["actions"]`), to a number, or None where it has
none; its docstring says what it is."""


@cache
def metrics() -> dict[str, Metric]:
    """Return the registered metrics by name; one that cannot be loaded is named on stderr and left out."""
    found: dict[str, Metric] = {}
    for entry in sorted(entry_points_of(GROUP), key=lambda entry: entry.name):
        try:
            found[entry.name] = entry.load()
        except Exception as error:
            print(f"analysis: metric {entry.name!r} cannot be loaded: {error}", file=sys.stderr)
    return found


def metric_columns(records: Sequence[RunRecord]) -> dict[str, list[float]]:
    """Return the values of every metric, one a record; NaN where it has none.

    A run on which a metric fails has none; the first failure of each is named on stderr.
    """
    return {PREFIX + name: _values(name, metric, records) for name, metric in metrics().items()}


def _values(name: str, metric: Metric, records: Sequence[RunRecord]) -> list[float]:
    values = []
    failures: list[str] = []
    for record in records:
        try:
            value = metric(record.document)
            values.append(float("nan") if value is None else float(value))
        except Exception as error:
            failures.append(f"{type(error).__name__}: {error}")
            values.append(float("nan"))
    if failures:
        print(f"analysis: metric {name!r} fails on {len(failures)} runs: {failures[0]}", file=sys.stderr)
    return values


def metric_names(table: pd.DataFrame) -> list[str]:
    """Return the names of the metrics that are columns of a table of runs."""
    return [str(column).removeprefix(PREFIX) for column in table.columns if str(column).startswith(PREFIX)]
