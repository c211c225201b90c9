"""The batch script for Slurm says what the most demanding run needs, and how to go on."""

import re
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

from smash.cli import smash
from smash.experiments.sweeps.cluster import slurm_script
from smash.experiments.sweeps.experiment import experiment_runs, read_experiment

ROOT = Path(__file__).parents[2]
EXPERIMENT = """name = "few"
suites = ["multi-4"]
instances = 3
budgets = [600]
memory = 3000
[[planners]]
name = "greedy"
[[planners]]
name = "smash-layered"
threads = 2
"""


@pytest.fixture
def script(tmp_path):
    file = tmp_path / "it's few.toml"
    file.write_text(EXPERIMENT)
    return slurm_script(experiment_runs(read_experiment(file)), file, tmp_path / "out put", 4)


def directive(script, name):
    return re.search(rf"^#SBATCH --{name}=(.*)$", script, re.MULTILINE)[1]


def test_memory_cores_and_time_are_those_that_the_runs_need(script):
    assert directive(script, "ntasks") == "4"
    assert directive(script, "cpus-per-task") == "2"
    assert int(directive(script, "mem-per-cpu")[:-1]) * 2 >= 3000 + 1024
    hours = int(directive(script, "time").split(":")[0])
    assert 12 * 600 / 4 / 3600 + 600 / 3600 < hours <= 2


def test_it_starts_a_scheduler_the_workers_and_the_sweep_in_this_order(script):
    words = [script.index(word) for word in ("dask_scheduler", "dask_worker", "smash sweep")]
    assert words == sorted(words)
    assert "srun --ntasks=4" in script
    assert "--nthreads 1" in script


def test_it_is_a_shell_script_whatever_the_paths(script, tmp_path):
    (tmp_path / "job.sh").write_text(script)
    assert subprocess.run(["bash", "-n", tmp_path / "job.sh"], capture_output=True).stderr == b""


def test_the_command_writes_it_and_runs_nothing(tmp_path):
    (tmp_path / "few.toml").write_text(EXPERIMENT)
    arguments = ["sweep", str(tmp_path / "few.toml"), "--out", str(tmp_path / "out"), "--jobs", "3"]
    ended = CliRunner().invoke(smash, [*arguments, "--slurm-script", str(tmp_path / "job.sh")])
    assert ended.exit_code == 0, ended.output
    assert "12 runs with 3 workers" in ended.stdout
    assert directive((tmp_path / "job.sh").read_text(), "job-name") == "smash-few"
    assert list((tmp_path / "out").iterdir()) == []
