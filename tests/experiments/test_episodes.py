import json
import subprocess
import sys

import msgspec
import pytest

from smash.execution.episode import Episode
from smash.experiments.episode_worker import EpisodeLost, EpisodeWorker
from smash.experiments.episodes import episode_runs, target_depth
from smash.problem import PositionsGoal, make_instance
from tests.execution.episodes import swapped_pair


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


def test_a_process_that_dies_costs_one_episode_and_the_next_is_the_same_as_alone(results):
    run = episode_runs(results, [1], ["open"])[0]
    question = {"record": run.record, "seed": run.seed, "policy": run.policy, "scene": run.scene}
    worker = EpisodeWorker()
    try:
        first = worker.ask(question)
        again = worker.ask(question)
        with pytest.raises(EpisodeLost, match="KeyError"):
            worker.ask({})
        afresh = worker.ask(question)
    finally:
        worker.close()
    assert unmeasured(first) == unmeasured(again) == unmeasured(afresh)


def unmeasured(episode):
    return msgspec.convert(episode, Episode).without_measured_times()


def test_only_plans_of_the_named_planner_are_carried_out(results):
    assert len(episode_runs(results, [0], ["open"], labels=["greedy"])) == 1
    assert episode_runs(results, [0], ["open"], labels=["smash"]) == []


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
