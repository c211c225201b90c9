import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress

import msgspec
import psutil
import pytest

from smash.experiments.episodes.series import episode_runs, run_episode, target_depth
from smash.experiments.episodes.simulating import carry_out
from smash.experiments.episodes.simulation import Simulation
from smash.experiments.isolation.hearing import done
from smash.problem import PositionsGoal, make_instance
from smash.problem.errors import SmashError, Unsupported
from smash.problem.extras import is_there
from smash.records.episodes import Episode
from smash.records.files import EPISODES
from tests.execution.episodes import swapped_pair

simulated = pytest.mark.skipif(not is_there("pybullet"), reason="pybullet is not installed (the extra execution)")


def smash(*arguments):
    command = [sys.executable, "-m", "smash", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=110)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """A sweep of one instance by greedy."""
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "set").mkdir()
    from smash.problem import write_instance

    write_instance(swapped_pair(), folder / "set" / "swapped.json")
    (folder / "small.toml").write_text(
        'name = "small"\nsuites = ["set"]\nbudgets = [2.0]\nvariants = ["topple"]\n[[planners]]\nname = "greedy"\n'
    )
    assert smash("sweep", folder / "small.toml", "--out", folder / "out").returncode == 0
    return folder / "out"


@pytest.mark.skipif(not is_there("mujoco"), reason="mujoco is not installed")
def test_no_episode_is_carried_out_by_another_robot_than_was_asked_for(results):
    (run,) = episode_runs(results, [0], ["open"], engine="mujoco", called="panda-01234567")
    with pytest.raises(SmashError, match=r"'panda-01234567' was asked for, and .*panda\.toml holds 'panda' now"):
        carry_out(run)


@simulated
def test_a_dry_run_writes_nothing(results, tmp_path):
    there = tmp_path / "there"
    shutil.copytree(results, there, ignore=shutil.ignore_patterns("episodes*"))
    before = sorted(file.name for file in there.iterdir())
    ended = smash("episodes", there, "--dry-run", "--redo")
    assert (ended.returncode, ended.stderr.split(",")[0]) == (0, "1 episode")
    assert sorted(file.name for file in there.iterdir()) == before


@simulated
def test_an_episode_without_one_is_carried_out_again_by_redo(results, tmp_path):
    there = tmp_path / "there"
    shutil.copytree(results, there, ignore=shutil.ignore_patterns("episodes*"))
    assert smash("episodes", there, "--seeds", "2", "--policy", "open").returncode == 0
    first, second = (there / "episodes.jsonl").read_text().splitlines()
    lost = json.dumps({**json.loads(first), "episode": None, "problem": "its guardian was killed"})
    (there / "episodes.jsonl").write_text(f"{lost}\n{second}\n")
    ended = smash("episodes", there, "--seeds", "2", "--policy", "open", "--redo")
    assert "1 recorded episode carried out again; their records lie in episodes.redone" in ended.stderr
    records = [json.loads(line) for line in (there / "episodes.jsonl").read_text().splitlines()]
    assert {record["key"] for record in records} == {json.loads(line)["key"] for line in (first, second)}
    assert all(record["episode"] for record in records)
    assert (there / "episodes.redone").read_text() == f"{lost}\n"


@simulated
def test_every_plan_is_carried_out_once_and_kept(results):
    ended = smash("episodes", results, "--policy", "open", "--policy", "replan")
    assert ended.returncode == 0, ended.stderr
    first = (results / "episodes.jsonl").read_text()
    records = [json.loads(line) for line in first.splitlines()]
    assert {record["policy"] for record in records} == {"open", "replan"}
    assert all(record["episode"]["success"] for record in records), [r["problem"] for r in records]
    again = smash("episodes", results, "--policy", "open", "--policy", "replan")
    assert "0 left" in again.stderr
    assert (results / "episodes.jsonl").read_text() == first


@simulated
def test_an_episode_that_dies_is_recorded_with_its_reason_and_the_next_is_the_same_as_alone(results):
    run = episode_runs(results, [1], ["open"])[0]
    first, lost, again = (run_episode(asked) for asked in (run, msgspec.structs.replace(run, tabletop={}), run))
    assert lost.episode is None
    assert "missing required field" in lost.problem
    assert unmeasured(first.episode) == unmeasured(again.episode)


@simulated
@pytest.mark.parametrize(
    ("limits", "said"), [({"budget": 0.01}, "still running after"), ({"memory": 20}, "the limit is 20")]
)
def test_limits_hold_for_episodes_as_for_planners(results, limits, said):
    ended = done(Simulation(episode_runs(results, [1], ["open"])[0], **limits))
    assert ended.answer is None
    assert said in ended.reason


@simulated
def test_a_machine_without_the_engine_has_no_episode_to_record(results, tmp_path, monkeypatch):
    (tmp_path / "mujoco.py").write_text("raise ModuleNotFoundError('No module named mujoco', name='mujoco')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    run = msgspec.structs.replace(episode_runs(results, [1], ["open"])[0], engine="mujoco")
    with pytest.raises(Unsupported, match=r"needs mujoco: pip install 'smash-testbed\[mujoco\]'"):
        run_episode(run)


def unmeasured(episode):
    return episode.without_measured_times()


def test_only_plans_of_the_named_planner_are_carried_out(results):
    assert len(episode_runs(results, [0], ["open"], labels=["greedy"])) == 1
    with pytest.raises(SmashError, match="no plan by 'smash'; there are plans by greedy"):
        episode_runs(results, [0], ["open"], labels=["smash"])


@simulated
def test_a_dry_run_runs_nothing(results):
    ended = smash("episodes", results, "--seeds", "3", "--dry-run")
    assert ended.returncode == 0
    assert "3 episodes" in ended.stderr


def test_seeds_and_policies_multiply_the_plans(results):
    assert len(episode_runs(results, range(3), ("open", "replan"))) == 6


def test_depth_counts_from_the_top():
    instance = make_instance(
        name="x", blocks="abc", stacks=["s", "g"], start={"s": "abc"}, goal=PositionsGoal({"a": ("g", 1)})
    )
    assert target_depth(instance) == 3
    assert target_depth(swapped_pair()) is None


def determined(results):
    """What the seeds determine of every episode, by its key."""
    found = {}
    for line in (results / EPISODES.name).read_text().splitlines():
        record = json.loads(line)
        assert record["key"] not in found
        found[record["key"]] = unmeasured(msgspec.convert(record["episode"], Episode))
    return found


def alive(mark):
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error, OSError):
            if process.environ().get("MARKED") == mark and process.pid != os.getpid():
                found.append(process)
    return found


@simulated
@pytest.mark.slow
@pytest.mark.timeout(900)
def test_killed_at_random_moments_no_episode_is_lost_or_repeated(results, tmp_path, monkeypatch):
    monkeypatch.setenv("MARKED", str(tmp_path))
    disturbed, undisturbed = tmp_path / "disturbed", tmp_path / "undisturbed"
    for folder in (disturbed, undisturbed):
        folder.mkdir()
        shutil.copyfile(results / "runs.jsonl", folder / "runs.jsonl")
    more = ("--policy", "open", "--policy", "replan", "--seeds", "6", "--jobs", "2")
    seen, chance = [], random.Random(8)
    for _ in range(10):
        command = [sys.executable, "-m", "smash", "episodes", str(disturbed), *more]
        running = subprocess.Popen(command, stderr=subprocess.DEVNULL)
        time.sleep(chance.uniform(1.0, 12.0))
        running.send_signal(signal.SIGKILL)
        running.wait()
        assert not psutil.wait_procs(alive(str(tmp_path)), timeout=60)[1]
        text = (disturbed / EPISODES.name).read_text() if (disturbed / EPISODES.name).exists() else ""
        now = [line for line in text.splitlines(keepends=True) if line.endswith("\n")]
        assert now[: len(seen)] == seen
        seen = now
    for folder in (disturbed, undisturbed):
        ended = subprocess.run(
            [sys.executable, "-m", "smash", "episodes", str(folder), *more], stderr=subprocess.PIPE, text=True
        )
        assert ended.returncode == 0, ended.stderr
    assert (disturbed / EPISODES.name).read_text().startswith("".join(seen))
    made = determined(disturbed)
    assert len(made) == 12
    assert made == determined(undisturbed)


@simulated
def test_a_damaged_last_episode_is_set_aside_and_carried_out_again(results, tmp_path):
    for name in ("runs.jsonl", EPISODES.name):
        shutil.copyfile(results / name, tmp_path / name)
    whole = (tmp_path / EPISODES.name).read_bytes()
    (tmp_path / EPISODES.name).write_bytes(whole[:-50])
    asked = ("episodes", tmp_path, "--policy", "open", "--policy", "replan")
    said = smash(*asked, "--dry-run").stderr
    assert "2 episodes, 1 left" in said
    assert "left out, a resumed run does its episode again" in said
    assert (tmp_path / EPISODES.name).read_bytes() == whole[:-50]
    ended = smash(*asked)
    assert "damaged: set aside, its episode is carried out again" in ended.stderr
    assert "2 episodes, 1 left" in ended.stderr
    assert (tmp_path / "episodes.damaged").read_bytes().strip() in whole


@simulated
def test_an_interrupted_one_ends_at_once_and_keeps_what_had_ended(results, tmp_path):
    shutil.copyfile(results / "runs.jsonl", tmp_path / "runs.jsonl")
    running = subprocess.Popen(
        [sys.executable, "-m", "smash", "episodes", str(tmp_path)], stderr=subprocess.PIPE, text=True
    )
    said = running.stderr.readline()
    assert "1 episode, 1 left" in said
    time.sleep(0.5)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=100)
    assert running.returncode == 130
    assert "start again" in said.splitlines()[-1]
