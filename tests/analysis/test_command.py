"""The command line of the modules that make tables and figures."""

import pytest
from smash_analysis import command

from smash.records.reading import NoRecords


def written(results, out):
    out.mkdir(exist_ok=True)
    (out / "table.md").write_text(f"made of {results.name}")
    return [out / "table.md"]


def without_records(results, out):
    raise NoRecords(str(results), "no finished run")


def test_files_go_below_the_results_unless_said_and_are_named(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["it", str(tmp_path)])
    command.run("it", "about it", written, "tables", shown="table.md")
    assert capsys.readouterr().out.splitlines() == [f"made of {tmp_path.name}", str(tmp_path / "tables" / "table.md")]
    monkeypatch.setattr("sys.argv", ["it", str(tmp_path), "--out", str(tmp_path / "elsewhere")])
    command.run("it", "about it", written, "tables")
    assert capsys.readouterr().out.splitlines() == [str(tmp_path / "elsewhere" / "table.md")]


def test_no_records_are_one_line(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.argv", ["it", str(tmp_path)])
    with pytest.raises(SystemExit, match=r"analysis: .*: no finished run"):
        command.run("it", None, without_records)
