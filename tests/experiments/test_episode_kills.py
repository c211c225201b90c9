"""Twenty kills at random moments of episodes on Dask: nothing recorded is lost, nothing twice, nothing left behind.

The victims are workers, the client (`smash episodes`), the scheduler, the fork servers, guardians and simulations. An
episode whose guardian or simulation was killed is recorded without one, and carried out again by `--redo`.
"""

import json
import subprocess
import sys
from functools import partial

import pytest

from smash.problem import write_instance
from smash.problem.extras import is_there
from smash.records.files import EPISODES
from tests.execution.episodes import swapped_pair
from tests.experiments.test_kills import Killer, cluster, disturbed_on_dask, gone, sweep, whole_lines

pytestmark = [
    pytest.mark.slow,
    pytest.mark.timeout(1800),
    pytest.mark.skipif(
        not (is_there("pybullet") and is_there("distributed")), reason="needs the extras execution and cluster"
    ),
]

SEEDS = 10


@pytest.fixture
def sweep_file(tmp_path, monkeypatch):
    """Write a sweep of one plan; all that runs here bears a mark and has its scratch folders here."""
    monkeypatch.setenv("MARKED", str(tmp_path))
    (tmp_path / "scratch").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "scratch"))
    (tmp_path / "set").mkdir()
    write_instance(swapped_pair(), tmp_path / "set" / "swapped.json")
    file = tmp_path / "small.toml"
    head = 'name = "small"\nsuites = ["set"]\nbudgets = [2.0]\nvariants = ["topple"]\n'
    file.write_text(head + '[[planners]]\nname = "greedy"\n')
    return file


def episodes(out, scheduler, *more):
    words = ["episodes", out, "--policy", "open", "--seeds", SEEDS, "--dask", scheduler, *more]
    command = [sys.executable, "-m", "smash", *map(str, words)]
    return subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)


def check_round(out, scheduler, seen):
    """Let a round end undisturbed, and look whether all is there, once, and nothing else."""
    for again in ((), ("--redo",)):
        running = episodes(out, scheduler, *again)
        _, said = running.communicate(timeout=600)
        assert running.returncode == 0, said
        assert "Traceback" not in said
    file = out / EPISODES.name
    assert seen <= whole_lines(file) | whole_lines(EPISODES.redone(out)), "an episode was lost"
    records = [json.loads(line) for line in file.read_text().splitlines()]
    assert sorted(record["seed"] for record in records) == list(range(SEEDS))
    assert len({record["key"] for record in records}) == SEEDS
    assert all(record["episode"]["success"] for record in records), [record["problem"] for record in records]


def test_twenty_kills_of_episodes_on_dask(sweep_file, tmp_path):
    kinds = {"worker": 6, "sweep": 5, "scheduler": 3, "guardian": 2, "planner": 2, "server": 2}
    killer = Killer(3, str(tmp_path), kinds)
    rounds = 0
    while killer.left:
        out, rounds = tmp_path / f"out-{rounds}", rounds + 1
        running = sweep(sweep_file, out)
        _, said = running.communicate(timeout=300)
        assert running.returncode == 0, said
        seen = disturbed_on_dask(tmp_path, rounds, out / EPISODES.name, killer, partial(episodes, out))
        with cluster(tmp_path, f"{rounds}-end") as scheduler:
            check_round(out, scheduler, seen)
        assert gone(tmp_path) == ([], [], [])
    told = {"client" if kind == "sweep" else kind: count for kind, count in killer.done.items()}
    print(f"{killer.done.total()} kills in {rounds} rounds of {SEEDS} episodes: {told}")
