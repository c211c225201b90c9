"""The rows in the solver: fractions where they are allowed, whole columns where they are asked for, and back."""

import math

import numpy as np
import pytest

from smash.planners.precedence import relaxation
from smash.planners.precedence.relaxation import Relaxation

PAIRS = [frozenset({0, 1}), frozenset({1, 2}), frozenset({0, 2})]


@pytest.fixture
def triangle():
    """Three columns of which each two must have one."""
    relaxation = Relaxation(np.ones(3), 1)
    assert all(relaxation.add(row) for row in PAIRS)
    return relaxation


def test_fractions_before_and_after_whole_columns(triangle):
    assert triangle.solve(math.inf)
    assert triangle.objective == pytest.approx(1.5)
    bounds = []
    whole = triangle.solve_whole(math.inf, {0, 1, 2}, 0.999, bounds.append)
    assert whole.sum() == 2
    assert bounds[-1] > 1.0
    assert triangle.solve(math.inf)
    assert triangle.objective == pytest.approx(1.5)


def test_a_row_may_ask_for_more_than_before_and_never_for_less(triangle):
    assert triangle.add(frozenset({0, 1, 2}), 2)
    assert triangle.waiting
    triangle.solve(math.inf)
    assert not triangle.waiting
    assert triangle.objective == pytest.approx(2.0)
    assert not triangle.add(frozenset({0, 1, 2}), 1)
    assert not triangle.add(PAIRS[0])


def test_rows_that_are_exceeded_are_dropped_and_may_come_again(triangle):
    triangle.add(frozenset({0}))
    triangle.solve(math.inf)
    assert set(triangle.tight(0.1, 3)) >= {frozenset({0})}
    triangle.drop_slack(-0.5)  # every row
    assert triangle.tight(10.0, 3) == []
    triangle.add(PAIRS[1])
    triangle.solve(math.inf)
    assert triangle.objective == pytest.approx(1.0)
    assert triangle.tight(0.1, 3) == [PAIRS[1]]


def test_a_linear_program_begins_from_the_one_before_where_rows_were_added_and_dropped(triangle):
    triangle.add(frozenset({0}))
    triangle.solve(math.inf)
    triangle.drop_slack(0.2)
    triangle.add(frozenset({0, 1, 2}))  # says nothing new
    triangle.solve(math.inf)
    assert triangle._model.getInfo().simplex_iteration_count == 0
    assert triangle.objective == pytest.approx(2.0)


@pytest.mark.parametrize("seed", range(5))
def test_step_by_step_the_optimum_is_the_one_of_all_rows_at_once(seed):
    draw = np.random.default_rng(seed)
    costs = draw.integers(1, 4, 30).astype(float)
    rows = [frozenset(draw.choice(30, 6, replace=False).tolist()) for _ in range(60)]
    steps, whole = Relaxation(costs, 1), Relaxation(costs, 1)
    for begin in range(0, 60, 10):
        for row in rows[begin : begin + 10]:
            steps.add(row, 2)
        steps.solve(math.inf)
        steps.drop_slack(0.5)
    for row in rows:
        whole.add(row, 2)
        steps.add(row, 2)
    assert steps.solve(math.inf)
    assert whole.solve(math.inf)
    assert steps.objective == pytest.approx(whole.objective)


def test_past_the_deadline_nothing_is_solved(triangle):
    assert not triangle.solve(-math.inf)
    assert triangle.solve_whole(-math.inf, {0, 1, 2}, 0.999, lambda bound: None) is None


def test_earlier_runs_take_nothing_off_the_time_of_a_later_one(triangle, monkeypatch):
    while triangle._model.getRunTime() < 0.01:
        assert triangle.solve(math.inf)
    before = triangle._model.getRunTime()
    monkeypatch.setattr(relaxation, "perf_counter", lambda: 0.0)
    assert triangle.solve(100.0)
    assert triangle._model.getOptionValue("time_limit")[1] == 100.0 + before
