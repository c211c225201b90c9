"""Rehearsals, and outcome models made from trials."""

import pytest

pytest.importorskip("pybullet")

import msgspec
from click.testing import CliRunner

import smash as door
from smash.cli import smash
from smash.execution.rehearsal import Rehearsal
from smash.execution.scene.scene_file import default_scene
from smash.execution.trials.calibration import calibrations, table
from smash.execution.trials.outcome_model import outcome_model
from smash.forecast.expected import Forecaster
from smash.forecast.model import default_model, write_model
from smash.problem.actions.topple import Topple
from smash.problem.errors import SmashError
from smash.problem.problem import Problem
from smash.records.trials import Landing, Trial


def trial(height, falling, seed=0, seconds=4.0):
    landings = tuple(Landing(height + n, 0.1 * (n + 1), 0.0, True) for n in range(falling))
    return Trial(
        scene="s", stack=0, height=height, falling=falling, seed=seed, stands=True, landings=landings, seconds=seconds
    )


def test_a_rehearsal_times_every_action_and_repeats_itself():
    instance = door.suite("multi-4")[0]
    plan, rehearsal = door.plan(instance, budget=2), Rehearsal(default_scene(), default_model())
    first = rehearsal.of(Problem(instance), plan.actions)
    assert [done.action for done in first] == list(plan.actions)
    assert all(done.seconds is not None and 1.0 < done.seconds < 12.0 for done in first)
    assert rehearsal.of(Problem(instance), plan.actions) == first


@pytest.mark.slow
def test_a_rehearsed_plan_takes_what_its_execution_takes():
    instance = door.suite("multi-4")[0]
    plan = door.plan(instance, budget=2)
    expected = sum(
        done.seconds for done in Rehearsal(default_scene(), default_model()).of(Problem(instance), plan.actions)
    )
    assert expected == pytest.approx(door.execute(instance, plan).times.execution, rel=0.1)


def test_a_model_is_made_of_trials_that_have_times():
    made = outcome_model(default_scene(), [trial(1, 2), trial(2, 1), trial(1, 3, seconds=None)], rounds=1)
    assert [(t.height, t.falling) for t in made.topples] == [(1, 2), (2, 1)]
    assert made.moves.count > 5
    with pytest.raises(SmashError, match="make the map again"):
        outcome_model(default_scene(), [trial(1, 1, seconds=None)])


def without_push(height, falling, seed=0):
    return Trial(scene="s", stack=0, height=height, falling=falling, seed=seed, problem="no push")


def test_a_topple_without_a_push_counts_as_risk():
    made = outcome_model(default_scene(), [trial(1, 2), without_push(1, 2, seed=1)], rounds=1)
    assert [(t.stands, len(t.landed)) for t in made.topples] == [(True, 2), (False, 0)]
    instance = door.make_instance(start={"s1": ["a", "b"]}, goal={"s1": ["b", "a"]})
    assert Forecaster(Problem(instance), made).fall("s1", 1, 2).risk == 0.5
    (row,) = calibrations(made, [trial(1, 2, seed=8), without_push(1, 2, seed=9)])
    assert (row.trials, row.blocks, row.stands, row.stands_expected, row.seconds_off) == (2, 2, 0.5, 0.5, 0.0)
    (row,) = calibrations(made, [without_push(1, 2, seed=9)])
    assert (row.trials, row.blocks, row.stands) == (1, 0, 0.0)
    assert "nan" in table([row])
    with pytest.raises(SmashError, match="make the map again"):
        outcome_model(default_scene(), [without_push(1, 2)])
    with pytest.raises(SmashError, match="one engine"):
        outcome_model(default_scene(), [trial(1, 2), msgspec.structs.replace(trial(1, 1), engine="mujoco")])


def against(tmp_path, *arguments, **changes):
    """Hold a model against trials that are never done; return exit code and words."""
    write_model(msgspec.structs.replace(default_model(), **changes), tmp_path / "model.json")
    files = ["--against", str(tmp_path / "model.json"), "--out", str(tmp_path / "o")]
    ended = CliRunner().invoke(smash, ["topple-map", "--engine", "pybullet", *files, *arguments])
    assert not (tmp_path / "o").exists()
    return ended.exception.exit_code, str(ended.exception)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"layout": "elsewhere"}, "another one"),
        ({"engine": "mujoco"}, "--engine mujoco"),
        ({"topples": ()}, "nothing to hold"),
        ({}, "--first-seed 4"),
    ],
)
def test_a_model_that_the_trials_say_nothing_about_is_refused_before_any(tmp_path, changes, said):
    code, words = against(tmp_path, *([] if not changes else ["--first-seed", "9"]), **changes)
    assert (code, "\n" in words) == (2, False)
    assert said in words


def test_a_topple_whose_push_is_not_found_has_no_time(monkeypatch):
    instance = door.make_instance(start={"s1": ["a", "b"]}, goal={"s1": ["b", "a"]})
    rehearsal, actions = Rehearsal(default_scene(), default_model()), [Topple("s1", 1)]
    assert rehearsal.of(Problem(instance), actions)[0].seconds > 0
    monkeypatch.setattr("smash.execution.rehearsal._Run._planned", lambda self, task, state: None)
    assert rehearsal.of(Problem(instance), actions)[0].seconds is None


def test_the_shipped_model_is_of_the_default_scene():
    assert default_model().layout == default_scene().fingerprint


def test_a_model_that_has_seen_the_trials_is_off_by_nothing():
    made = outcome_model(default_scene(), [trial(1, 2)], rounds=1)
    (row,) = calibrations(made, [trial(1, 2, seed=9)])
    assert row.away == pytest.approx(0.0, abs=1e-6)
    assert (row.within, row.graspable, row.brier, row.seconds_off) == (1.0, 1.0, 0.0, 0.0)
    assert table([row]).count("\n") == 2
