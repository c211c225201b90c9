"""Planners that misbehave, each ends with the right name; beside honest ones their sweep gives honest tables."""

import json
import os
import re
import subprocess
import sys
import tempfile

import psutil
import pytest

from smash.experiments.isolation.caller import run_isolated
from smash.experiments.isolation.job import Job
from smash.experiments.isolation.starting import server_processes
from smash.planners.protocol import Settings
from smash.problem import PlanOptions
from smash.problem.files.instances import read_instance
from smash.problem.problem import Problem
from smash.records.files import RUNS
from tests.experiments.misbehaving import ENDS

pytestmark = pytest.mark.usefixtures("third_party")
AT_ONCE = ("lies-low", "monkeypatches-the-law", "closes-all-files", "forges-its-end", "leaves-a-daemon", "lies-early")
OTHERS = [pytest.param(name, marks=pytest.mark.slow) for name in ENDS if name not in AT_ONCE]
MEMORY = 300
BUDGET = 1.0


def budget(outcome, words=""):
    """Seconds of a run: those that are to hit another limit have time to."""
    return BUDGET if outcome == "over-budget" or words == "stood still" else 60.0


def left():
    """Processes below this one, its fork server apart, and what runs have left in folders and shared memory."""
    below = psutil.Process().children(recursive=True)
    shared = {name for name in os.listdir("/dev/shm") if name.startswith(("psm_", "smash-run-"))}
    return {process for process in below if process.pid not in server_processes()}, shared


@pytest.mark.timeout(300)
@pytest.mark.parametrize("planner", [*AT_ONCE, *OTHERS])
def test_each_ends_with_the_right_name(planner, tower_file, tmp_path, monkeypatch):
    monkeypatch.setenv("STARTS", str(tmp_path / "starts"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    problem = Problem(read_instance(tower_file), PlanOptions())
    before = left()
    files = set(tmp_path.iterdir()) | {tmp_path / "starts"}
    outcome, words = ENDS[planner]
    report = run_isolated(Job(planner, problem, Settings(), budget(outcome, words), MEMORY))
    assert (report.outcome, words in report.reason) == (outcome, True), report
    assert "\n" not in report.reason
    assert left() == before
    assert set(tmp_path.iterdir()) <= files
    if planner in ("lies-early", "forges-its-time"):
        assert report.plan.incumbents[0].seconds > 0.3
    assert run_isolated(Job("bare", problem, Settings(), 60.0)).outcome == "feasible"


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_a_sweep_of_all_beside_honest_ones_gives_honest_tables(tower_file, tmp_path, monkeypatch):
    monkeypatch.setenv("STARTS", str(tmp_path / "starts"))
    suite, out = tmp_path / "suite", tmp_path / "out"
    suite.mkdir()
    (suite / "tower.json").write_text(tower_file.read_text())
    honest = {"astar": "optimal", "precedence": "optimal", "greedy": "feasible", "smash": "optimal"}
    head = f'name = "all"\nsuites = ["."]\nvariants = ["topple"]\nbudgets = [{BUDGET}]\nmemory = {MEMORY}\n'
    ends = ENDS | {name: (end, "") for name, end in honest.items()}
    planners = [f'[[planners]]\nname = "{name}"\nbudgets = [{budget(*end)}]\n' for name, end in ends.items()]
    (suite / "all.toml").write_text(head + "".join(planners))

    def smash(*words):
        return subprocess.run([sys.executable, "-m", "smash", *map(str, words)], capture_output=True, text=True)

    ended = smash("sweep", suite / "all.toml", "--out", out, "--jobs", 2)
    assert ended.returncode == 0, ended.stderr
    records = [json.loads(line) for line in (out / RUNS.name).read_text().splitlines()]
    assert {record["planner"]: record["outcome"] for record in records} == {
        name: end for name, (end, _) in ends.items()
    }
    checked = smash("records", "check", out)
    assert checked.returncode == 3, checked.stdout + checked.stderr
    assert "lies-high" in checked.stdout + checked.stderr
    assert "Traceback" not in checked.stdout + checked.stderr
    reported = smash("report", out)
    assert reported.returncode == 0, reported.stderr
    page = re.sub(r"<[^>]*>", " ", (out / "report" / "index.html").read_text())
    for words in ("lies-high says that no plan is cheaper than 5", "left out: every proof of lies-high"):
        assert words in page
