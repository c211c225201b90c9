"""The command line of the modules that make tables and figures."""

import subprocess
import sys

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


def test_no_records_are_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["it", str(tmp_path)])
    with pytest.raises(SystemExit) as ended:
        command.run("it", None, without_records)
    assert ended.value.code == 2
    assert capsys.readouterr().err.endswith(": no finished run\n")


def test_without_the_extra_a_module_is_one_line():
    blocked = "import sys; sys.modules['pandas'] = None; sys.argv = ['-m']; import smash_analysis"
    ended = subprocess.run([sys.executable, "-c", blocked], capture_output=True, text=True, timeout=60)
    assert ended.returncode == 6
    assert ended.stderr == "smash: python -m smash_analysis needs pandas: pip install 'smash-testbed[analysis]'\n"
