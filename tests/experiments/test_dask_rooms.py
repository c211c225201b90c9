"""Whatever is recorded in a results directory goes over Dask like a sweep: episodes, topple maps, scaling."""

import json
import os
import subprocess
import sys
import time

import pytest

pytest.importorskip("distributed")

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory):
    """Start a scheduler on the loopback, and two workers without any folder of ours."""
    folder = tmp_path_factory.mktemp("cluster")
    file = folder / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0"]
    started = [subprocess.Popen([*dask, "--no-dashboard", "--scheduler-file", file], **quiet)]
    while not file.exists():
        time.sleep(0.1)
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", file, "--nworkers", "2"]
    local = ["--nthreads", "1", "--no-dashboard", "--memory-limit", "0", "--local-directory", folder / "local"]
    started.append(subprocess.Popen([*worker, *local], cwd=folder, **quiet))
    yield str(file)
    for process in reversed(started):
        process.terminate()
        process.wait()


def smash(*arguments):
    command = [sys.executable, "-m", "smash", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=200)


def lines(file):
    return [json.loads(line) for line in file.read_text().splitlines()]


def test_scaling_and_episodes_go_over_dask_and_are_done_once(scheduler, tmp_path):
    pytest.importorskip("pybullet")
    few = ("--planner", "greedy", "--largest", "4", "--count", "1", "--budget", "2", "--out", tmp_path)
    ended = smash("scaling", *few, "--dask", scheduler)
    assert ended.returncode == 0, ended.stderr
    assert len(lines(tmp_path / "runs.jsonl")) == 6
    asked = ("episodes", tmp_path, "--policy", "open", "--noise", "pose=1mm", "--dask", scheduler)
    ended = smash(*asked)
    assert ended.returncode == 0, ended.stderr
    made = lines(tmp_path / "episodes.jsonl")
    assert len({record["key"] for record in made}) == len(made) == 6
    assert all(record["episode"] and record["scene"] == "default pose=1mm" for record in made), ended.stderr
    before = (tmp_path / "episodes.jsonl").read_bytes()
    assert "0 left" in smash(*asked).stderr
    assert (tmp_path / "episodes.jsonl").read_bytes() == before


def test_trials_over_dask_are_those_made_here(scheduler, tmp_path):
    pytest.importorskip("pybullet")
    few = ("topple-map", "--highest-cut", "1", "--most", "2", "--seeds", "2")
    for out, more in (("there", ("--dask", scheduler)), ("here", ())):
        ended = smash(*few, "--out", tmp_path / out, *more)
        assert ended.returncode == 0, ended.stderr
    there, here = (sorted((tmp_path / out / "trials.jsonl").read_text().splitlines()) for out in ("there", "here"))
    assert len(there) == 4
    assert there == here


def test_best_known_runs_go_over_dask(scheduler, tmp_path):
    file = tmp_path / "open.toml"
    file.write_text(
        'name = "open"\nsuites = ["open-few-buffers"]\nbudgets = [1]\nvariants = ["topple"]\n'
        '[[planners]]\nname = "greedy"\n'
    )
    ended = smash("sweep", file, "--out", tmp_path / "runs", "--dask", scheduler)
    assert ended.returncode == 0, ended.stderr
    assert len(lines(tmp_path / "runs" / "runs.jsonl")) == 12
    ended = smash("best-known", "update", tmp_path / "runs", "--list", tmp_path / "list")
    assert (ended.returncode, ended.stdout.split(";")[0]) == (0, "12 improvements"), ended.stderr


def test_replays_are_made_here_alone(scheduler, tmp_path):
    pytest.importorskip("pybullet")
    ended = smash("episodes", tmp_path, "--replays", "--dask", scheduler)
    assert ended.returncode == 2
    assert "--replays goes with episodes here" in ended.stderr


def test_no_scheduler_there_is_one_line(tmp_path):
    pytest.importorskip("pybullet")
    address = f"tcp://127.0.0.1:{1 + os.getpid() % 1000}"
    ended = smash("topple-map", "--most", "1", "--out", tmp_path, "--dask", address)
    assert ended.returncode == 2
    assert ended.stderr.splitlines()[-1].startswith("smash: --dask")
    assert "Traceback" not in ended.stderr
