"""Who is asked where the blocks are: the simulator, a file of recorded poses, or eyes of one's own."""

import json
import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from smash.execution.actions.arm_motions import ArmMotions
from smash.execution.executor import Executor
from smash.execution.grounding import Grounder
from smash.execution.observer import Observer
from smash.execution.policy import OPEN
from smash.execution.readback import read_state
from smash.execution.recorded_poses import Look, RecordedPoses, read_looks, recorded_eyes, witnessed, write_looks
from smash.execution.scene.block_pose import BlockPose, quaternion_of, standing
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.noise import parse_noise
from smash.execution.scene.scene_file import default_scene, scene_of
from smash.execution.sight import Sight
from smash.experiments.executing import execute
from smash.motion.move import Move
from smash.problem import MalformedFile, Pick, SmashError, read_instance
from smash.problem.extras import default_engine
from tests.execution.episodes import buried_plan, buried_target
from tests.robots import PANDA, READY

ROOT = Path(__file__).parents[2]
ROW = (0.4, 0.1, 0.0225, 0.0, 0.0, 0.0, 1.0)


def run(eyes, scene=None):
    return Executor(
        buried_target(), buried_plan(), scene or default_scene(), policy=OPEN, eyes=eyes, engine=default_engine()
    ).run()


def at(moment):
    return SimpleNamespace(time=moment)


def filed(path, *looks):
    write_looks(path, looks)
    return path


@pytest.fixture(scope="module")
def witnessed_episode(tmp_path_factory):
    looks: list[Look] = []
    episode = run(witnessed(Sight, looks))
    return episode, filed(tmp_path_factory.mktemp("looks") / "poses.jsonl", *looks)


def test_an_episode_seen_by_its_own_record_is_the_same_episode(witnessed_episode):
    episode, path = witnessed_episode
    assert episode.success
    again = run(recorded_eyes(path, buried_target()))
    assert again.final == episode.final
    assert [(row.action, row.outcome, row.gap) for row in again.actions] == [
        (row.action, row.outcome, row.gap) for row in episode.actions
    ]
    assert again.times.execution == pytest.approx(episode.times.execution, abs=0.01)


def test_whoever_writes_down_what_is_seen_changes_nothing(witnessed_episode):
    assert run(Sight).without_measured_times() == witnessed_episode[0].without_measured_times()


@pytest.mark.slow
def test_the_record_of_eyes_that_err_is_seen_with_their_errors(tmp_path):
    scene = scene_of(None, "pose=3mm,yaw=2deg", None)
    assert scene.noise == parse_noise("pose=3mm,yaw=2deg")
    looks: list[Look] = []
    episode = run(witnessed(Sight, looks), scene)
    assert looks[-1].spread
    again = run(recorded_eyes(filed(tmp_path / "p.jsonl", *looks), buried_target()), scene)
    assert (again.success, again.final) == (episode.success, episode.final)


def test_eyes_of_ones_own_are_asked_and_believed():
    class Cross(Sight):
        """Sees everything five centimetres to the left."""

        def blocks(self):
            return {
                name: BlockPose(pose.position + np.array([0.0, 0.05, 0.0]), pose.rotation)
                for name, pose in super().blocks().items()
            }

    episode = execute(buried_target(), buried_plan(), replan=False, observer=Cross, engine=default_engine())
    assert not episode.success
    assert episode.failure.reason.startswith("at the start, location 's1' holds []")


def test_a_gap_task_is_planned_for_recorded_poses_without_a_simulator(tmp_path):
    instance, scene = buried_target(), default_scene()
    table = Geometry(scene.bind(instance))
    slot = table.slots["s1"]
    towers = {"a": standing(slot.x, slot.y, scene.side / 2, slot.angle)}
    landed = {**towers, **{name: standing(0.35 + 0.08 * n, 0.3, 0.0225, 0.3 * n) for n, name in enumerate("bcd")}}
    rows = {name: (*map(float, pose.position), *quaternion_of(pose.rotation)) for name, pose in landed.items()}
    path = filed(tmp_path / "poses.jsonl", Look(time=0.0, blocks=rows))

    observer: Observer = recorded_eyes(path, instance)(at(0.0), None)
    where = table.seen(observer.blocks(), observer.carriers())
    state = read_state(where, scene)
    assert state.piles["s1"] == ["a"]
    assert state.table == {"b", "c", "d"}
    task = Grounder(ArmMotions(scene, 0)).task(Pick("c", "table"), state, where, READY)
    moves = [segment for segment in task.segments if isinstance(segment, Move)]
    tips = [PANDA.forward(move.path.end).position for move in moves]
    assert min(np.linalg.norm(tip[:2] - landed["c"].position[:2]) for tip in tips) < 0.005


def test_the_page_s_code_runs(tmp_path, monkeypatch, capsys):
    *_, camera, bridge = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "robot.md").read_text(), re.DOTALL)
    instance = read_instance(ROOT / "examples" / "figure1.json")
    slot = default_scene().bind(instance)["s1"]
    heap = {f"b{n}": (0.3 + 0.08 * n, 0.3, 0.0225, *ROW[3:]) for n in (2, 3, 4)}
    filed(tmp_path / "poses.jsonl", Look(time=0.0, blocks={"b1": (slot.x, slot.y, 0.0225, *ROW[3:]), **heap}))
    (tmp_path / "examples").mkdir()
    shutil.copy(ROOT / "examples" / "figure1.json", tmp_path / "examples")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(camera, names)
    eyes: Observer = names["Camera"](lambda: {"a": (ROW[:3], np.eye(3))})
    assert eyes.blocks()["a"].distance(*ROW[:2]) == 0.0
    exec(bridge, names)
    assert names["state"].piles["s1"] == ["b1"]
    assert names["state"].table == {"b2", "b3", "b4"}
    assert len(names["points"][-1][1]) == len(READY)
    assert "fingers 0.0" in capsys.readouterr().out


def test_a_record_tells_what_it_saw_last(tmp_path):
    moved = (0.5, *ROW[1:])
    looks = [Look(time=1.0, blocks={"a": ROW, "b": ROW}), Look(time=2.0, blocks={"a": moved}, spread={"a": 0.002})]
    for moment, x in ((0.0, 0.4), (1.5, 0.4), (2.0, 0.5), (9.0, 0.5)):
        seen = RecordedPoses(looks, at(moment))
        assert seen.blocks()["a"].position[0] == x
        assert seen.blocks()["b"].position[0] == 0.4
        assert seen.spread("a") == (0.002 if moment >= 2.0 else 0.0)
        assert not seen.exact
    assert RecordedPoses(looks[:1], at(0.0)).exact
    assert RecordedPoses(looks).blocks()["a"].position[0] == 0.5


def test_looks_are_read_back_as_they_were_written(tmp_path):
    looks = [Look(time=0.1, blocks={"ä\u2028": ROW}, carriers={"t": ROW}, spread={"ä": 0.1}), Look(time=0.1, blocks={})]
    assert read_looks(filed(tmp_path / "p.jsonl", *looks)) == looks


GOOD = {"format": "smash-poses/1", "time": 0.0, "blocks": {"a": ROW}}


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("", "line 1: not JSON"),
        (json.dumps(GOOD) + "\n\n" + json.dumps(GOOD), "line 2: not JSON"),
        (json.dumps(GOOD).replace("0.4", "1" + 400 * "0"), "line 1: "),
        (json.dumps({**GOOD, "time": 10**400}), "line 1: "),
        ("{", "line 1: not JSON"),
        ("[]", "line 1: not a JSON object"),
        ({**GOOD, "format": "smash-poses/2"}, "line 1: `format`: 'smash-poses/2' is not allowed"),
        ({**GOOD, "cubes": {}}, "line 1: unknown field `cubes`"),
        ({**GOOD, "time": "now"}, "line 1: "),
        ({**GOOD, "time": float("nan")}, "line 1: "),
        ({**GOOD, "blocks": {"a": ROW[:6]}}, "line 1: "),
        ({**GOOD, "blocks": {"a": [*ROW[:6], 0.5]}}, "line 1: `blocks`: 'a': the last four numbers"),
        ({**GOOD, "blocks": {"a": [float("inf"), *ROW[1:]]}}, "line 1: `blocks`: 'a': numbers from -1e+06 to 1e+06"),
        ({**GOOD, "blocks": {"a": [*ROW[:3], *4 * [1e308]]}}, "line 1: `blocks`: 'a': numbers from -1e+06 to 1e+06"),
        ({**GOOD, "spread": {"a": -1.0}}, "line 1: `spread`: 'a'"),
        (json.dumps({**GOOD, "time": 2.0}) + "\n" + json.dumps(GOOD), "line 2: `time`: 0 is before the 2"),
    ],
)
def test_a_malformed_file_is_one_line_with_its_line(tmp_path, lines, said):
    path = tmp_path / "poses.jsonl"
    path.write_text(lines if isinstance(lines, str) else json.dumps(lines))
    with pytest.raises(MalformedFile) as refusal:
        read_looks(path)
    assert str(refusal.value).startswith(f"{path}: {said}")
    assert "\n" not in str(refusal.value)


def test_the_first_look_has_all_blocks_and_others_are_not_looked_at(tmp_path):
    path = filed(tmp_path / "p.jsonl", Look(time=0.0, blocks=dict.fromkeys("abc", ROW)))
    with pytest.raises(MalformedFile, match="line 1: `blocks` has no 'd'"):
        recorded_eyes(path, buried_target())
    path = filed(tmp_path / "p.jsonl", Look(time=0.0, blocks=dict.fromkeys("abcdxy", ROW)))
    assert set(recorded_eyes(path, buried_target())(at(0.0), None).blocks()) == set("abcd")


@pytest.mark.parametrize("given", [3, "missing.jsonl"])
def test_what_is_no_observer_is_refused_before_anything_moves(given):
    with pytest.raises(SmashError) as refusal:
        execute(buried_target(), buried_plan(), observer=given, engine=default_engine())
    assert "\n" not in str(refusal.value)
