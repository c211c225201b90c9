"""The solve loop: every solution reaches the log, what takes too long is left out, each stage leaves a note."""

import math
from time import perf_counter

import numpy as np
import pytest

from smash.planners.milp import solving
from smash.planners.milp.arrays import MilpBuilder
from smash.planners.milp.solving import Solving, Stage, whole
from smash.planners.protocol import Settings, SolveLog
from smash.problem import IllegalAction, Pick, Place, StacksGoal, make_instance
from smash.problem.problem import Problem

PLAN = (Pick("a", "s"), Place("a", "t"))


class Choice:
    """A model of one binary that costs 2 and is 1."""

    def __init__(self, until=math.inf):
        builder = MilpBuilder(until)
        column = builder.add_columns(1, cost=2)
        builder.add_row(column, 1.0, lower=1)
        self.milp = builder.build()


def new_log():
    instance = make_instance(name="x", blocks="a", stacks=["s", "t"], start={"s": "a"}, goal=StacksGoal({"t": ("a",)}))
    return SolveLog(Problem(instance))


def run(log, decode, seconds=10.0, **more):
    return Solving(Settings(), log, perf_counter() + seconds).run(Stage("choice", Choice, decode, **more))


def test_a_solution_is_read_and_offered_as_the_models():
    log = new_log()
    result = run(log, lambda model, vector: PLAN if vector[0] > 0.5 else None, horizon=3)
    assert (log.best, log.entries[-1].origin, result.status) == (PLAN, "milp", "optimal")
    (note,) = log.details["stages"]
    assert (note["model"], note["horizon"], note["status"], note["objective"], note["columns"]) == (
        "choice", 3, "optimal", 2.0, 1,
    )  # fmt: skip


def test_a_solution_that_is_no_plan_is_left_out_and_one_that_the_law_refuses_is_said():
    log = new_log()

    def refuse(model, vector):
        raise IllegalAction("no pile allows it")

    run(log, lambda model, vector: None)
    assert (log.best, log.refusals) == (None, [])
    run(log, refuse)
    assert log.best is None
    assert set(log.refusals) == {"milp: no pile allows it"}


def test_a_program_without_plans_is_only_solved():
    log = new_log()
    assert run(log, None).objective == pytest.approx(2)
    assert log.best is None


@pytest.mark.parametrize("late", ["estimate", "build"])
def test_what_takes_too_long_to_build_is_left_out(monkeypatch, late):
    log = new_log()
    if late == "build":
        monkeypatch.setattr(solving, "BUILD_SHARE", 0.0)
    assert run(log, None, estimate=100.0 if late == "estimate" else 0.0) is None
    assert "build" in log.details["stages"][0]["skipped"]


def test_a_start_is_handed_over_and_noted():
    log = new_log()
    run(log, lambda model, vector: PLAN, start=lambda model: np.ones(1))
    run(log, lambda model, vector: PLAN, start=lambda model: None)
    assert [note["started_from_a_plan"] for note in log.details["stages"]] == [True, False]


def test_it_is_done_where_the_log_is_settled_or_the_time_is_over():
    log = new_log()
    assert not Solving(Settings(), log, math.inf).done()
    assert Solving(Settings(), log, perf_counter()).done()
    log.offer(PLAN, "milp")
    log.prove(2, "milp")
    assert Solving(Settings(), log, math.inf).done()


@pytest.mark.parametrize(("bound", "proven"), [(4.0, 4), (4.0000001, 4), (4.1, 5), (3.2, 4), (math.inf, None)])
def test_bounds_on_whole_costs_are_rounded_up_but_for_the_solvers_tolerance(bound, proven):
    assert whole(bound) == proven
