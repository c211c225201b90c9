"""The greedy planner: a plan wherever one exists, at any size."""

import dataclasses
import math
from time import perf_counter

import pytest
from hypothesis import given, settings

from smash.planners.greedy import GreedyPlanner, GreedyRun, greedy_plans, greedy_steps, passes
from smash.planners.greedy.construct import Construction
from smash.planners.protocol import SolveOptions
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.sets.suites import read_suite
from smash.problem.views.numbered import cost_of
from tests.arrangements import wide
from tests.oracle import optimal_cost
from tests.strategies import EVERY_KIND, instances, plan_options


@settings(max_examples=300, deadline=None)
@given(instances(max_blocks=4, kinds=EVERY_KIND, hand=True), plan_options())
def test_finds_a_plan_exactly_where_one_exists(instance, options):
    best = optimal_cost(instance, options)
    result = GreedyPlanner().solve(instance, SolveOptions(options.topple, options.max_topple), 5)
    if best is None:
        assert result.status == "infeasible"
    else:
        assert result.cost is not None
        assert result.cost >= best
        assert result.status == ("optimal" if best == (instance.hand is not None) else "feasible")


@settings(max_examples=150, deadline=None)
@given(
    instances(max_blocks=4, max_stacks=2, max_buffers=0, odd_names=True, kinds=EVERY_KIND, hand=True), plan_options()
)
def test_one_and_two_locations_are_decided_like_exhaustive_search(instance, options):
    best = optimal_cost(instance, options)
    result = GreedyPlanner().solve(instance, SolveOptions(options.topple, options.max_topple), 5)
    assert (result.actions is None) == (best is None)


@pytest.mark.parametrize("topple", [True, False])
@pytest.mark.parametrize("suite", ["multi-9", "single-9", "open-few-buffers", "open-on", "open-positions", "open-wide"])
def test_every_committed_instance_gets_a_plan(suite, topple):
    for instance in read_suite(suite):
        assert GreedyPlanner().solve(instance, SolveOptions(topple), 2.0).actions is not None


@pytest.mark.parametrize(("topple", "counts"), [(True, (12, 1)), (False, (12,))])
def test_a_thousand_blocks_get_a_plan(topple, counts):
    instance = generate("multi", 1000)[0]
    for buffers in counts:
        cut = dataclasses.replace(
            instance,
            buffers=instance.buffers[:buffers],
            start={q: instance.start[q] for q in (*instance.stacks, *instance.buffers[:buffers])},
        )
        assert GreedyPlanner().solve(cut, SolveOptions(topple), 20.0).actions is not None


@pytest.mark.parametrize("patient", [True, False])
def test_past_the_deadline_there_is_the_first_pass_and_no_other(monkeypatch, patient):
    passes = []
    run = Construction.run
    monkeypatch.setattr(Construction, "run", lambda self, *first: passes.append(self) or run(self, *first))
    problem = Problem(generate("multi", 20, buffers=0)[0], PlanOptions(topple=False))
    (plan,) = greedy_steps(problem, perf_counter(), patient=patient)
    assert plan
    assert len(passes) == 1


def test_patient_passes_only_improve():
    problem = Problem(generate("multi", 20, buffers=0)[0], PlanOptions(topple=False))
    costs = [cost_of(steps) for steps in greedy_steps(problem, perf_counter() + 0.3, patient=True)]
    assert costs == sorted(set(costs), reverse=True)


def test_without_the_time_for_a_first_plan_there_is_none(monkeypatch):
    monkeypatch.setattr(passes, "GRACE", -math.inf)
    run = GreedyRun(Problem(wide(30, 4, 0), PlanOptions(topple=False)))
    assert list(run.plans(-math.inf)) == []
    monkeypatch.setattr(passes, "GRACE", 0.0)
    assert next(run.plans(-math.inf, first_until=math.inf)) is not None


def test_a_run_goes_on_where_it_was_stopped():
    problem = Problem(wide(40, 4, 1), PlanOptions(topple=False))
    run = GreedyRun(problem)
    found = list(run.plans(-math.inf, first_until=math.inf))
    assert run.seconds_left() > 0
    found += run.plans(math.inf)
    assert found == list(greedy_plans(problem, math.inf))
    assert run.seconds_left() == 0
    assert list(run.plans(math.inf)) == []


def test_a_long_first_plan_is_told_before_it_is_shortened(monkeypatch):
    monkeypatch.setattr("smash.planners.greedy.passes.LONG", 10)
    monkeypatch.setattr("smash.planners.greedy.passes.shorten", lambda steps, until: steps[:-1])
    problem = Problem(generate("multi", 20, buffers=0)[0], PlanOptions(topple=False))
    plans = greedy_steps(problem, math.inf)
    assert next(plans)[:-1] == next(plans)


def test_a_pass_that_is_given_up_is_made_again_when_there_is_time(monkeypatch):
    problem = Problem(wide(60, 4, 3, 0), PlanOptions(topple=False))
    whole = list(GreedyRun(problem).plans(math.inf))
    run = GreedyRun(problem)
    found = [next(run.plans(math.inf))]
    for looks in (3, 50, 90):
        with monkeypatch.context() as patch:
            clock = iter([0.0] * looks + [2.0] * 1000)
            patch.setattr("smash.planners.greedy.passes.perf_counter", lambda: 0.0)
            patch.setattr("smash.planners.greedy.construct.perf_counter", clock.__next__)
            found += run.plans(1.0)
    assert [*found, *run.plans(math.inf)] == whole


def test_a_long_first_plan_is_known_when_it_is_told(monkeypatch):
    monkeypatch.setattr(passes, "LONG", 0)
    run = passes._run_of(Problem(generate("multi", 9, seed=1)[0], PlanOptions()), 0)
    told = next(run.improving(math.inf, False, math.inf))
    assert run.best == told
    assert all(cost_of(steps) < cost_of(told) for steps in run.improving(math.inf, False, math.inf))
