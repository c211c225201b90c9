"""The command's doors: one line and an exit code for what a careless user types."""

import json
import subprocess
import sys

import pytest
from click.testing import CliRunner

from smash.cli import COMMANDS, main
from smash.cli import smash as command_group
from smash.cli.choices import PACE
from smash.execution.scene.tabletop import SLOWEST


def smash(*arguments, cwd=None):
    """Run the command as a user does."""
    return subprocess.run(
        [sys.executable, "-m", "smash", *map(str, arguments)], capture_output=True, text=True, cwd=cwd, timeout=110
    )


@pytest.mark.parametrize(
    "arguments",
    [
        ["plan"],
        ["plan", "missing.json"],
        ["plan", "."],
        ["plan", "x", "--budget", "-1"],
        ["plan", "x", "--budget", "soon"],
        ["plan", "x", "--max-topple", "0"],
        ["validate", "missing.json", "missing.json"],
        ["generate", "multi", "--blocks", "2", "--out", "y"],
        ["generate", "circle", "--blocks", "5", "--out", "y"],
        ["generate", "multi", "--blocks", "5", "--out", "/proc/no/such"],
        ["generate", "multi", "--blocks", "1000000000", "--out", "y"],
        ["import-blocks", "x", "--stacks", "1000000000", "--out", "y"],
        ["frobnicate"],
    ],
)
def test_bad_input_gets_one_line_and_exit_code_2(arguments, tmp_path):
    ended = smash(*arguments, cwd=tmp_path)
    assert ended.returncode == 2
    assert ended.stderr.startswith("smash: ")
    assert ended.stderr.count("\n") == 1


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_a_stream_that_the_caller_has_closed_is_no_defect(tmp_path, closed):
    (tmp_path / "made").mkdir()
    words = [sys.executable, "-m", "smash", "generate", "multi", "--blocks", "3", "--out", "made"]
    ended = subprocess.run(
        ["sh", "-c", f'exec "$@" {closed}', "sh", *words], capture_output=True, text=True, cwd=tmp_path, timeout=110
    )
    assert (ended.returncode, ended.stderr) == (0, "")
    assert len((tmp_path / "made" / "multi-3-000.json").read_text()) > 100


def test_the_slowest_pace_is_that_of_scenes():
    assert (PACE.min, PACE.max, PACE.min_open) == (SLOWEST, 1.0, False)


def test_generated_files_are_the_same_for_the_same_seed(tmp_path):
    for name in ("a", "b"):
        assert smash("generate", "multi", "--blocks", 5, "--count", 2, "--out", tmp_path / name).returncode == 0
    assert [f.read_bytes() for f in sorted((tmp_path / "a").iterdir())] == [
        f.read_bytes() for f in sorted((tmp_path / "b").iterdir())
    ]


def test_files_of_another_set_in_the_directory_are_named(tmp_path):
    def generate(count, seed):
        return smash("generate", "multi", "--blocks", 4, "--count", count, "--seed", seed, "--out", tmp_path / "a")

    assert generate(3, 1).stderr == ""
    assert generate(3, 2).stderr == ""
    assert "multi-4-001.json and 1 more" in generate(1, 1).stderr


@pytest.fixture
def filed(tmp_path):
    """Write Fig. 1's kind of instance and a plan of three actions for it."""
    instance = {
        "format": "smash-instance/1",
        "name": "x",
        "blocks": ["a", "b"],
        "stacks": ["s1", "s2"],
        "start": {"s1": ["a", "b"]},
        "goal": {"kind": "positions", "positions": {"a": ["s2", 1]}},
    }
    plan = {
        "format": "smash-plan/1",
        "instance": "x",
        "cost": 3,
        "actions": [["topple", "s1", 2], ["pick", "a", "s1"], ["place", "a", "s2"]],
    }
    return tmp_path, instance, plan


def judge(filed, **change):
    folder, instance, plan = filed
    (folder / "i.json").write_text(json.dumps(instance))
    (folder / "p.json").write_text(json.dumps(plan | change))
    return smash("validate", folder / "i.json", folder / "p.json")


def test_a_legal_plan_is_accepted(filed):
    assert judge(filed).returncode == 0


@pytest.mark.parametrize(
    "change",
    [
        {"instance": "another"},
        {"cost": 2},
        {"topple": False},
        {"actions": [["topple", "s1", 1], ["pick", "a", "table"], ["place", "a", "s2"]], "max_topple": 1},
        {"actions": [["topple", "s1", 2], ["pick", "c", "s1"], ["place", "c", "s2"]]},
        {"actions": [], "cost": 0},
        {"actions": None, "cost": None, "status": "unknown"},
        {"lower_bound": 4},
        {"status": "optimal", "lower_bound": 2},
    ],
)
def test_a_well_formed_plan_that_the_law_refuses_exits_3(filed, change):
    ended = judge(filed, **change)
    assert ended.returncode == 3
    assert ended.stderr.count("\n") == 1


def test_help_names_every_subcommand_and_the_exit_codes():
    shown = smash("--help").stdout
    for word in ("generate", "plan", "validate", "planners", "Exit codes"):
        assert word in shown


@pytest.mark.parametrize("name", COMMANDS)
def test_help_shows_examples_line_by_line(name):
    assert "\\b" not in CliRunner().invoke(command_group, [name, "--help"]).output


def test_a_defect_is_one_line_too(monkeypatch, capsys):
    def broken(**_):
        raise ZeroDivisionError("no such thing")

    monkeypatch.setattr(command_group, "main", broken)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 7
    assert capsys.readouterr().err.startswith("smash: defect: ZeroDivisionError: no such thing (test_doors.py:")


def test_any_json_string_is_a_name_in_every_file_written(filed):
    folder, instance, plan = filed
    judge((folder, instance | {"name": "\ud800"}, plan), instance="\ud800")
    files = [folder / name for name in ("i.json", "p.json", "proof.json")]
    assert smash("certify", *files[:2], "--out", files[2]).returncode == 0
    assert smash("verify", *files).returncode == 0
