"""A hundred kills at random moments: nothing recorded is lost, nothing is recorded twice, nothing is left behind.

The victims are a sweep, its fork server, guardians, planners; on Dask its workers, the scheduler, the client too. What
a killed guardian or planner was at is recorded as `crashed`, and done again by `--redo crashed`.
"""

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import contextmanager, suppress
from functools import partial

import psutil
import pytest

from smash.records.files import RUNS

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("third_party"), pytest.mark.timeout(1800)]

ENDS = {"hangs-with-plan": "over-budget", "sound": "optimal", "leaves-shared-memory": "feasible", "bare": "feasible"}
INSTANCES = 8
SERVER = "isolation.server import main"


@pytest.fixture
def experiment(tower_file, tmp_path, monkeypatch):
    """Write an experiment of short runs; all that runs here bears a mark and has its scratch folders here."""
    monkeypatch.setenv("MARKED", str(tmp_path))
    (tmp_path / "scratch").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "scratch"))
    suite = tmp_path / "suite"
    suite.mkdir()
    tower = json.loads(tower_file.read_text())
    for number in range(INSTANCES):
        (suite / f"{number}.json").write_text(json.dumps({**tower, "name": f"tower-{number}"}))
    file = suite / "experiment.toml"
    head = 'name = "try"\nsuites = ["."]\nvariants = ["topple"]\nbudgets = [0.8]\n'
    file.write_text(head + "".join(f'[[planners]]\nname = "{planner}"\n' for planner in ENDS))
    return file


def ours(mark):
    """Return the processes that bear the mark: (process, command line), by process id."""
    found = {}
    for process in psutil.process_iter():
        with suppress(psutil.Error, OSError):
            if process.environ().get("MARKED") == mark and process.status() != psutil.STATUS_ZOMBIE:
                found[process.pid] = process, " ".join(process.cmdline())
    return found


def victims(mark):
    """Return what may be killed: kind -> process ids."""
    found, kinds = ours(mark), {}
    parent = {}
    for number, (process, _) in found.items():
        with suppress(psutil.Error):
            parent[number] = process.ppid()
    for number, (_, words) in found.items():
        above = parent.get(number)
        if SERVER in words:
            depth = 0
            while above in found and SERVER in found[above][1] and depth < 2:
                above, depth = parent.get(above), depth + 1
            kinds.setdefault(("server", "guardian", "planner")[depth], []).append(number)
        elif "dask_scheduler" in words:
            kinds.setdefault("scheduler", []).append(number)
        elif "smash sweep" in words or "smash episodes" in words:
            kinds.setdefault("sweep", []).append(number)
        elif "multiprocessing" in words and "spawn_main" in words:
            kinds.setdefault("worker", []).append(number)
    return kinds


def leftovers(tmp_path):
    """Return the processes, folders and shared memory that nothing should have left."""
    folders = [file.name for file in (tmp_path / "scratch").iterdir() if file.name.startswith("smash-run-")]
    shared = [name for name in os.listdir("/dev/shm") if name.startswith("psm_")]
    return [words for _, words in ours(str(tmp_path)).values() if "pytest" not in words], folders, shared


def gone(tmp_path, seconds=30.0):
    """Wait until nothing is left; return what is."""
    until = time.monotonic() + seconds
    while any(left := leftovers(tmp_path)) and time.monotonic() < until:
        time.sleep(0.2)
    return left


def whole_lines(file):
    lines = file.read_text().splitlines(keepends=True) if file.exists() else []
    return {line for line in lines if line.endswith("\n")}


class Killer:
    """Kills at random moments, each kind in turn, and counts."""

    def __init__(self, seed, mark, kinds):
        self.chance = random.Random(seed)
        self.mark = mark
        self.left = [kind for kind, count in kinds.items() for _ in range(count)]
        self.chance.shuffle(self.left)
        self.done = Counter()

    def strike(self, running):
        """Kill the next victim at a random moment once there is one; return its kind, or None where none comes."""
        kind, until = self.left[0], time.monotonic() + 30
        while running.poll() is None and time.monotonic() < until:
            if kind in victims(self.mark):
                time.sleep(self.chance.uniform(0.0, 1.5))
                there = victims(self.mark).get(kind)
                if there:
                    with suppress(ProcessLookupError):
                        os.kill(self.chance.choice(there), signal.SIGKILL)
                        self.done[self.left.pop(0)] += 1
                        return kind
            time.sleep(0.05)
        return None


def sweep(file, out, *more):
    words = [sys.executable, "-m", "smash", "sweep", file, "--out", out, "--jobs", 2, *more]
    return subprocess.Popen([*map(str, words)], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)


def check_round(file, out, seen, *more):
    """Let a round end undisturbed, and look whether all is there, once, and nothing else."""
    for again in ((), ("--redo", "crashed")):
        running = sweep(file, out, *again, *more)
        _, said = running.communicate(timeout=300)
        assert running.returncode == 0, said
        assert "Traceback" not in said
    kept = whole_lines(out / RUNS.name) | whole_lines(out / "runs.redone")
    assert seen <= kept, "a record was lost"
    records = [json.loads(line) for line in (out / RUNS.name).read_text().splitlines()]
    assert len({record["key"] for record in records}) == len(records) == INSTANCES * len(ENDS)
    assert {(record["planner"], record["outcome"]) for record in records} == set(ENDS.items())


def ended(running):
    """Return how a sweep ended: well, killed, or with runs lost to dead workers or to a dead scheduler."""
    _, said = running.communicate(timeout=300)
    assert running.returncode in (0, -signal.SIGKILL, 2, 7), said
    assert "Traceback" not in said
    return running.returncode


def disturbed(file, killer, start):
    """Start a sweep again and again while the killer is at work, until it is done or its scheduler is killed.

    Returns:
        The records seen meanwhile, and whether it was done.
    """
    seen, running = set(), start()
    while killer.left:
        kind = killer.strike(running)
        seen |= whole_lines(file)
        if kind == "scheduler":
            break
        if kind == "sweep":
            running.wait()
        if running.poll() is not None:
            if ended(running) == 0:
                return seen, True
            running = start()
    return seen, ended(running) == 0


@pytest.mark.parametrize(("seed", "each"), [(1, 15)])
def test_sixty_kills_of_a_sweep_and_its_processes(experiment, tmp_path, seed, each):
    killer = Killer(seed, str(tmp_path), dict.fromkeys(("sweep", "server", "guardian", "planner"), each))
    rounds = 0
    while killer.left:
        out, rounds = tmp_path / f"out-{rounds}", rounds + 1
        seen, _ = disturbed(out / RUNS.name, killer, lambda out=out: sweep(experiment, out))
        check_round(experiment, out, seen)
        assert gone(tmp_path) == ([], [], [])
    print(f"{killer.done.total()} kills in {rounds} sweeps: {dict(killer.done)}")


@contextmanager
def cluster(tmp_path, number):
    """A scheduler and workers under a nanny; whatever dies, what is left of it ends with the context."""
    file = tmp_path / f"scheduler-{number}.json"

    def start(*words):
        words = [sys.executable, "-m", *map(str, words)]
        return subprocess.Popen(words, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)

    asked = ("--host", "127.0.0.1", "--port", 0, "--no-dashboard", "--scheduler-file", file)
    scheduler = start("distributed.cli.dask_scheduler", *asked)
    while not (file.exists() and file.stat().st_size):
        time.sleep(0.05)
    how = ("--nworkers", 2, "--nthreads", 1, "--memory-limit", 0, "--death-timeout", 60)
    where = ("--scheduler-file", file, "--no-dashboard", "--local-directory", tmp_path / "local")
    # Where a worker is killed before it is up, its nanny gives up: what starts workers starts them again.
    ever = ["bash", "-c", 'while :; do "$@"; sleep 0.2; done', "bash", sys.executable, "-m"]
    nothing = {"stderr": subprocess.DEVNULL, "stdout": subprocess.DEVNULL}
    words = [*ever, "distributed.cli.dask_worker", *map(str, (*how, *where))]
    workers = subprocess.Popen(words, start_new_session=True, **nothing)
    try:
        yield file
    finally:
        os.killpg(workers.pid, signal.SIGKILL)
        scheduler.kill()
        workers.wait()
        scheduler.wait()


def disturbed_on_dask(folder, name, file, killer, start):
    """Disturb what `start` starts at a scheduler, on cluster after cluster, until it is done; return the lines seen."""
    seen, done = set(), False
    while killer.left and not done:
        with cluster(folder, f"{name}-{len(killer.left)}") as scheduler:
            more, done = disturbed(file, killer, partial(start, scheduler))
            seen |= more
        assert gone(folder) == ([], [], [])
    return seen


def test_forty_kills_on_dask(experiment, tmp_path):
    kinds = {"worker": 12, "sweep": 10, "scheduler": 4, "guardian": 6, "planner": 4, "server": 4}
    killer = Killer(2, str(tmp_path), kinds)
    rounds = 0
    while killer.left:
        out, rounds = tmp_path / f"out-{rounds}", rounds + 1
        seen = disturbed_on_dask(
            tmp_path, rounds, out / RUNS.name, killer, lambda where, out=out: sweep(experiment, out, "--dask", where)
        )
        with cluster(tmp_path, f"{rounds}-end") as scheduler:
            check_round(experiment, out, seen, "--dask", scheduler)
        assert gone(tmp_path) == ([], [], [])
    print(f"{killer.done.total()} kills in {rounds} sweeps: {dict(killer.done)}")
