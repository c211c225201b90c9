"""Beam search: legal plans never cheaper than the optimum, a proof where no state was left out, clear ends."""

import math
from time import perf_counter

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from smash.planners.astar import BeamSearch, beam
from smash.planners.astar.task import make_setting
from smash.planners.greedy import greedy_steps
from smash.planners.portfolio import SmashPlanner
from smash.planners.protocol import SolveOptions
from smash.problem import Law, PlanOptions, StacksGoal, make_instance
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.sets.suites import read_suite
from smash.problem.views.numbered import Numbered, cost_of
from tests.oracle import optimal_cost
from tests.strategies import EVERY_KIND, instances, plan_options

pytestmark = pytest.mark.usefixtures("machine_code")

LOOSE = 6
"""How far above the optimum the search is told that a plan is known: so that it must find one itself."""


def plans_of(search, seconds=60, most_width=None):
    until = perf_counter() + seconds
    plans = []
    while (steps := search.run(until, most_width)) is not None:
        plans.append(steps)
    return plans


def greedy_cost(problem, options):
    return min(cost_of(steps) for steps in greedy_steps(Problem(problem.instance, options), perf_counter() + 1))


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(instances(max_blocks=4, kinds=EVERY_KIND), plan_options())
def test_passes_without_a_state_left_out_end_with_the_optimum_of_exhaustive_search(instance, options):
    best = optimal_cost(instance, options)
    assume(best is not None)
    problem = Numbered.of(instance)
    search = BeamSearch(problem, options, best + LOOSE)
    plans = plans_of(search)
    costs = [cost_of(steps) for steps in plans]
    assert search.ended == "proven"
    assert search.upper == costs[-1] == best
    assert costs == sorted(set(costs), reverse=True)
    law = Law(instance, options)
    assert all(law.check(problem.actions(steps)).accepted for steps in plans)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(instances(max_blocks=4, kinds=EVERY_KIND), plan_options())
def test_nothing_is_found_and_that_is_proven_where_the_plan_known_is_the_best(instance, options):
    best = optimal_cost(instance, options)
    assume(best)
    search = BeamSearch(Numbered.of(instance), options, best)
    assert plans_of(search) == []
    assert search.ended == "proven"


@settings(max_examples=30, deadline=None)
@given(instances(min_blocks=5, max_blocks=7, max_stacks=4), plan_options())
def test_the_narrowest_pass_gives_legal_plans_of_every_goal(instance, options):
    law = Law(instance, options)
    problem = Numbered.of(instance)
    for steps in plans_of(BeamSearch(problem, options, 60), most_width=beam.FIRST_WIDTH):
        verdict = law.check(problem.actions(steps))
        assert verdict.accepted
        assert verdict.cost == cost_of(steps) < 60


def test_equal_seeds_find_equal_plans():
    problem = Numbered.of(generate("multi", 9, buffers=0, seed=4)[0])
    options = PlanOptions(topple=False)
    first, second = (plans_of(BeamSearch(problem, options, 80, seed=3), most_width=8) for _ in range(2))
    assert first == second
    assert first


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(instances(max_blocks=4, kinds=EVERY_KIND), plan_options(), st.sampled_from([2, 3, 4]))
def test_the_weight_of_a_pass_that_leaves_nothing_out_does_not_matter(machine_code, instance, options, weight):
    best = optimal_cost(instance, options)
    assume(best)
    problem = Numbered.of(instance)
    running = beam.BeamPass(
        make_setting(problem, options), machine_code, best + LOOSE, 10**6, beam.MOST_MEMORY, 0, weight=weight
    )
    costs = []
    while not running.over:
        moves = running.advance()
        if moves is not None:
            costs.append(cost_of(running.engine.steps(problem, moves)))
    assert costs[-1] == best
    assert not running.truncated


def test_passes_take_the_weights_in_turn(monkeypatch):
    weights = []
    made = beam.BeamPass.__init__

    def noted(self, *given, weight, **named):
        weights.append(weight)
        made(self, *given, weight=weight, **named)

    monkeypatch.setattr(beam.BeamPass, "__init__", noted)
    problem = Numbered.of(generate("multi", 9, buffers=0, seed=4)[0])
    plans_of(BeamSearch(problem, PlanOptions(topple=False), 80), most_width=16)
    assert weights == [beam.WEIGHTS[index % len(beam.WEIGHTS)] for index in range(len(weights))]
    assert len(set(weights)) == len(beam.WEIGHTS)


def test_a_pass_that_left_a_state_out_proves_nothing():
    problem = Numbered.of(generate("multi", 9, buffers=0, seed=4)[0])
    search = BeamSearch(problem, PlanOptions(topple=False), 80)
    plans_of(search, most_width=4)
    assert search.ended is None
    assert search.width == 8


def test_layers_that_memory_does_not_hold_are_cut_and_prove_nothing():
    problem = Numbered.of(generate("multi", 9, buffers=0, seed=4)[0])
    search = BeamSearch(problem, PlanOptions(topple=False), 80, memory=400)
    plans_of(search, seconds=0.2)
    assert search.ended is None
    assert search.width == beam.FIRST_WIDTH


def test_past_the_deadline_it_pauses():
    problem = Numbered.of(generate("multi", 20, buffers=0)[0])
    search = BeamSearch(problem, PlanOptions(topple=False), 400)
    plans_of(search, seconds=0.3)
    assert search.ended is None
    assert search.run(perf_counter()) is None


def test_no_plan_is_looked_for_before_the_machine_code_is_there(monkeypatch):
    monkeypatch.setattr(beam.Compiler, "code", lambda deadline: None)
    search = BeamSearch(Numbered.of(generate("multi", 6, buffers=0, seed=1)[0]), PlanOptions(), 60)
    assert search.run(perf_counter() + 10) is None
    assert search.ended is None


def test_three_hundred_blocks_are_planned_as_few_are():
    """The tops of two piles change places."""
    names = [f"b{number}" for number in range(300)]
    start = {"s1": tuple(names[:150]), "s2": tuple(names[150:])}
    goal = StacksGoal({"s1": (*names[:149], names[299]), "s2": (*names[150:299], names[149])})
    instance = make_instance(name="many", blocks=names, stacks=["s1", "s2"], buffers=["u1"], start=start, goal=goal)
    problem, options = Numbered.of(instance), PlanOptions(topple=False)
    steps = BeamSearch(problem, options, 20).run(math.inf)
    assert Law(instance, options).check(problem.actions(steps)).accepted
    assert cost_of(steps) == 6


def test_a_better_plan_of_others_is_to_be_beaten():
    problem = Numbered.of(generate("multi", 6, buffers=0, seed=1)[0])
    options = PlanOptions(topple=False)
    search = BeamSearch(problem, options, 60)
    optimum = cost_of(plans_of(BeamSearch(problem, options, 60))[-1])
    search.lower_upper(optimum)
    assert plans_of(search) == []


@pytest.mark.slow
def test_the_default_betters_the_greedy_plan_of_fifteen_blocks_without_buffers():
    instance = next(each for each in read_suite("open-on") if each.name == "open-on-00")
    options = SolveOptions(topple=False)
    result = SmashPlanner().solve(instance, options, 15)
    assert result.cost < greedy_cost(Numbered.of(instance), options)
    assert Law(instance, options).check(result.actions).accepted


def test_a_state_that_was_broken_off_where_memory_ends_is_not_gone_on_with_in_the_next_layer(machine_code):
    problem = Numbered.of(generate("multi", 9, seed=4)[0])
    setting = make_setting(problem, PlanOptions())
    running = beam.BeamPass(setting, machine_code, 80, 4, beam.MOST_MEMORY, 0)
    running.advance()
    engine = running.engine

    def break_off(task, cells, rows, costs, estimates, store, first, end):
        store.counters[beam.NODES] = store.shape[2]
        cells[task.resumed] = 0
        return first

    running._most = int(running._store.shape[2])
    engine.code = machine_code._replace(expand_layer=break_off)
    running.advance()
    assert running.cramped
    assert engine.cells[engine.task.resumed] == -1
