"""A sweep on a real local Dask cluster, two of whose workers are killed: every run is recorded exactly once."""

import json
import subprocess
import sys
import time

import pytest

from smash.experiments.records import RUNS

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("third_party")]


@pytest.fixture
def cluster(tmp_path):
    """Start a scheduler and three workers as processes, as on a cluster; workers start again when they die."""
    address = tmp_path / "scheduler.json"
    scheduler = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard"]
    started = [subprocess.Popen([*scheduler, "--scheduler-file", address], stderr=subprocess.DEVNULL)]
    while not address.exists():
        time.sleep(0.1)
    worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", address, "--nthreads", "1"]
    workers = [subprocess.Popen([*worker, "--no-nanny", "--no-dashboard"], stderr=subprocess.DEVNULL) for _ in range(3)]
    yield json.loads(address.read_text())["address"], workers
    for process in started + workers:
        process.kill()
        process.wait()


def test_killed_workers_lose_only_their_running_jobs(cluster, tower_file, tmp_path):
    address, workers = cluster
    suite = tmp_path / "suite"
    suite.mkdir()
    tower = json.loads(tower_file.read_text())
    for number in range(20):
        (suite / f"{number}.json").write_text(json.dumps({**tower, "name": f"tower-{number}"}))
    planners = "".join(f'[[planners]]\nname = "{name}"\n' for name in ("sound", "hangs-with-plan", "segfaults"))
    file = suite / "experiment.toml"
    file.write_text(f'name = "try"\nsuites = ["."]\nvariants = ["topple"]\nbudgets = [0.3]\n{planners}')
    out = tmp_path / "out"
    command = [sys.executable, "-m", "smash", "sweep", str(file), "--out", str(out), "--dask", address]
    running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    for worker, least in zip(workers[:2], (5, 15), strict=True):
        while not (out / RUNS).exists() or (out / RUNS).read_text().count("\n") < least:
            time.sleep(0.05)
        worker.kill()
    _, said = running.communicate(timeout=200)
    assert running.returncode == 0, said
    records = [json.loads(line) for line in (out / RUNS).read_text().splitlines()]
    assert len(records) == len({record["key"] for record in records}) == 60
    ends = {(record["planner"], record["outcome"]) for record in records}
    assert ends == {("sound", "optimal"), ("hangs-with-plan", "over-budget"), ("segfaults", "crashed")}
