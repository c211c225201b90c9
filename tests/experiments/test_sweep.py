"""Sweeps: recorded as they end, resumed after any kill, exactly once, by one process at a time."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from contextlib import suppress

import psutil
import pytest

from smash.records.files import RUNS
from smash.records.locking import InUse
from smash.records.writing import Writer
from tests.experiments.tables import tables

pytestmark = pytest.mark.usefixtures("third_party")

HEAD = 'name = "try"\nsuites = ["."]\nvariants = ["topple"]\nbudgets = [0.3]\n'


@pytest.fixture
def experiment(tower_file, tmp_path):
    """Write an experiment over `count` copies of the tower."""

    def write(planners, count=1, head=HEAD):
        suite = tmp_path / "suite"
        suite.mkdir(exist_ok=True)
        tower = json.loads(tower_file.read_text())
        for number in range(count):
            (suite / f"{number}.json").write_text(json.dumps({**tower, "name": f"tower-{number}"}))
        file = suite / "experiment.toml"
        file.write_text(head + "".join(f'[[planners]]\nname = "{planner}"\n' for planner in planners))
        return file

    return write


def command(file, out, *more):
    return [sys.executable, "-m", "smash", "sweep", str(file), "--out", str(out), *map(str, more)]


def sweep(file, out, *more):
    return subprocess.run(command(file, out, *more), capture_output=True, text=True, timeout=300)


def records(out):
    return [json.loads(line) for line in (out / RUNS.name).read_text().splitlines()]


def whole_lines(out):
    text = (out / RUNS.name).read_text() if (out / RUNS.name).exists() else ""
    return {line for line in text.splitlines(keepends=True) if line.endswith("\n")}


def left_behind(mark):
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error, OSError):
            if process.environ().get("MARKED") == mark and process.pid != os.getpid():
                found.append(process)
    return found


def test_every_kind_of_trouble_is_a_recorded_outcome(experiment, tmp_path, monkeypatch):
    monkeypatch.setenv("MARKED", str(tmp_path))
    ends = {
        "sound": "optimal",
        "raises": "crashed",
        "segfaults": "crashed",
        "exits": "crashed",
        "leaves-children": "over-budget",
        "eats-memory": "memory",
        "cheats": "refused",
        "declines": "unsupported",
    }
    ended = sweep(experiment(ends, head="memory = 250\n" + HEAD.replace("0.3", "2")), tmp_path / "out", "--jobs", 4)
    assert ended.returncode == 0, ended.stderr
    assert {record["planner"]: record["outcome"] for record in records(tmp_path / "out")} == ends
    assert not left_behind(str(tmp_path))


def test_a_record_says_what_ran_where_and_how_it_ended(experiment, tmp_path):
    sweep(experiment(["sound"]), tmp_path / "out")
    (record,) = records(tmp_path / "out")
    assert record["format"] == "smash-run/1"
    assert record["cost"] == len(record["actions"]) == 3
    assert [cost for _, cost, _ in record["incumbents"]] == [9, 5, 3]
    assert record["verdict"] == {"accepted": True, "reason": "", "step": None}
    assert record["versions"]["troubled"] == "1.0"
    assert record["versions"]["python"].startswith("3.")
    assert record["machine"]["cores"] >= 1
    assert record["memory_mib"] > 1
    assert {"hash", "dirty"} == set(record["commit"])


def test_a_planner_that_is_not_installed_is_said_and_left_for_later(experiment, tmp_path):
    ended = sweep(experiment(["bare", "lacks"]), tmp_path / "out")
    assert "pip install luck; 1 run left out" in ended.stderr
    assert [record["planner"] for record in records(tmp_path / "out")] == ["bare"]


@pytest.mark.parametrize("kills", [2, pytest.param(10, marks=[pytest.mark.slow, pytest.mark.timeout(900)])])
def test_killed_at_random_moments_it_loses_nothing_and_repeats_nothing(experiment, tmp_path, monkeypatch, kills):
    monkeypatch.setenv("MARKED", str(tmp_path))
    file, out = experiment(["hangs-with-plan", "sound"], count=3 * kills), tmp_path / "out"
    seen, chance = set(), random.Random(5)
    for _ in range(kills):
        running = subprocess.Popen(command(file, out, "--jobs", 2), stderr=subprocess.DEVNULL)
        until = len(seen) + chance.randint(0, 4)
        while len(whole_lines(out)) < until:
            time.sleep(0.02)
        time.sleep(chance.uniform(0.0, 1.5))
        running.send_signal(signal.SIGKILL)
        running.wait()
        now = whole_lines(out)
        assert seen <= now
        seen = now
    ended = sweep(file, out, "--jobs", 2)
    assert ended.returncode == 0, ended.stderr
    assert seen <= whole_lines(out)
    keys = [record["key"] for record in records(out)]
    assert len(keys) == len(set(keys)) == 6 * kills
    assert not left_behind(str(tmp_path))
    if kills == 2:
        return
    assert 0 < len(seen) < len(keys)
    assert sweep(file, tmp_path / "undisturbed", "--jobs", 2).returncode == 0
    assert tables(out) == tables(tmp_path / "undisturbed")


def test_an_interrupted_sweep_says_so_and_goes_on_later(experiment, tmp_path):
    file, out = experiment(["hangs"], count=4), tmp_path / "out"
    running = subprocess.Popen(command(file, out), stderr=subprocess.PIPE, text=True)
    while not ((out / RUNS.name).exists() and (out / RUNS.name).read_text()):
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=100)
    assert running.returncode == 130
    assert "start again" in said.splitlines()[-1]
    assert 1 <= len(records(out)) < 4


def test_a_damaged_last_line_is_set_aside_and_its_run_done_again(experiment, tmp_path):
    file, out = experiment(["bare"], count=2), tmp_path / "out"
    sweep(file, out)
    whole = (out / RUNS.name).read_bytes()
    (out / RUNS.name).write_bytes(whole[:-40])
    ended = sweep(file, out)
    assert "damaged: set aside" in ended.stderr
    assert "1 of 2 runs were finished before" in ended.stderr
    assert len(records(out)) == 2
    assert (out / "runs.damaged").read_bytes().strip() in whole


def test_damage_elsewhere_is_set_aside_with_its_line_and_its_run_done_again(experiment, tmp_path):
    file, out = experiment(["bare"], count=2), tmp_path / "out"
    sweep(file, out)
    first, second = (out / RUNS.name).read_bytes().splitlines(keepends=True)
    (out / RUNS.name).write_bytes(first.replace(b'"budget": 0.3', b'"budget": NaN') + second)
    ended = sweep(file, out)
    assert "runs.jsonl: line 1: no JSON: NaN is no number of JSON: damaged: set aside" in ended.stderr
    assert len(records(out)) == 2


def test_runs_that_ended_so_are_done_again_where_it_is_asked_for(experiment, tmp_path, monkeypatch):
    monkeypatch.setenv("STARTS", str(tmp_path / "starts"))
    file, out = experiment(["bare", "raises", "kills-its-guardian"]), tmp_path / "out"
    sweep(file, out)
    before = records(out)
    assert {record["reason"] for record in before if record["planner"] == "kills-its-guardian"} == {
        "the process that guards the run was killed"
    }
    ended = sweep(file, out, "--redo", "crashed")
    count = sum(record["outcome"] == "crashed" for record in before)
    assert f"{count} recorded runs are done again" in ended.stderr
    assert len((out / "runs.redone").read_text().splitlines()) == count > 0
    assert sorted(record["key"] for record in records(out)) == sorted(record["key"] for record in before)


def test_a_full_disk_names_the_file_and_loses_nothing_finished(experiment, tmp_path):
    file, out = experiment(["bare"], count=6), tmp_path / "out"
    full = ["bash", "-c", 'ulimit -f 9; exec "$@"', "bash", *command(file, out)]
    ended = subprocess.run(full, capture_output=True, text=True, timeout=100)
    assert ended.returncode == 2
    assert ended.stderr.splitlines()[-1] == f"smash: {out / RUNS.name}: cannot be written: File too large"
    assert "Traceback" not in ended.stderr
    kept = whole_lines(out)
    assert 0 < len(kept) < 6
    assert sweep(file, out).returncode == 0
    assert kept < whole_lines(out)
    assert len({record["key"] for record in records(out)}) == len(records(out)) == 6


def test_where_no_scratch_folder_can_be_made_the_folder_is_named_and_no_planner_blamed(experiment, tmp_path):
    file, out = experiment(["bare"]), tmp_path / "out"
    code = "import sys, tempfile; tempfile.tempdir = '/nowhere'; from smash.cli import main; main()"
    words = [sys.executable, "-c", code, *command(file, out)[3:]]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=100)
    assert ended.returncode == 2
    assert "/nowhere/smash-run-" in ended.stderr.splitlines()[-1]
    assert "a run cannot write there: No such file or directory" in ended.stderr
    assert not records(out)


def test_two_sweeps_on_one_directory_are_refused(experiment, tmp_path):
    with Writer(tmp_path / "out", RUNS):
        with pytest.raises(InUse):
            Writer(tmp_path / "out", RUNS)
        ended = sweep(experiment(["bare"]), tmp_path / "out")
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1


def test_nothing_runs_where_the_file_is_bad(experiment, tmp_path):
    ended = sweep(experiment(["nobody"]), tmp_path / "out")
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("address", ["nonsense://x", "tls://127.0.0.1:9"])
def test_no_scheduler_at_the_address_is_one_line(experiment, tmp_path, address):
    ended = sweep(experiment(["bare"]), tmp_path / "out", "--dask", address)
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1
