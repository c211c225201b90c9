"""A results directory holds what was run: it is checked and run again wherever it is moved to."""

import json
import shutil

import pytest
from click.testing import CliRunner

from smash.cli import smash
from smash.experiments.sweeps.experiment import Experiment, PlannerEntry, experiment_runs, read_experiment
from smash.experiments.sweeps.keep import experiment_text, keep, suites

NAMES = ["my set", "../sets/my set", ".", "multi-4"]


@pytest.fixture
def home(tower_file, tmp_path):
    """A folder with an instance, and a set in it and beside it."""
    home = tmp_path / "home"
    tower = json.loads(tower_file.read_text())
    for folder in (home, home / "my set", tmp_path / "sets" / "my set"):
        folder.mkdir(parents=True)
        (folder / "tower.json").write_text(json.dumps({**tower, "name": f"in {folder.parent.name}"}))
    return home


def experiment(names=NAMES):
    return Experiment(name="few", suites=names, planners=[PlannerEntry("greedy")], budgets=[1, 0.5], instances=1)


def test_it_means_the_same_runs_after_all_sets_have_gone(home, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    planned = experiment_runs(experiment(), home)
    keep(experiment(), home, out)
    moved = shutil.move(out, tmp_path / "moved")
    shutil.rmtree(home)
    shutil.rmtree(tmp_path / "sets")
    again = experiment_runs(read_experiment(moved / "experiment.toml"), moved)
    assert [run.key for run in again] == [run.key for run in planned]
    assert len({run.key for run in again}) == 2 * len(NAMES)


def test_keeping_again_changes_nothing(home, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    keep(experiment(), home, out)
    before = {file: file.read_bytes() for file in sorted(out.rglob("*")) if file.is_file()}
    keep(read_experiment(out / "experiment.toml"), out, out, out / "experiment.toml")
    assert {file: file.read_bytes() for file in sorted(out.rglob("*")) if file.is_file()} == before


def test_an_experiment_without_a_file_is_written_as_one(tmp_path):
    entries = [
        PlannerEntry('greedy"', label="ü \\ \n"),
        PlannerEntry("smash", suites=["a b"], budgets=[1e-3], cutoff_sample=0),
    ]
    made = Experiment(name="x", suites=["é"], planners=entries, buffers=[0], memory=5)
    import tomllib

    from msgspec import convert

    assert convert(tomllib.loads(experiment_text(made)), Experiment) == made
    assert suites(made) == ["é", "a b"]


def test_committed_sets_are_named_not_copied(tmp_path):
    keep(experiment(["multi-4"]), tmp_path, tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["experiment.toml"]


@pytest.mark.parametrize("command", [pytest.param("compare", marks=pytest.mark.slow), "scaling"])
def test_comparisons_and_scaling_runs_can_be_checked(home, tmp_path, command):
    out = tmp_path / "out"
    more = [str(home / "my set")] if command == "compare" else ["--largest", "4", "--count", "1"]
    arguments = [command, *more, "--planner", "greedy", "--budget", "1", "--out", str(out)]
    ended = CliRunner().invoke(smash, arguments)
    assert ended.exit_code == 0, ended.output
    shutil.rmtree(home)
    checked = CliRunner().invoke(smash, ["records", "check", str(out)])
    assert "planned runs" in checked.stdout
    assert all(line.startswith("changed files") for line in checked.stderr.splitlines())
