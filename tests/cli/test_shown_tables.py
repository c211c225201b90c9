"""What commands print and take alike: tables that break by columns and not by words, one `--budget`."""

import pandas as pd
import pytest

from smash.cli import COMMANDS
from smash.cli import smash as command
from smash.cli.shown_tables import show
from smash.problem.words import counted

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
