"""The committed experiments and the documented one are good files."""

import re
from pathlib import Path

import pytest

from smash.experiments.sweeps.experiment import experiment_runs, read_experiment

ROOT = Path(__file__).parents[2]


EXPERIMENTS = [file for file in sorted((ROOT / "experiments").glob("*.toml")) if not file.stem.startswith("reproduce")]


@pytest.mark.parametrize("file", EXPERIMENTS, ids=lambda file: file.stem)
def test_a_committed_experiment_is_valid_and_named_after_its_file(file):
    experiment = read_experiment(file)
    assert experiment.name == file.stem
    assert experiment_runs(experiment, file.parent)


def test_the_documented_experiment_is_valid(tmp_path):
    example = re.search(r"```toml\n(.*?)```", (ROOT / "docs" / "experiments.md").read_text(), re.DOTALL)[1]
    (tmp_path / "few.toml").write_text(example)
    assert read_experiment(tmp_path / "few.toml").planners[1].warm_start == "greedy"
