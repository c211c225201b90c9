"""The scaling benchmark: the same instances each time, each planner as far as it answers, exponents from records."""

import math

import pandas as pd
import pytest
from click.testing import CliRunner
from smash_analysis.scaling import exponent, make, scaling_chart

from smash.cli.scaling import command
from smash.experiments.studies.scaling import LARGEST, scaling_experiment, write_scaling_suites
from smash.experiments.sweeps.experiment import check_experiment, experiment_runs


def test_the_same_seed_writes_the_same_instances(tmp_path):
    for name in ("a", "b"):
        write_scaling_suites(tmp_path / name, 25, 2, 1)
    files = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*.json"))
    assert len(files) == 10
    assert all((tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes() for file in files)


def test_a_planner_is_not_run_beyond_its_size(tmp_path):
    experiment = scaling_experiment(write_scaling_suites(tmp_path, 25, 1, 1), ["precedence", "astar"], 1.0)
    check_experiment(experiment)
    runs = experiment_runs(experiment, tmp_path)
    assert max(len(run.job.instance.blocks) for run in runs if run.job.planner == "astar") == LARGEST["astar"]
    assert {len(run.job.instance.buffers) for run in runs if run.suite == "0025-blocks-5-stacks"} == {0, 12, 25}


def test_exponents_are_slopes_on_log_axes():
    sizes = [10.0, 20.0, 40.0, 80.0]
    assert exponent(sizes, [size**1.5 for size in sizes]) == pytest.approx(1.5)
    assert math.isnan(exponent(sizes, [1.0, 2.0, math.nan, math.nan]))


def cells():
    """Two planners on three sizes, one of which proves nothing."""
    rows = [("greedy", blocks, math.nan) for blocks in (4, 100, 10_000)] + [("smash", 4, 0.1), ("smash", 9, 0.2)]
    table = pd.DataFrame(rows, columns=["label", "blocks", "proof_seconds"])
    return table.assign(variant="topple", room="0")


def test_every_panel_shows_the_same_sizes_and_names_only_who_has_a_curve():
    chart = scaling_chart(cells(), "proof_seconds")
    assert [curve.name for curve in chart.legend] == ["smash"]
    (axis,) = chart.figure().axes
    assert axis.get_xlim()[0] < 4 < 10_000 < axis.get_xlim()[1]


@pytest.mark.slow
def test_the_benchmark_runs_from_instances_to_curves(tmp_path):
    arguments = ["--planner", "precedence", "--largest", "4", "--count", "1", "--budget", "5", "--out", str(tmp_path)]
    ended = CliRunner().invoke(command, arguments)
    assert ended.exit_code == 0, ended.output
    files = make(tmp_path, tmp_path / "scaling")
    assert all(file.stat().st_size > 0 for file in files)
    assert "precedence" in (tmp_path / "scaling" / "scaling.md").read_text()
