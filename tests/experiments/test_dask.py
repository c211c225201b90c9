"""A sweep on a real local Dask cluster: the same records as in one process, whatever dies on the way."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import suppress

import psutil
import pytest

from smash.records.files import RUNS
from tests.experiments.tables import tables

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("third_party"), pytest.mark.timeout(600)]


def start(*arguments):
    return subprocess.Popen([sys.executable, "-m", *arguments], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)


@pytest.fixture
def cluster(tmp_path, monkeypatch):
    """Start a scheduler and three workers, each a process of its own under a nanny that starts it anew."""
    monkeypatch.setenv("STARTS", str(tmp_path / "starts"))
    file = str(tmp_path / "scheduler.json")
    scheduler = start("distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", file)
    while not os.path.exists(file):
        time.sleep(0.1)
    local = ("--no-dashboard", "--local-directory", str(tmp_path / "local"))
    worker = ("distributed.cli.dask_worker", "--scheduler-file", file, "--nworkers", "3", "--nthreads", "1", *local)
    nannies = start(*worker)
    yield file, scheduler
    for process in (nannies, scheduler):
        process.terminate()
        process.wait()


@pytest.fixture
def experiment(tower_file, tmp_path):
    """Write an experiment of 200 short runs: 80 instances with and without topple, and 40 that end in trouble."""
    suite = tmp_path / "suite"
    suite.mkdir()
    tower = json.loads(tower_file.read_text())
    for number in range(80):
        name = "tower-" + "x" * (number % 3) + str(number)
        (suite / f"{number:02}.json").write_text(json.dumps({**tower, "name": name}))
    file = suite / "experiment.toml"
    file.write_text(
        'name = "try"\nsuites = ["."]\nbudgets = [0.5]\n[[planners]]\nname = "notes-starts"\nvariants = ["topple"]\n'
        '[[planners]]\nname = "notes-starts"\nlabel = "again"\nthreads = 2\nvariants = ["topple"]\n'
        '[[planners]]\nname = "segfaults"\ninstances = 20\nvariants = ["topple"]\n'
        '[[planners]]\nname = "hangs-with-plan"\ninstances = 20\nvariants = ["topple"]\n'
    )
    return file


def command(file, out, *more):
    return [sys.executable, "-m", "smash", "sweep", str(file), "--out", str(out), *more]


def records(out):
    return [json.loads(line) for line in (out / RUNS.name).read_text().splitlines()]


def worker_processes(scheduler):
    from distributed import Client

    with Client(scheduler_file=scheduler, timeout=15) as client:
        return sorted(client.run(os.getpid).values())


def test_two_killed_workers_lose_only_what_they_were_running(cluster, experiment, tmp_path):
    scheduler, _ = cluster
    out, chance = tmp_path / "out", random.Random(6)
    with open(tmp_path / "said", "w") as said:
        running = subprocess.Popen(command(experiment, out, "--dask", scheduler), stderr=said)
        for least in sorted(chance.sample(range(5, 190), 2)):
            while not (out / RUNS.name).exists() or (out / RUNS.name).read_text().count("\n") < least:
                time.sleep(0.05)
                assert running.poll() is None
            os.kill(chance.choice(worker_processes(scheduler)), signal.SIGKILL)
        assert running.wait(timeout=400) == 0, (tmp_path / "said").read_text()
    made = records(out)
    assert len(made) == len({record["key"] for record in made}) == 200
    begun = Counter((tmp_path / "starts").read_text().splitlines())
    assert len(begun) == 80
    assert 160 <= begun.total() <= 162
    alone = tmp_path / "alone"
    assert subprocess.run(command(experiment, alone, "--jobs", "2"), stderr=subprocess.DEVNULL).returncode == 0
    assert tables(out) == tables(alone)


def test_a_worker_that_stands_still_is_found_and_its_run_done_elsewhere(cluster, experiment, tmp_path):
    scheduler, _ = cluster
    out = tmp_path / "out"
    running = subprocess.Popen(command(experiment, out, "--dask", scheduler), stderr=subprocess.PIPE, text=True)
    while not (out / RUNS.name).exists() or (out / RUNS.name).read_text().count("\n") < 5:
        time.sleep(0.05)
    frozen = worker_processes(scheduler)[0]
    os.kill(frozen, signal.SIGSTOP)
    _, said = running.communicate(timeout=300)
    assert running.returncode == 0, said
    assert said.count("stands still (nothing heard of it for 30 s): its runs go to others") == 1
    made = records(out)
    assert len(made) == len({record["key"] for record in made}) == 200
    assert 160 <= len((tmp_path / "starts").read_text().splitlines()) <= 161
    assert not psutil.pid_exists(frozen)


def test_a_scheduler_that_dies_loses_no_record_and_is_one_line(cluster, experiment, tmp_path):
    scheduler, process = cluster
    out = tmp_path / "out"
    running = subprocess.Popen(command(experiment, out, "--dask", scheduler), stderr=subprocess.PIPE, text=True)
    while not (out / RUNS.name).exists() or (out / RUNS.name).read_text().count("\n") < 5:
        time.sleep(0.05)
    process.kill()
    _, said = running.communicate(timeout=120)
    assert running.returncode == 7
    assert said.splitlines()[-1].startswith("smash: ")
    assert "start again to do them" in said.splitlines()[-1]
    assert "Traceback" not in said
    assert len(records(out)) >= 5


def test_a_scheduler_that_is_stopped_is_given_up_and_loses_no_record(cluster, experiment, tmp_path):
    scheduler, process = cluster
    out = tmp_path / "out"
    running = subprocess.Popen(command(experiment, out, "--dask", scheduler), stderr=subprocess.PIPE, text=True)
    while not (out / RUNS.name).exists() or (out / RUNS.name).read_text().count("\n") < 5:
        time.sleep(0.05)
    process.send_signal(signal.SIGSTOP)
    try:
        _, said = running.communicate(timeout=200)
    finally:
        process.send_signal(signal.SIGCONT)
    assert running.returncode == 7
    assert "the scheduler stands still: no answer of it for 60 s" in said.splitlines()[-1]
    assert "Traceback" not in said
    assert len(records(out)) >= 5


def test_the_batch_script_runs_the_sweep_where_slurm_is_a_stand_in(experiment, tmp_path, monkeypatch):
    monkeypatch.setenv("STARTS", str(tmp_path / "starts"))
    experiment.write_text(
        'name = "try"\nsuites = ["."]\ninstances = 4\nbudgets = [0.5]\n[[planners]]\nname = "sound"\n'
    )
    script, out = tmp_path / "job.sh", tmp_path / "out put"
    asked = command(experiment, out, "--slurm-script", str(script), "--jobs", "2")
    assert subprocess.run(asked, stdout=subprocess.DEVNULL).returncode == 0
    stand_in = tmp_path / "bin" / "srun"
    stand_in.parent.mkdir()
    stand_in.write_text('#!/bin/bash\nwhile [[ $1 == -* ]]; do shift; done\n"$@" &\n"$@" &\nwait\n')
    stand_in.chmod(0o755)
    path = {**os.environ, "PATH": f"{stand_in.parent}:{os.environ['PATH']}"}
    running = subprocess.Popen(["bash", script], env=path, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while not (address := scheduler_address(out)):
        time.sleep(0.05)
        assert running.poll() is None, running.stderr.read()
    assert address.startswith("tls://")
    stranger = command(experiment, tmp_path / "stranger", "--dask", address)
    refused = subprocess.run(stranger, capture_output=True, text=True, timeout=100)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    _, said = running.communicate(timeout=100)
    assert running.returncode == 0, said
    assert len(records(out)) == 8
    assert not [file.name for file in out.iterdir() if file.name.startswith(("tls-", "scheduler-"))]


def scheduler_address(out):
    """Return what the file of a scheduler says, once it is there and whole."""
    for file in out.glob("scheduler-*.json"):
        with suppress(ValueError, OSError):
            return json.loads(file.read_text())["address"]
    return ""
