import dataclasses
import signal
import subprocess
import sys

import psutil
import pytest
from click.testing import CliRunner

from smash.cli import smash
from smash.execution.scene.scene_file import default_scene
from smash.execution.scene.tabletop import Slot
from smash.execution.trials.estimates import Rate, read_estimates, write_estimates
from smash.execution.trials.topple_map import draw, estimates, run_trial
from smash.experiments.episodes.topple_trials import wanted_trials
from smash.problem.errors import MalformedFile, SmashError
from smash.records.trials import Landing, Trial


def trial(height, falling, good, seed=0):
    landings = tuple(Landing(height + n, 0.1 * (n + 1), 0.0, good) for n in range(falling))
    return Trial(scene="s", stack=0, height=height, falling=falling, seed=seed, stands=True, landings=landings)


def test_a_small_topple_succeeds_and_lands_along_the_push():
    done = run_trial(default_scene(), 1, height=2, falling=2, seed=0)
    assert done.success
    assert done.moved < 0.01
    assert all(landing.along > 0.05 and abs(landing.aside) < 0.05 for landing in done.landings)


def test_piles_are_toppled_where_a_strip_is_and_no_higher_than_their_slot_is_made_for():
    low, bare, high = Slot(0.45, 0.0, ("clockwise",), 2), Slot(0.45, 1.0), Slot(0.45, 2.0, ("clockwise",))
    scene = dataclasses.replace(default_scene(), stacks=(low, bare, high))
    wanted = wanted_trials(scene, "mujoco", 4, 9, range(2))
    assert {run.key[1] for run in wanted} == {0, 2}
    assert {run.key[2:4] for run in wanted if run.key[1] == 0} == {(1, 1), (1, 2), (2, 1)}
    assert len([run for run in wanted if run.key[1] == 2]) == 9 + 8 + 7 + 6


def test_a_scene_in_which_no_pile_that_is_toppled_fits_has_no_map():
    scene = dataclasses.replace(default_scene(), stacks=(Slot(0.90, 0.0, ("clockwise",)),))
    with pytest.raises(SmashError, match="no room for a pile"):
        wanted_trials(scene, "mujoco", 4, 9, range(2))


def test_estimates_count_by_cut_and_size():
    found = estimates("s", [trial(1, 2, True), trial(1, 2, False, 1), trial(2, 1, True)])
    assert found.by_cut_and_size == {"1": {"2": Rate(1, 2)}, "2": {"1": Rate(1, 1)}}


def sized(falling, *good, height=1):
    return [trial(height, falling, outcome, seed) for seed, outcome in enumerate(good)]


def test_the_trusted_size_stops_at_the_first_that_fails_too_often():
    trials = sized(1, *[True] * 8) + sized(2, *[True] * 8) + sized(3, *[True] * 8, False, False)
    assert estimates("s", trials).suggested_max_topple == 2
    assert estimates("s", trials).trusted_size(trust=0.7) == 3


def test_a_size_that_mostly_fails_at_one_height_is_not_trusted():
    trials = sized(1, *[True] * 20) + sized(1, True, False, False, height=2)
    assert estimates("s", trials).trusted_size(trust=0.8) == 0


def test_few_trials_are_no_reason_for_trust():
    assert estimates("s", sized(1, *[True] * 7)).suggested_max_topple == 0


def test_no_size_is_trusted_where_the_smallest_fails():
    assert estimates("s", [trial(1, 1, False)]).suggested_max_topple == 0


def test_estimates_are_read_back_as_written(tmp_path):
    found = estimates("s", sized(10, *[True] * 8) + sized(9, *[True] * 8))
    write_estimates(found, tmp_path / "estimates.json")
    assert read_estimates(tmp_path / "estimates.json") == found
    assert found.suggested_max_topple == 10


@pytest.mark.parametrize(
    "text",
    ["[]", "{}", '{"format": "smash-topple-estimates/1", "scene": "s", "by_cut_and_size": {"0": {}}}'],
)
def test_malformed_estimates_are_refused_in_one_line(tmp_path, text):
    (tmp_path / "e.json").write_text(text)
    with pytest.raises(MalformedFile) as refusal:
        read_estimates(tmp_path / "e.json")
    assert "\n" not in str(refusal.value)


def test_a_map_is_drawn(tmp_path):
    draw([trial(1, 1, True), trial(2, 3, False)], tmp_path / "map.png")
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_a_map_that_was_killed_while_writing_goes_on(tmp_path):
    arguments = ["topple-map", "--highest-cut", "1", "--most", "2", "--seeds", "1", "--out", str(tmp_path)]
    assert CliRunner().invoke(smash, arguments).exit_code == 0
    whole = (tmp_path / "trials.jsonl").read_bytes()
    (tmp_path / "trials.jsonl").write_bytes(whole[:-30])
    ended = CliRunner().invoke(smash, arguments)
    assert ended.exit_code == 0, ended.exception
    assert "damaged: set aside" in ended.stderr
    assert (tmp_path / "trials.jsonl").read_bytes() == whole


@pytest.mark.slow
def test_a_map_that_was_interrupted_keeps_its_trials_and_leaves_no_process(tmp_path):
    command = [sys.executable, "-m", "smash", "topple-map", "--jobs", "2", "--seeds", "9", "--out", str(tmp_path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr.readline().startswith("[1/")
        workers = psutil.Process(running.pid).children(recursive=True)
        running.send_signal(signal.SIGINT)
        rest = running.communicate(timeout=100)[1].splitlines()
    assert running.returncode == 130
    assert rest[-1].endswith("start again to do the rest")
    assert workers
    assert not psutil.wait_procs(workers, timeout=60)[1]
    assert (tmp_path / "trials.jsonl").read_text().count("\n") >= 1
