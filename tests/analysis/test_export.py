"""Tidy tables: the same rows as Parquet and as CSV, one a run, an incumbent, a step."""

import json
import sys
from pathlib import Path

import pandas as pd
import pytest
from click.testing import CliRunner
from pyarrow import parquet
from smash_analysis.tables.writing import write_csv

from smash.cli import smash
from smash.problem.errors import Unsupported
from tests.analysis.made_up import record, write

PLAN = [["topple", "s1", 9], ["pick", "a0", "table"], ["place", "a0", "s2"]]
"""Costs 4: the way from the table region to s2 costs 1."""


def export(tmp_path, *records):
    results = write(tmp_path / "results", records)
    return CliRunner().invoke(smash, ["records", "export", str(results), "--out", str(tmp_path / "out")])


@pytest.fixture
def tables(tmp_path):
    solved = record(0, [(0.1, 5), (0.2, 4)], actions=PLAN)
    ended = export(tmp_path, solved, record(1))
    assert ended.exit_code == 0, ended.output
    return tmp_path / "out"


@pytest.mark.parametrize(("name", "rows"), [("runs", 2), ("incumbents", 2), ("steps", 3)])
def test_parquet_and_csv_hold_the_same(tables, name, rows):
    first, second = pd.read_parquet(tables / f"{name}.parquet"), pd.read_csv(tables / f"{name}.csv")
    assert len(first) == len(second) == rows
    assert list(first.columns) == list(second.columns)
    assert parquet.read_schema(tables / f"{name}.parquet").metadata[b"format"] == b"smash-tables/1"


def test_a_start_of_episodes_that_ended_at_once_hinders_nothing(tmp_path):
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "episodes.jsonl").touch()
    ended = export(tmp_path, record(0, [(0.1, 4)], actions=PLAN))
    assert ended.exit_code == 0, ended.output
    assert not (tmp_path / "out" / "episodes.csv").exists()


def test_a_csv_file_is_what_pandas_writes_but_for_formulas(tmp_path):
    table = pd.DataFrame(
        {
            "text, quoted": ['say "a"', "b,c", "two\nlines", None, "plain"],
            "also": pd.Series(["x", None, "", "é", "y"], dtype="string"),
            "number": [1.5, float("nan"), 1e-7, -3.0, float("inf")],
            "whole": pd.Series([1, None, -3, 2**53, 0], dtype="Int64"),
            "truth": pd.Series([True, None, False, True, False], dtype="boolean"),
            "mixed": [True, 1, "1", None, 0.25],
            "when": pd.to_datetime(
                ["2026-01-02T03:04:05.5", None, None, "2025-01-01", None], utc=True, format="ISO8601"
            ),
        }
    )
    write_csv(table, tmp_path / "table.csv")
    table.to_csv(tmp_path / "pandas.csv", index=False)
    assert (tmp_path / "table.csv").read_text() == (tmp_path / "pandas.csv").read_text()


def test_a_carriage_return_is_quoted_and_a_formula_marked(tmp_path):
    write_csv(pd.DataFrame({"=head": ["a\rb", "=1+1", "-3", "+cmd"]}), tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(newline="") as stream:
        assert stream.read() == "'=head\n\"a\rb\"\n'=1+1\n-3\n'+cmd\n"


def test_a_run_is_one_flat_row(tables):
    runs = pd.read_parquet(tables / "runs.parquet")
    assert runs["cost"].tolist() == [4, pd.NA]
    assert runs["commit_hash"].tolist() == ["c", "c"]
    assert runs["machine_cores"].tolist() == [2, 2]
    assert runs["load_after"].tolist() == [0.2, 0.2]
    assert runs["started"].dt.year.tolist() == [2026, 2026]
    assert {"actions", "incumbents", "verdict", "machine"}.isdisjoint(runs.columns)


def test_a_step_names_block_location_and_height(tables):
    steps = pd.read_parquet(tables / "steps.parquet").astype(object)
    steps = steps.where(steps.notna(), None)
    assert steps[["action", "block", "location", "height"]].values.tolist() == [
        ["topple", None, "s1", 9],
        ["pick", "a0", "table", None],
        ["place", "a0", "s2", None],
    ]


def test_a_carry_and_a_lift_have_their_own_columns(tmp_path):
    plan = [["carry", "tray", "right"], ["lift", "s1", 2, "u1"], ["juggle", "s1", "s2", "s3", 4]]
    assert export(tmp_path, record(0, [(0.1, 3)], actions=plan)).exit_code == 0
    steps = pd.read_parquet(tmp_path / "out" / "steps.parquet").astype(object)
    steps = steps.where(steps.notna(), None)
    assert steps[["action", "block", "location", "height", "carrier", "target"]].values.tolist() == [
        ["carry", None, "right", None, "tray", None],
        ["lift", None, "s1", 2, None, "u1"],
        ["juggle", None, None, None, None, None],
    ]


def test_plans_and_episodes_of_the_whole_family_are_exported(tmp_path):
    results = Path(__file__).parents[2] / "results" / "scoop"
    ended = CliRunner().invoke(smash, ["records", "export", str(results), "--out", str(tmp_path)])
    assert ended.exit_code == 0, ended.output
    for name in ("steps", "actions"):
        table = pd.read_parquet(tmp_path / f"{name}.parquet")
        assert {"carry", "lift"} <= set(table["action"])
        assert set(table["carrier"].dropna()) == {"tray"}
        assert table.loc[table["action"] == "lift", "target"].notna().all()


def test_columns_and_their_types_do_not_hang_on_what_was_recorded(tables, tmp_path):
    export(tmp_path / "unsolved", record(1))
    for name in ("runs", "incumbents", "steps"):
        full, empty = (parquet.read_schema(at / f"{name}.parquet") for at in (tables, tmp_path / "unsolved" / "out"))
        assert full.equals(empty), name


def test_a_plain_field_of_a_later_version_is_a_column(tmp_path):
    later = record(0).document | {"robot": "another", "solved_by": {"name": "x"}}
    write(tmp_path, [])
    (tmp_path / "runs.jsonl").write_text(json.dumps(later) + "\n")
    ended = CliRunner().invoke(smash, ["records", "export", str(tmp_path), "--out", str(tmp_path / "out")])
    assert ended.exit_code == 0, ended.output
    runs = pd.read_csv(tmp_path / "out" / "runs.csv")
    assert runs["robot"].tolist() == ["another"]
    assert "solved_by" not in runs.columns


def test_any_json_string_is_a_name(tmp_path):
    assert export(tmp_path, record(0, instance='\ud800, "ü"\n', actions=PLAN, trace=[(0.1, 4)])).exit_code == 0
    assert pd.read_csv(tmp_path / "out" / "runs.csv")["instance"].tolist() == ['\\ud800, "ü"\\n']


def test_no_records_and_missing_packages_are_one_line(tmp_path, monkeypatch):
    ended = CliRunner().invoke(smash, ["records", "export", str(tmp_path), "--out", str(tmp_path / "out")])
    assert "runs.jsonl: cannot be read" in str(ended.exception)
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    ended = CliRunner().invoke(smash, ["records", "export", str(tmp_path), "--out", str(tmp_path / "out")])
    assert isinstance(ended.exception, Unsupported)
    assert "pip install 'smash-testbed[parquet]'" in str(ended.exception)
