"""The audit of episodes: each thing that can be wrong with them is found and named; their tables."""

import json

import pandas as pd
import pytest
from click.testing import CliRunner

from smash.cli import smash
from smash.execution.scene.scene_file import read_scene
from smash.experiments.episodes.asked import asked_runs, note_asked
from smash.experiments.episodes.audit import audit_episodes
from smash.experiments.episodes.series import episode_runs
from smash.motion.robots import load_robot
from tests.analysis.made_up import record as made_up_run
from tests.analysis.test_export import PLAN
from tests.six_joints import written

DONE = {"outcome": "done", "reason": None, "attempts": 1, "gap": False, "repaired": False, "begun": 0.1}
TIMES = {"offline": 1.0, "offline_cpu": 0.5, "online": 2.0, "online_cpu": 0.2, "execution": 9.0}
SETTING = {
    **{"format": "smash-episode/1", "instance": "i0", "planner": "p", "topple": True, "max_topple": None},
    **{"scene": "default", "seed": 0, "replanning": False, "final": {"piles": {}, "table": []}},
}
RUN = made_up_run(0, [(0.1, 4)], actions=PLAN).document


def episode(success=True, failure=None):
    actions = [
        {"step": n, "action": action, "origin": "plan", **DONE, "times": TIMES} for n, action in enumerate(PLAN, 1)
    ]
    numbers = {"plan_cost": 3, "actions_executed": 3, "replans": 0, "retries": 1}
    return {
        **SETTING,
        "success": success,
        "failure": failure,
        **numbers,
        "actions": actions,
        "times": TIMES | {"task": 0.0},
    }


def failure(reason):
    return {"name": "slip", "reason": reason, "step": 2, "action": PLAN[1]}


def record(seed, policy="open", **more):
    shared = {
        name: RUN[name] for name in ("instance", "suite", "label", "variant", "blocks", "cost", "status", "budget")
    }
    return {
        "format": "smash-episode-run/1",
        "key": f"{RUN['key']}/{policy}/{seed}",
        "run": RUN["key"],
        **shared,
        "policy": policy,
        "seed": seed,
        "scene": None,
        "depth": None,
        "first_plan_seconds": 0.1,
        "best_plan_seconds": 0.1,
        "episode": episode(),
        "problem": "",
        "wall_seconds": 12.0,
        "started": "2026-01-01T00:00:00.000+00:00",
        "load_average": [0.1, 0.2],
        "commit": {"hash": "c", "dirty": False},
        "machine": RUN["machine"],
        "versions": {"pybullet": "3"},
        **more,
    }


@pytest.fixture
def findings(tmp_path):
    """Write episodes of one plan, two seeds of them asked for; return what the audit finds."""

    def ask(*records, last=""):
        (tmp_path / "runs.jsonl").write_text(json.dumps(RUN) + "\n")
        (tmp_path / "episodes.jsonl").write_text("".join(json.dumps(entry) + "\n" for entry in records) + last)
        note_asked(tmp_path, 2, ["open"], None, [])
        return [finding for check in audit_episodes(tmp_path) for finding in check.findings]

    return ask


def test_sound_episodes_are_well(findings):
    assert findings(record(0), record(1)) == []


@pytest.mark.parametrize(
    ("fields", "finding"),
    [
        ({"episode": None}, "unexplained: line 2 (p on multi-9/i0, topple, open, seed 1): no end, without a reason"),
        ({"episode": episode(False, failure(" "))}, "unexplained: line 2"),
        ({"episode": episode(False)}, "unexplained: line 2"),
        ({"episode": episode(True, failure("x"))}, "unexplained: line 2"),
        ({"commit": {"hash": "d", "dirty": False}}, "mixed commits"),
        ({"versions": {"pybullet": "2"}}, "mixed versions: pybullet"),
        ({"run": "another"}, "no plan: line 2"),
        ({"cost": 9}, "another plan: line 2"),
        ({"depth": "deep"}, "damaged: line 2"),
    ],
)
def test_what_is_wrong_is_one_line_each(findings, fields, finding):
    found = [line for line in findings(record(0), record(1, **fields)) if "missing" not in line]
    assert len(found) == 1
    assert found[0].startswith(f"episodes: {finding}")


def test_a_failure_and_a_crash_with_a_reason_are_explained(findings):
    failed = episode(False, failure("it fell"))
    assert findings(record(0, episode=failed), record(1, episode=None, problem="killed")) == []


def test_missing_repeated_and_other_episodes_are_found(findings):
    assert findings(record(0)) == ["episodes: missing: p, open: 1 of 2"]
    found = findings(record(0), record(1), record(0), record(0, "replan"))
    assert [line.split(":")[1].strip() for line in found] == ["not asked for", "twice"]


def test_a_half_written_last_line_is_found_and_its_episode_is_missing(findings):
    found = findings(record(0), last=json.dumps(record(1))[:100])
    assert [line.split(":")[1].strip() for line in found] == ["damaged", "missing"]


def test_questions_add_up_and_are_noted_once(findings, tmp_path):
    findings(record(0))
    note_asked(tmp_path, 2, ["open"], None, [])
    scene = tmp_path / "narrow.toml"
    scene.write_text('format = "smash-scene/1"\nname = "narrow"\nbase = "default"\n')
    note_asked(tmp_path, 1, ["replan"], scene, ["p"])
    told = f"narrow-{read_scene(scene).fingerprint}"
    scene.unlink()
    assert sorted(run.key for run in asked_runs(tmp_path)) == [
        f"{RUN['key']}/{end}" for end in ("open/0", "open/1", f"replan/0/{told}")
    ]


def test_episodes_of_another_robot_are_other_episodes(findings, tmp_path):
    findings(record(0))
    robot = written(tmp_path)
    called = load_robot(robot).label
    note_asked(tmp_path, 1, ["open"], None, [], robot=str(robot))
    (tmp_path / "six.toml").unlink()
    assert sorted(run.key for run in asked_runs(tmp_path)) == [
        f"{RUN['key']}/{end}" for end in ("open/0", f"open/0/{called}", "open/1")
    ]


def test_what_is_asked_of_another_robot_goes_to_it(findings, tmp_path):
    findings(record(0))
    robot = str(written(tmp_path))
    (run,) = episode_runs(tmp_path, range(1), ["open"], robot=robot)
    assert run.robot == load_robot(robot).label
    assert run.tabletop["robot"] == robot
    (plain,) = episode_runs(tmp_path, range(1), ["open"])
    assert (plain.robot, plain.tabletop) == ("panda", None)


def test_where_nothing_was_carried_out_nothing_is_asked(tmp_path):
    assert audit_episodes(tmp_path) == []


def test_an_episode_and_an_action_are_a_row_each(findings, tmp_path):
    failed = episode(False, failure("it fell"))
    findings(record(0, episode=failed), record(1, episode=None, problem="killed"))
    ended = CliRunner().invoke(smash, ["records", "export", str(tmp_path), "--out", str(tmp_path / "out")])
    assert ended.exit_code == 0, ended.output
    episodes = pd.read_parquet(tmp_path / "out" / "episodes.parquet")
    assert episodes["success"].tolist() == [False, False]
    assert episodes["failure"].tolist() == ["slip", pd.NA]
    assert episodes["problem"].tolist() == ["", "killed"]
    assert episodes["execution_seconds"].tolist()[0] == 9.0
    assert set(episodes["run"]) == {RUN["key"]}
    actions = pd.read_csv(tmp_path / "out" / "actions.csv")
    assert actions["step"].tolist() == [1, 2, 3]
    assert actions["location"].tolist() == ["s1", "table", "s2"]
