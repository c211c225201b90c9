"""Neighbourhood search: legal plans that only get better, of every goal kind, never below the optimum."""

import math
import random
from time import perf_counter

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from smash.planners.greedy import greedy_steps
from smash.planners.neighbourhood import NeighbourhoodSearch, search
from smash.planners.neighbourhood.arms import Arm
from smash.problem import PlanOptions, make_instance
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.sets.open_instances import Shape, draw_instance
from smash.problem.views.numbered import cost_of
from tests.oracle import optimal_cost
from tests.planners.neighbourhood.wandering import verdict_on, wandering_plan
from tests.strategies import EVERY_KIND, instances, plan_options

pytestmark = pytest.mark.usefixtures("machine_code")


class Stopped(NeighbourhoodSearch):
    """One that stops after so many neighbourhoods."""

    tries = 100

    def _window(self, arm, deadline):
        return super()._window(arm, self._until(deadline))

    def _tail(self, arm, deadline):
        return super()._tail(arm, self._until(deadline))

    def _until(self, deadline):
        if self.tried >= self.tries:
            self._arms = []
        return deadline


def improved(problem, steps, seed=0, tries=100):
    """Return the better plans that come of so many neighbourhoods of a plan, and the last plan in hand."""
    searching = Stopped(problem, seed)
    searching.tries = tries
    searching.take(steps)
    plans = []
    while (better := searching.run(math.inf)) is not None:
        plans.append(better)
    return plans, searching._steps


def first_plan(problem):
    return next(greedy_steps(problem, perf_counter() + 60))


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(instances(max_blocks=4, kinds=EVERY_KIND), plan_options(), st.integers(0, 9999))
def test_plans_get_better_and_stay_legal_and_are_never_below_the_optimum(instance, options, seed):
    planned = wandering_plan(instance, options, seed)
    assume(planned is not None)
    problem, steps = planned
    plans, last = improved(problem, steps, seed, tries=15)
    costs = [cost_of(steps), *map(cost_of, plans)]
    assert costs == sorted(set(costs), reverse=True)
    assert cost_of(last) == costs[-1] >= optimal_cost(instance, options)
    assert all(verdict_on(problem, plan).accepted for plan in [*plans, last])


@pytest.mark.parametrize("topple", [True, False])
@pytest.mark.parametrize("kind", ["stacks", "positions", "on"])
def test_a_greedy_plan_of_twenty_blocks_is_bettered(kind, topple):
    shape = Shape(20, 4, 1, kind=kind)
    options = PlanOptions(topple, max_topple=2 if topple else None)
    problem = Problem(draw_instance("x", shape, random.Random(3)), options)
    steps = first_plan(problem)
    last = improved(problem, steps)[1]
    assert verdict_on(problem, last).accepted
    assert topple or cost_of(last) < cost_of(steps)


def test_equal_seeds_go_the_same_way():
    problem = Problem(generate("multi", 15, buffers=0, seed=4)[0], PlanOptions(topple=False))
    steps = first_plan(problem)
    first, second, other = (improved(problem, steps, seed) for seed in (3, 3, 4))
    assert first == second
    assert first[0]
    assert other != first


def test_past_the_deadline_it_pauses_with_the_plan_that_it_has():
    problem = Problem(generate("multi", 20, buffers=0)[0], PlanOptions(topple=False))
    steps = first_plan(problem)
    searching = NeighbourhoodSearch(problem)
    searching.take(steps)
    while searching.run(perf_counter() + 0.05) is not None:
        assert verdict_on(problem, searching._steps).accepted
    assert searching.cost <= cost_of(steps)


def test_nothing_is_tried_before_the_machine_code_is_there(monkeypatch):
    monkeypatch.setattr(search.Compiler, "code", lambda deadline: None)
    problem = Problem(generate("multi", 6, seed=1)[0], PlanOptions(topple=False))
    searching = NeighbourhoodSearch(problem)
    searching.take(first_plan(problem))
    assert searching.run(perf_counter()) is None
    assert searching.tried == 0


def test_a_plan_too_short_to_be_taken_apart_is_left_alone():
    instance = make_instance(start={"s1": ["a"], "s2": []}, goal={"s2": ["a"]})
    problem = Problem(instance, PlanOptions())
    plans, last = improved(problem, [])
    assert (plans, last) == ([], [])


def test_a_window_that_has_no_better_plan_is_not_planned_twice(monkeypatch):
    problem = Problem(generate("multi", 6, buffers=0, seed=4)[0], PlanOptions(topple=False))
    best = optimal_cost(problem.instance, problem.options)
    searching = NeighbourhoodSearch(problem, 1)
    searching.take(first_plan(problem))
    searching.run(perf_counter())
    monkeypatch.setattr(searching, "_stretch", lambda size: (0, len(searching._steps)))
    arm, made, begun = Arm(100, 10**6, 1.0), search.BeamPass, []

    def noted(*given, **named):
        begun.append(given)
        return made(*given, **named)

    monkeypatch.setattr(search, "BeamPass", noted)
    efforts = [searching._window(arm, math.inf) for _ in range(3)]
    assert searching.cost == best
    assert len(begun) == 1
    assert efforts[0] > efforts[1] == efforts[2]


def test_what_is_known_of_windows_does_not_grow_without_end(monkeypatch):
    monkeypatch.setattr(search, "MOST_KNOWN", 3)
    problem = Problem(generate("multi", 9, buffers=1, seed=4)[0], PlanOptions(topple=False))
    searching = NeighbourhoodSearch(problem, 1)
    searching.take(first_plan(problem))
    searching.run(perf_counter())
    known = []  # windows of few steps are searched whole
    for size in 3 * (2, 3, 4, 5):
        searching._window(Arm(size, 10**6, 1.0), math.inf)
        known.append(len(searching._least))
    assert max(known) == 3
    assert verdict_on(problem, searching._steps).accepted
