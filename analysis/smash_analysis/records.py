"""Read the records of a sweep: `RESULTS/runs.jsonl`, one `smash-run/1` object a line."""

from __future__ import annotations

import json
from collections.abc import Collection
from pathlib import Path
from typing import Any

import pandas as pd

from smash_analysis.metrics import metric_columns
from smash_analysis.tables.actions import ACTION_COLUMNS, named

RUN_FORMAT = "smash-run/1"


class NoRecords(Exception):
    """A directory without usable records; the message is one line."""


def read_records(results: Path, keys: Collection[str] | None = None) -> list[dict[str, Any]]:
    """Return the records of a results directory, or those of some runs; a half-written last line is left out.

    Raises:
        NoRecords: where there are none, or a line before the last is damaged.
    """
    records = read_lines(results / "runs.jsonl", RUN_FORMAT)
    if keys is not None:
        records = [record for record in records if record["key"] in keys]
    if not records:
        raise NoRecords(f"{results / 'runs.jsonl'}: no finished run")
    return records


def read_lines(path: Path, wanted: str) -> list[dict[str, Any]]:
    """Return the objects of a file of JSON lines; a damaged last line (a kill's trace) is left out.

    Raises:
        NoRecords: where the file cannot be read, a line before the last is damaged, or an object has another format.
    """
    try:
        lines = path.read_bytes().splitlines()
    except OSError as error:
        raise NoRecords(f"{path}: cannot be read: {error.strerror}") from None
    records = []
    for number, line in enumerate(lines, start=1):
        try:
            record = json.loads(line)
            if record["format"] != wanted:
                raise NoRecords(f"{path}:{number}: format {record['format']!r}, not {wanted!r}")
        except (ValueError, TypeError, KeyError):
            if number == len(lines):
                break
            raise NoRecords(f"{path}:{number}: no {wanted} object") from None
        records.append(_encodable(record) if b"\\ud" in line.lower() else record)
    return records


def _encodable(value: Any) -> Any:
    """Return JSON data with names that are no Unicode text (a lone surrogate, which JSON allows) escaped."""
    match value:
        case str():
            return value.encode(errors="backslashreplace").decode()
        case list():
            return [_encodable(part) for part in value]
        case dict():
            return {_encodable(name): _encodable(part) for name, part in value.items()}
    return value


def runs_table(records: list[dict[str, Any]]) -> pd.DataFrame:
    """Return one row a run; nested fields (versions, machine, details, actions) stay in the records.

    Columns of the record, and: `first_seconds`, `best_seconds` (time of the first and of the best incumbent,
    NaN without a plan), `solved` (a plan that the law accepts), `proven` (its status is optimal), and `metric.NAME`
    for every registered metric.
    """
    plain = [{key: value for key, value in record.items() if not isinstance(value, (dict, list))} for record in records]
    table = pd.DataFrame(plain)
    traces = [legal_trace(record) for record in records]
    table["first_seconds"] = [trace[0][0] if trace else float("nan") for trace in traces]
    table["best_seconds"] = [trace[-1][0] if trace else float("nan") for trace in traces]
    table["solved"] = [bool(trace) for trace in traces]
    table["proven"] = table["solved"] & (table["status"] == "optimal")
    table["cost"] = [trace[-1][1] if trace else float("nan") for trace in traces]
    table["commit"] = [(record.get("commit") or {}).get("hash") for record in records]
    for name, values in metric_columns(records).items():
        table[name] = values
    return table


def legal_trace(record: dict[str, Any]) -> list[tuple[float, int]]:
    """Return (seconds, cost) of the incumbents that count; none where the law refused what the planner answered."""
    if record["outcome"] == "refused":
        return []
    return [(float(seconds), int(cost)) for seconds, cost, _ in record["incumbents"]]


def incumbents_table(records: list[dict[str, Any]]) -> pd.DataFrame:
    """Return one row an incumbent: run key, number (from 1), seconds, cost, origin."""
    rows = [
        (record["key"], number, float(seconds), int(cost), origin)
        for record in records
        for number, (seconds, cost, origin) in enumerate(record["incumbents"], start=1)
    ]
    types = {"key": "string", "number": "int64", "seconds": "float64", "cost": "int64", "origin": "string"}
    return pd.DataFrame(rows, columns=list(types)).astype(types)


def steps_table(records: list[dict[str, Any]]) -> pd.DataFrame:
    """Return one row an action of the best plan: run key, step (from 1), the columns of `tables.actions`."""
    rows = [
        {"key": record["key"], "step": step, **named(action)}
        for record in records
        for step, action in enumerate(record["actions"] or [], start=1)
    ]
    types = {"key": "string", "step": "int64", **ACTION_COLUMNS}
    return pd.DataFrame(rows, columns=list(types)).astype(types)
