"""Tidy tables from records, as Parquet and CSV (`docs/records.md`).

One row a run, one an incumbent, one a step of a plan; where plans were carried out, one an episode, one an action.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd

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
IN_OWN_TABLES = ("incumbents", "actions")
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
    texts: dict[int, str] = {}
    flat = pd.DataFrame([_flat(record, texts) for record in records])
    not_plain = (*FLATTENED, *AS_JSON, *IN_OWN_TABLES, "load_average")
    table = runs_table(records).drop(columns=list(not_plain), errors="ignore")
    table = pd.concat([table, flat.set_index(table.index)], axis="columns")
    table["started"] = pd.to_datetime(table["started"], utc=True, format="ISO8601", errors="coerce")
    further = {name: "string" for name in table.columns if name not in TYPES and _mixed(table[name])}
    return table.astype(TYPES | further)


def _mixed(column: pd.Series[Any]) -> bool:
    """Whether a column, of a field that this version does not know, holds texts beside other values."""
    kinds = {type(value) for value in column if value is not None}
    return column.dtype == object and len(kinds) > 1


def _flat(record: RunRecord, texts: dict[int, str]) -> dict[str, Any]:
    """Return the columns made of a record's nested fields; `texts` keeps those of parts that several records share."""
    columns: dict[str, Any] = {}
    for name, parts in FLATTENED.items():
        inner = getattr(record, name)
        columns |= {f"{name}_{part}": getattr(inner, part, None) for part in parts}
    before, after = record.load_average
    columns |= {"load_before": before, "load_after": after}
    for name in AS_JSON:
        value = getattr(record, name)
        columns[name] = texts.get(id(value)) or texts.setdefault(id(value), json.dumps(value))
    return columns


def export(results: Path, out: Path) -> list[tuple[Path, int]]:
    """Write every table of the runs as they are believed as .parquet and .csv to `out`; return (file, rows) of each.

    Raises:
        MalformedFile: where there are no records to be read, or they are damaged.
        OSError: where a file cannot be written.
    """
    import pyarrow as pa
    from pyarrow import parquet

    records = runs_of(results)
    tables = {"runs": tidy_runs(records), "incumbents": incumbents_table(records), "steps": steps_table(records)}
    if EPISODES.path(results).is_file():
        carried_out = records_of(results, EPISODES)
        tables |= {"episodes": episodes_table(carried_out), "actions": actions_table(carried_out)}
    out.mkdir(parents=True, exist_ok=True)
    files = []
    for name, table in tables.items():
        arrow = pa.Table.from_pandas(table, preserve_index=False)
        metadata = {**(arrow.schema.metadata or {}), b"format": EXPORT_VERSION.encode()}
        parquet.write_table(arrow.replace_schema_metadata(metadata), out / f"{name}.parquet")
        write_csv(table, out / f"{name}.csv")
        files += [(out / f"{name}.{ending}", len(table)) for ending in ("parquet", "csv")]
    return files
