"""Tidy tables from records, as Parquet and CSV (`docs/records.md`).

One row a run, one an incumbent, one a step of a plan; where plans were carried out, one an episode, one an action.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from smash.records.episodes import EpisodeRecord
from smash.records.files import EPISODES
from smash.records.runs import RunRecord
from smash_analysis.tables.believed import records_of, runs_of
from smash_analysis.tables.episodes import actions_table, episodes_table
from smash_analysis.tables.runs import incumbents_table, runs_table, steps_table
from smash_analysis.tables.writing import write_csv

EXPORT_VERSION = "smash-tables/1"
"""Written into the metadata of every Parquet file; columns may be added within a version."""
FLATTENED = {
    "verdict": ("accepted", "reason", "step"),
    "commit": ("hash", "dirty"),
    "machine": ("processor", "cores", "usable_cores", "memory_mib", "system"),
}
"""Small objects: each of their fields becomes the column `object_field`."""
AS_JSON = ("budgets", "instance_document", "details", "versions")
TYPES = {
    **dict.fromkeys(("max_topple", "cost", "lower_bound", "horizon", "verdict_step"), "Int64"),
    **dict.fromkeys(("machine_cores", "machine_usable_cores", "machine_memory_mib"), "Int64"),
    **dict.fromkeys(("verdict_accepted", "commit_dirty"), "boolean"),
    **dict.fromkeys(("wall_seconds", "cpu_seconds", "memory_mib", "load_before", "load_after"), "float64"),
    **dict.fromkeys(("bound_origin", "warm_start", "verdict_reason", "commit_hash"), "string"),
}
"""Types of the columns that may be empty, which would be guessed from what is there."""


def tidy_runs(records: list[RunRecord]) -> pd.DataFrame:
    """Return one row a run: plain fields as they are, small objects as `object_field` columns, the rest as JSON text.

    The columns are the same whatever the records hold.
    """
    table = runs_table(records).drop(columns="commit")
    table = pd.concat([table, pd.DataFrame(_flat(records), index=table.index)], axis="columns")
    table["started"] = pd.to_datetime(table["started"], utc=True, format="ISO8601", errors="coerce")
    further = {name: "string" for name in table.columns if name not in TYPES and _mixed(table[name])}
    return table.astype(TYPES | further)


def _mixed(column: pd.Series[Any]) -> bool:
    """Whether a column, of a field that this version does not know, holds texts beside other values."""
    return column.dtype == object and len({type(value) for value in column if value is not None}) > 1


def _flat(records: Sequence[RunRecord]) -> dict[str, list[Any]]:
    """Return the columns made of the nested fields."""
    columns: dict[str, list[Any]] = {}
    for name, parts in FLATTENED.items():
        inner = [getattr(record, name) for record in records]
        columns |= {f"{name}_{part}": [getattr(value, part, None) for value in inner] for part in parts}
    for place, name in enumerate(("load_before", "load_after")):
        columns[name] = [record.load_average[place] for record in records]
    texts: dict[int, str] = {}  # of parts that several records share
    for name in AS_JSON:
        values = [getattr(record, name) for record in records]
        columns[name] = [texts.get(id(value)) or texts.setdefault(id(value), json.dumps(value)) for value in values]
    return columns


def _tables(results: Path) -> Iterator[tuple[str, pd.DataFrame]]:
    """Yield every table with its name, one after the other: together they would take much memory.

    All records are read before the first.

    Raises:
        MalformedFile: as `export`.
    """
    records = runs_of(results)
    carried_out = _carried_out(results)
    yield "runs", tidy_runs(records)
    yield "incumbents", incumbents_table(records)
    yield "steps", steps_table(records)
    if carried_out:
        yield "episodes", episodes_table(carried_out)
        yield "actions", actions_table(carried_out)


def _carried_out(results: Path) -> list[EpisodeRecord]:
    """Return the episodes; none where nothing was carried out, or a first start was stopped before its first end."""
    file = EPISODES.path(results)
    return records_of(results, EPISODES) if file.is_file() and file.stat().st_size else []


def export(results: Path, out: Path) -> list[tuple[Path, int]]:
    """Write every table of the runs as they are believed as .parquet and .csv to `out`; return (file, rows) of each.

    Raises:
        MalformedFile: where there are no records to be read, or they are damaged.
        OSError: where a file cannot be written.
    """
    import pyarrow as pa
    from pyarrow import parquet

    files = []
    for name, table in _tables(results):
        out.mkdir(parents=True, exist_ok=True)
        arrow = pa.Table.from_pandas(table, preserve_index=False)
        metadata = {**(arrow.schema.metadata or {}), b"format": EXPORT_VERSION.encode()}
        parquet.write_table(arrow.replace_schema_metadata(metadata), out / f"{name}.parquet")
        write_csv(table, out / f"{name}.csv")
        files += [(out / f"{name}.{ending}", len(table)) for ending in ("parquet", "csv")]
    return files
