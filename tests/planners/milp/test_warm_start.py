"""The warm start: plans of another planner under its name, none of its proofs, and no problem that it does not take."""

from time import perf_counter

import pytest

from smash.planners.milp.warm_start import warm_starts
from smash.planners.protocol import PlanResult, Settings, SolveLog
from smash.planners.registry import UnknownPlanner
from smash.problem import Pick, Place, StacksGoal, make_instance
from smash.problem.problem import Problem

PLAN = (Pick("a", "s"), Place("a", "t"))


def problem(**more):
    goal = StacksGoal({"t": ("a",)})
    return Problem(make_instance(name="x", blocks="a", stacks=["s", "t"], start={"s": "a"}, goal=goal, **more))


class Outsider:
    """A planner from outside, which reports no incumbents."""

    asked = None

    def solve(self, instance, options, budget, on_incumbent=None):
        Outsider.asked = options, budget
        return PlanResult("optimal", PLAN, 2, "outsider")


@pytest.fixture
def outsider(monkeypatch):
    monkeypatch.setattr("smash.planners.milp.warm_start.get_planner", lambda name: Outsider())


def test_a_cold_model_has_none():
    assert warm_starts(Settings(), 0.1) == ()


def test_plans_are_taken_under_the_others_name_and_proofs_are_not():
    (method,) = warm_starts(Settings(warm_start="astar"), 0.1)
    log = SolveLog(problem())
    assert method.takes(log.problem) is None
    method.run(log.problem, log, perf_counter() + 5)
    assert (log.cost, log.entries[0].origin, log.bound) == (2, "astar", None)


@pytest.mark.usefixtures("outsider")
def test_a_planner_that_reports_nothing_is_taken_at_its_answer_and_starts_cold():
    (method,) = warm_starts(Settings(warm_start="outsider", horizon=3, seed=7), 0.1)
    log = SolveLog(problem())
    method.run(log.problem, log, perf_counter() - 1)
    assert (log.best, log.entries[0].origin, log.bound) == (PLAN, "outsider", None)
    options, budget = Outsider.asked
    assert (options.warm_start, options.horizon, options.seed) == (None, None, 7)
    assert budget > 0


@pytest.mark.usefixtures("outsider")
def test_a_problem_that_the_other_does_not_take_goes_without():
    (method,) = warm_starts(Settings(warm_start="outsider"), 0.1)
    assert "lift" in method.takes(problem(capacities={"lift": 2}))


def test_an_unknown_planner_is_an_error():
    (method,) = warm_starts(Settings(warm_start="nobody"), 0.1)
    with pytest.raises(UnknownPlanner):
        method.takes(problem())
