"""The plan that sorts: legal at once on three locations or more, and short where digging is long."""

from time import perf_counter

import pytest
from hypothesis import assume, given, settings

from smash.planners.greedy import GreedyRun, greedy_steps
from smash.planners.greedy.construct import Construction
from smash.planners.greedy.sorting import sorted_steps
from smash.problem import Law, PlanOptions
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.views.numbered import Numbered, cost_of
from smash.problem.views.targets import target_piles
from tests.strategies import instances

WITHOUT = PlanOptions(topple=False)


def problem_of(blocks, stacks, buffers):
    return Problem(generate("multi", blocks, stacks=stacks, buffers=buffers, seed=5)[0], WITHOUT)


def steps_of(problem):
    return sorted_steps(problem.numbered, target_piles(problem.numbered, falls=False))


@settings(max_examples=100, deadline=None)
@given(instances(max_blocks=8))
def test_every_goal_is_reached(instance):
    problem = Problem(instance, WITHOUT)
    assume(problem.infeasible is None and problem.numbered.locations > 2)
    steps = steps_of(problem)
    if steps is not None:
        assert Law(instance, WITHOUT).check(problem.numbered.actions(steps)).accepted


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("stacks", "buffers"), [(3, 0), (4, 0), (3, 2), (9, 1)])
def test_a_plan_of_few_locations_is_legal(stacks, buffers, seed):
    instance = generate("multi", 60, stacks=stacks, buffers=buffers, seed=seed)[0]
    steps = steps_of(Problem(instance, WITHOUT))
    assert Law(instance, WITHOUT).check(Numbered.of(instance).actions(steps)).accepted


def test_two_locations_are_refused():
    with pytest.raises(ValueError, match="three locations"):
        sorted_steps(problem_of(6, 2, 0).numbered, ((), ()))


@pytest.mark.parametrize(("stacks", "buffers", "most"), [(3, 0, 24_000), (3, 2, 16_000), (10, 2, 12_000)])
def test_two_thousand_blocks_take_few_transfers(stacks, buffers, most):
    assert len(steps_of(problem_of(2000, stacks, buffers))) < most


def test_a_first_plan_of_few_locations_is_there_though_the_time_is_over():
    problem = problem_of(2000, 3, 2)
    first = next(GreedyRun(problem).plans(perf_counter() - 1.0))
    assert problem.law.check(first).accepted


def test_a_pass_that_gets_far_longer_than_the_sorting_plan_is_given_up(monkeypatch):
    tried = []
    run = Construction.run

    def noted(self, first=(), deadline=float("inf"), most_steps=float("inf")):
        tried.append((run(self, first, deadline, most_steps), len(self.steps), most_steps))
        return tried[-1][0]

    monkeypatch.setattr(Construction, "run", noted)
    plans = list(greedy_steps(problem_of(600, 3, 2), perf_counter() + 60, patient=True))
    assert [cost_of(steps) for steps in plans] == sorted({cost_of(steps) for steps in plans}, reverse=True)
    ((given_up, steps, most),) = tried
    assert given_up is None
    assert most < steps < 1.1 * most


def test_few_blocks_are_planned_as_ever():
    problem = problem_of(60, 3, 2)
    plans = list(greedy_steps(problem, perf_counter() + 60))
    assert plans[0] != steps_of(problem)
