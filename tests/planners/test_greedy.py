"""The greedy planner: a plan wherever one exists, at any size."""

import dataclasses
from time import perf_counter

import pytest
from hypothesis import given, settings

from smash.planners.greedy import GreedyPlanner, greedy_steps
from smash.planners.protocol import SolveOptions
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.sets.suites import read_suite
from smash.problem.views.numbered import cost_of
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options


@settings(max_examples=300, deadline=None)
@given(instances(max_blocks=4), plan_options())
def test_finds_a_plan_exactly_where_one_exists(instance, options):
    best = optimal_cost(instance, options)
    result = GreedyPlanner().solve(instance, SolveOptions(options.topple, options.max_topple), 5)
    if best is None:
        assert result.status == "infeasible"
    else:
        assert result.cost is not None
        assert result.cost >= best
        assert result.status == ("optimal" if best == 0 else "feasible")


@settings(max_examples=150, deadline=None)
@given(instances(max_blocks=4, max_stacks=2, max_buffers=0, odd_names=True), plan_options())
def test_one_and_two_locations_are_decided_like_exhaustive_search(instance, options):
    best = optimal_cost(instance, options)
    result = GreedyPlanner().solve(instance, SolveOptions(options.topple, options.max_topple), 5)
    assert (result.actions is None) == (best is None)


@pytest.mark.parametrize("topple", [True, False])
@pytest.mark.parametrize("suite", ["multi-9", "single-9", "open-few-buffers", "open-on", "open-positions", "open-wide"])
def test_every_committed_instance_gets_a_plan(suite, topple):
    for instance in read_suite(suite):
        assert GreedyPlanner().solve(instance, SolveOptions(topple), 0.2).actions is not None


@pytest.mark.parametrize("topple", [True, False])
def test_a_thousand_blocks_get_their_first_plan_within_seconds(topple):
    instance = next(generate("multi", 1000, 12, 1, 0))
    for buffers in (12, 1):
        cut = dataclasses.replace(
            instance,
            buffers=instance.buffers[:buffers],
            start={q: instance.start[q] for q in (*instance.stacks, *instance.buffers[:buffers])},
        )
        started = perf_counter()
        result = GreedyPlanner().solve(cut, SolveOptions(topple), 0.1)
        assert result.actions is not None
        assert perf_counter() - started < 20


def test_no_pass_is_begun_that_would_end_after_the_budget():
    instance = next(iter(generate("multi", 1000, buffers=2, count=1, seed=5)))
    began = perf_counter()
    first = next(iter(GreedyPlanner().solve(instance, SolveOptions(topple=False), 1e-9).incumbents))
    assert first.seconds <= perf_counter() - began < 3 * first.seconds + 0.5


def test_patient_passes_go_on_to_the_deadline_and_only_improve():
    problem = Problem(next(generate("multi", 20, 0, 1, 0)), PlanOptions(topple=False))
    started = perf_counter()
    costs = [cost_of(steps) for steps in greedy_steps(problem, started + 0.3, patient=True)]
    assert 0.1 < perf_counter() - started < 0.8
    assert costs == sorted(set(costs), reverse=True)
