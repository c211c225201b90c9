import itertools
import json
import os
import subprocess
import sys
import time

import pytest

from smash.execution.scene.scene_file import DEFAULT_SCENE
from smash.problem import Place, PositionsGoal, make_instance, write_instance, write_plan
from tests.execution.episodes import buried_plan, buried_target, plan_of


@pytest.fixture
def filed(tmp_path):
    write_instance(buried_target(), tmp_path / "instance.json")
    write_plan(buried_plan(), tmp_path / "plan.json")
    return tmp_path


def execute(folder, *arguments):
    command = [sys.executable, "-m", "smash", "execute", "instance.json", "plan.json", *arguments]
    return subprocess.run(command, capture_output=True, text=True, cwd=folder, timeout=100)


def test_the_command_prints_the_episode_and_leaves_its_files(filed):
    ended = execute(filed, "--no-replan", "--replay", "r.html", "--stills", "s.png", "--trajectory", "t.csv")
    assert ended.returncode == 0, ended.stderr
    assert ended.stderr == "engine: pybullet (--engine names another)\n"
    assert json.loads(ended.stdout)["success"] is True
    page = (filed / "r.html").read_text()
    assert len(page) < 15_000_000
    assert "://" not in page
    assert (filed / "s.png").read_bytes().startswith(b"\x89PNG")
    rows = (filed / "t.csv").read_text().splitlines()
    times = [float(row.split(",")[0]) for row in rows[1:]]
    assert times == sorted(times)
    assert len(rows[1].split(",")) == 9
    assert max(later - earlier for earlier, later in itertools.pairwise(times)) < 0.015


def test_a_failed_execution_exits_5_with_action_and_reason(filed):
    slippery = DEFAULT_SCENE.read_text().replace("finger = 1.0", "finger = 0.01")
    (filed / "scene.toml").write_text(slippery)
    ended = execute(filed, "--scene", "scene.toml", "--no-replan", "--out", "episode.json")
    assert ended.returncode == 5
    assert ended.stderr.count("\n") == 1
    assert "slip" in ended.stderr
    assert json.loads(ended.stdout) == json.loads((filed / "episode.json").read_text())


def test_a_start_with_a_full_hand_is_one_line_and_exit_6(filed):
    instance = make_instance(
        name="full", blocks=["a"], stacks=["s1", "s2"], start={}, hand="a", goal=PositionsGoal({"a": ("s1", 1)})
    )
    write_instance(instance, filed / "instance.json")
    write_plan(plan_of("full", Place("a", "s1")), filed / "plan.json")
    ended = execute(filed)
    assert (ended.returncode, ended.stdout, ended.stderr.count("\n")) == (6, "", 1)
    assert "'a' in the hand" in ended.stderr


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--scene", "missing.toml"], 2),
        (["--scene", "instance.json"], 2),
        (["--noise", "pose=3"], 2),
        (["--pace", "0"], 2),
        (["--video-size", "480x368"], 2),
        (["--video", "film.mp4", "--video-camera", "up"], 2),
        (["--seed", "-1"], 2),
        (["--video", "film.txt"], 2),
        (["--replay", "nowhere/r.html"], 2),
        (["--stills", "still.txt"], 2),
        (["--trajectory", "t.bag"], 2),
        (["--seed", "18446744073709551616"], 2),
        (["--budget", "nan"], 2),
        (["--replay", "plan.json/r.html"], 2),
        (["--replay", "same.html", "--out", "same.html"], 2),
        (["--replay", ""], 2),
        (["--replanner", "martian"], 2),
        (["--replanner", "greedy", "--no-replan"], 2),
        (["--out", "nowhere/episode.json"], 2),
    ],
)
def test_bad_arguments_get_one_line(filed, arguments, code):
    ended = execute(filed, *arguments)
    assert ended.returncode == code
    assert ended.stderr.count("\n") == 1


def test_a_size_for_a_block_that_the_instance_has_not_is_said_in_one_line_and_no_error(filed):
    """Here the start with a full hand is what ends it."""
    test_a_start_with_a_full_hand_is_one_line_and_exit_6(filed)
    sizes = DEFAULT_SCENE.read_text() + "\n[blocks]\na = {height = 0.04}\nc = {height = 0.05}\n"
    (filed / "scene.toml").write_text(sizes)
    ended = execute(filed, "--scene", "scene.toml")
    said = "scene 'default' has sizes for blocks that instance 'full' has not: 'c'"
    assert (ended.returncode, ended.stderr.splitlines()[0]) == (6, said)


def test_a_block_that_the_hand_cannot_hold_is_one_line_with_its_name_and_exit_2(filed):
    (filed / "scene.toml").write_text(DEFAULT_SCENE.read_text() + "\n[blocks]\na = {footprint = 0.09}\n")
    ended = execute(filed, "--scene", "scene.toml")
    assert (ended.returncode, ended.stdout, ended.stderr.count("\n")) == (2, "", 1)
    assert "`blocks.a.footprint`: 0.09 m is not allowed; 0.03 to 0.07" in ended.stderr


def test_a_plan_that_the_law_refuses_is_not_executed(filed):
    write_plan(plan_of("buried", *buried_plan().actions[1:]), filed / "plan.json")
    ended = execute(filed)
    assert ended.returncode == 3
    assert ended.stdout == ""
    assert ended.stderr.count("\n") == 1


@pytest.mark.parametrize("display", [None, ":77", "nonsense"])
def test_without_a_display_there_is_no_window_and_one_line_says_so(filed, display):
    environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    environment |= {} if display is None else {"DISPLAY": display}
    command = [sys.executable, "-m", "smash", "execute", "instance.json", "plan.json", "--gui"]
    ended = subprocess.run(command, capture_output=True, text=True, cwd=filed, timeout=100, env=environment)
    assert ended.returncode == 6
    assert ended.stderr.count("\n") == 1
    assert "no window can be opened" in ended.stderr


@pytest.mark.slow
def test_a_polite_kill_ends_an_execution_as_ctrl_c_does_and_leaves_nothing(filed):
    command = [sys.executable, "-m", "smash", "execute", "instance.json", "plan.json", "--video", "film.mp4"]
    environment = os.environ | {"TMPDIR": str(filed)}
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=filed, env=environment) as running:
        time.sleep(6)
        running.terminate()
        words = running.communicate(timeout=100)[1]
    assert running.returncode == 130
    assert "smash: interrupted" in words.splitlines()
    assert sorted(path.name for path in filed.iterdir()) == ["instance.json", "plan.json"]
