"""Workers that stand still are told from those that work, and from those that have nothing to do."""

import pytest

from smash.experiments.sweeps.standstill import SILENCE, Standstill

RUNS = {"a": ("run-1", "run-2"), "b": ("run-3",)}


def beats(a, b=None):
    return {"a": a, "b": a if b is None else b}


@pytest.fixture
def standstill():
    watch = Standstill(longest=100.0)
    assert watch.look(0.0, beats(7.0), RUNS) == {}
    return watch


def test_a_worker_of_which_nothing_is_heard_stands_still(standstill):
    assert standstill.look(SILENCE, beats(7.0, 9.0), RUNS) == {}
    still = standstill.look(SILENCE + 1, beats(7.0, 9.0), RUNS)
    assert list(still) == ["a"]
    assert "nothing heard" in still["a"]


def test_one_that_is_heard_works(standstill):
    for second in range(0, 90, 10):
        assert standstill.look(second, beats(7.0 + second), RUNS) == {}


def test_one_whose_runs_do_not_end_stands_still_though_it_is_heard(standstill):
    more = {**RUNS, "a": ("run-1", "run-2", "run-4")}
    assert standstill.look(99.0, beats(8.0), more) == {}
    assert set(standstill.look(101.0, beats(9.0), more)) == {"a", "b"}
    assert standstill.look(102.0, beats(10.0), more) == {}


def test_a_run_that_ends_gives_its_worker_time(standstill):
    assert standstill.look(99.0, beats(8.0), {"a": ("run-2",), "b": ("run-5",)}) == {}
    assert standstill.look(190.0, beats(9.0), {"a": ("run-2",), "b": ("run-5",)}) == {}


def test_one_without_runs_is_left_alone(standstill):
    assert standstill.look(300.0, beats(7.0), {}) == {}
