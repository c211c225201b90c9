import json
import subprocess
import sys

import pytest

from smash.execution.scene_file import DEFAULT_SCENE
from smash.problem import write_instance, write_plan
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
    assert ended.stderr == ""
    assert json.loads(ended.stdout)["success"] is True
    page = (filed / "r.html").read_text()
    assert len(page) < 15_000_000
    assert "://" not in page
    assert (filed / "s.png").read_bytes().startswith(b"\x89PNG")
    rows = (filed / "t.csv").read_text().splitlines()
    times = [float(row.split(",")[0]) for row in rows[1:]]
    assert times == sorted(times)
    assert len(rows[1].split(",")) == 8


def test_a_failed_execution_exits_5_with_action_and_reason(filed):
    slippery = DEFAULT_SCENE.read_text().replace("finger = 1.0", "finger = 0.01")
    (filed / "scene.toml").write_text(slippery)
    ended = execute(filed, "--scene", "scene.toml", "--no-replan", "--out", "episode.json")
    assert ended.returncode == 5
    assert ended.stderr.count("\n") == 1
    assert "slip" in ended.stderr
    assert json.loads(ended.stdout) == json.loads((filed / "episode.json").read_text())


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--scene", "missing.toml"], 2),
        (["--scene", "instance.json"], 2),
        (["--seed", "-1"], 2),
        (["--video", "film.txt"], 2),
        (["--replay", "nowhere/r.html"], 2),
        (["--stills", "still.txt"], 2),
        (["--out", "nowhere/episode.json"], 2),
    ],
)
def test_bad_arguments_get_one_line(filed, arguments, code):
    ended = execute(filed, *arguments)
    assert ended.returncode == code
    assert ended.stderr.count("\n") == 1


def test_a_plan_that_the_law_refuses_is_not_executed(filed):
    write_plan(plan_of("buried", *buried_plan().actions[1:]), filed / "plan.json")
    ended = execute(filed)
    assert ended.returncode == 3
    assert ended.stdout == ""
    assert ended.stderr.count("\n") == 1
