"""What commands print and take alike: tables that break by columns and not by words, one `--budget`."""

import pandas as pd
import pytest
from click.testing import CliRunner

from smash.cli import COMMANDS
from smash.cli import smash as command
from smash.cli.shown_tables import show
from smash.planners.registry import planner_names
from smash.problem.words import counted
from tests.analysis.made_up import record, write

WIDE = pd.DataFrame(
    {"planner": ["fd-lama:conditional"], **{f"column {n}": [f"{n}00.00 ± 1.00 (n=8)"] for n in range(6)}}
)


@pytest.mark.parametrize("width", [60, 80, 400])
def test_a_wide_table_goes_on_below_and_no_cell_is_cut(width, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", str(width))
    show(WIDE, "a title")
    said = capsys.readouterr().out
    assert all(len(line) <= width for line in said.splitlines())
    assert all(f"{n}00.00 ± 1.00 (n=8)" in said for n in range(6))
    assert said.count("fd-lama:conditional") == {60: 6, 80: 3, 400: 1}[width]


@pytest.mark.parametrize("words", [["planners"], ["records", "check"], ["frontier", "single-4"]])
def test_no_line_is_wider_than_the_terminal(words, tmp_path, monkeypatch):
    write(tmp_path, [record(0)])
    more = {"planners": [], "records": [str(tmp_path)], "frontier": ["--instances", "2", "--most", "1"]}[words[0]]
    monkeypatch.setenv("COLUMNS", "80")
    lines = CliRunner().invoke(command, [*words, *more]).stdout.splitlines()
    assert 0 < max(map(len, lines)) <= 80


def test_a_planner_is_a_line_where_there_is_no_terminal(monkeypatch):
    monkeypatch.delenv("COLUMNS", raising=False)
    said = CliRunner().invoke(command, ["planners"]).stdout
    assert len(said.splitlines()) == len(planner_names())


def test_budget_is_the_same_in_every_command():
    found = {}
    for name in COMMANDS:
        for option in command.get_command(None, name).params:
            if option.name == "budget":
                found[name] = (option.default, option.type.name, option.metavar, option.help.startswith("Wall time "))
    assert {"plan", "compare", "execute", "scaling", "frontier", "certify", "dataset"} <= set(found)
    assert set(found.values()) == {(30.0, "float range", "SECONDS", True)}


def test_one_is_singular():
    assert [counted(n, "instance") for n in (0, 1, 1000)] == ["0 instances", "1 instance", "1,000 instances"]
