"""A worker that cannot do a run names itself, and another does it; a scheduler that stands still is not waited for."""

import threading
import time
from concurrent.futures import CancelledError
from types import SimpleNamespace

import pytest

pytest.importorskip("distributed")

from distributed import Client, LocalCluster, get_worker

from smash.experiments.sweeps import standstill
from smash.experiments.sweeps.cluster_executor import ClusterExecutor
from smash.problem.errors import SmashError


@pytest.fixture(scope="module")
def client():
    """Two workers in this process."""
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        yield client


def planned_unless(run, lacking):
    here = get_worker().address
    if here in lacking:
        raise SmashError(f"no planner is called {run!r}")
    return here


def test_runs_go_where_they_can_be_done_and_the_others_name_themselves(client):
    lacking, other = sorted(client.nthreads())
    said = []
    executor = ClusterExecutor(client, said.append)
    futures = [executor.submit(planned_unless, f"mine-{number % 2}", lacking=[lacking]) for number in range(8)]
    assert {future.result(timeout=30) for future in futures} == {other}
    assert all(words.startswith(f"worker {lacking} cannot do a run (no planner is called 'mine-") for words in said)
    assert len(said) == len(set(said))


def test_a_planner_that_is_not_installed_there_is_no_outcome_of_its_run(client):
    answer = SimpleNamespace(outcome="not-installed", reason="planner 'x' is not installed")
    executor = ClusterExecutor(client, lambda _: None)
    with pytest.raises(RuntimeError, match="no worker can do them: planner 'x' is not installed"):
        executor.submit(lambda run: answer, "run").result(timeout=30)


def test_another_error_is_the_runs_own(client):
    with pytest.raises(ZeroDivisionError):
        ClusterExecutor(client, print).submit(lambda run: run / 0, 1).result(timeout=30)


def test_what_is_cancelled_or_given_up_is_not_waited_for(client):
    executor = ClusterExecutor(client, print)
    futures = [executor.submit(time.sleep, 0.3) for _ in range(4)]
    futures[-1].cancel()
    executor.give_up("the scheduler stands still")
    for future in futures[:-1]:
        with pytest.raises(ConnectionError, match="stands still"):
            future.result(timeout=5)
    with pytest.raises(CancelledError):
        futures[-1].result(timeout=5)


def test_a_scheduler_that_does_not_answer_is_given_up_by_the_clients_own_clock(monkeypatch):
    monkeypatch.setattr(standstill, "_LOOKING", 0.01)
    monkeypatch.setattr(standstill, "SCHEDULERS_SILENCE", 0.1)

    def no_answer(question, **how):
        raise TimeoutError

    given_up, said = threading.Event(), []

    def give_up(words):
        said.append(words)
        given_up.set()

    stopped = SimpleNamespace(sync=no_answer, scheduler=SimpleNamespace(identity=None, processing=None))
    with standstill.watched(stopped, 100.0, print, give_up):
        assert given_up.wait(20)
    assert said[0].startswith("the scheduler stands still")
