"""`smash compare`: one command from instances to a table and its files."""

import subprocess
import sys

import pytest

from smash.cli.compare import with_unit


@pytest.mark.usefixtures("third_party")
def test_planners_are_run_and_compared(tower_file, tmp_path):
    suite = tmp_path / "suite"
    suite.mkdir()
    tower_file.rename(suite / "tower.json")
    names = [word for name in ("sound", "bare", "raises", "lacks") for word in ("--planner", name)]
    command = [sys.executable, "-m", "smash", "compare", suite, *names, "--variant", "topple", "--budget", 2]
    ended = subprocess.run(
        list(map(str, [*command, "--out", tmp_path / "out"])), capture_output=True, text=True, timeout=110
    )
    assert ended.returncode == 0, ended.stderr
    assert "pip install luck; 1 run left out" in ended.stderr
    assert "ValueError: no luck" in ended.stdout
    assert "Contradictions" in (tmp_path / "out" / "comparison" / "comparison.md").read_text()


@pytest.mark.usefixtures("third_party")
def test_records_of_another_comparison_are_kept_and_left_out_of_the_table(tower_file, tmp_path):
    suite = tmp_path / "suite"
    suite.mkdir()
    tower_file.rename(suite / "tower.json")

    def compare(planner):
        command = [
            "compare",
            suite,
            "--planner",
            planner,
            "--variant",
            "topple",
            "--budget",
            1,
            "--out",
            tmp_path / "out",
        ]
        return subprocess.run(
            list(map(str, [sys.executable, "-m", "smash", *command])), capture_output=True, text=True, timeout=110
        )

    assert compare("sound").returncode == 0
    assert "bare" in compare("bare").stdout
    assert "sound" not in (tmp_path / "out" / "comparison" / "comparison.csv").read_text()
    assert len((tmp_path / "out" / "runs.jsonl").read_text().splitlines()) == 2


@pytest.mark.parametrize(("cell", "shown"), [("0.58", "0.58 s"), ("4.40 ms", "4.40 ms"), ("–", "–")])
def test_a_time_on_the_terminal_has_its_unit(cell, shown):
    assert with_unit(cell) == shown


@pytest.mark.parametrize("wrong", [["--planner", "nobody"], ["--planner", "greedy", "--variant", "x"], []])
def test_bad_settings_are_one_line(tmp_path, wrong):
    command = [sys.executable, "-m", "smash", "compare", "multi-4", *wrong, "--out", str(tmp_path / "out")]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=110)
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1
