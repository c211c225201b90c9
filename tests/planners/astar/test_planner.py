"""Exact search over states: the optimum of exhaustive search, a bound that holds, clear ends."""

from time import perf_counter

import pytest
from hypothesis import HealthCheck, assume, given, settings

from smash.planners.astar import AStarPlanner, StateSearch, driver, engine
from smash.planners.protocol import SolveOptions
from smash.problem import Law, PlanOptions, StacksGoal, make_instance
from smash.problem.sets.generators import generate
from smash.problem.sets.suites import read_suite
from smash.problem.views.numbered import Numbered, cost_of
from tests.oracle import optimal_cost
from tests.strategies import EVERY_KIND, instances, plan_options

LOOSE = 6
"""How far above the optimum the search is told that a plan is known: so that it must find one itself."""


def searched(instance, options, upper):
    problem = Numbered.of(instance)
    search = StateSearch(problem, options, upper)
    steps = None
    first_bound = search.lower_bound
    while search.ended is None:
        found = search.run(perf_counter() + 60)
        steps = found if found is not None else steps
    return problem, search, steps, first_bound


@settings(max_examples=250, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])
@given(instances(max_blocks=4), plan_options())
def test_finds_the_optimum_of_exhaustive_search(instance, options):
    best = optimal_cost(instance, options)
    assume(best is not None)
    problem, search, steps, first_bound = searched(instance, options, best + LOOSE)
    assert first_bound <= best
    assert cost_of(steps) == best == search.lower_bound
    assert Law(instance, options).check(problem.actions(steps)).accepted


@settings(max_examples=120, deadline=None)
@given(instances(max_blocks=3, max_stacks=2, max_buffers=1, kinds=("on", "resting")), plan_options())
def test_on_goals_with_few_locations_have_the_optimum_of_exhaustive_search(instance, options):
    best = optimal_cost(instance, options)
    assume(best is not None)
    _, search, steps, _ = searched(instance, options, best + LOOSE)
    assert cost_of(steps) == best == search.lower_bound


@settings(max_examples=100, deadline=None)
@given(instances(max_blocks=4, odd_names=True, kinds=EVERY_KIND, hand=True), plan_options())
def test_the_planner_proves_the_optimum_or_that_there_is_no_plan(instance, options):
    best = optimal_cost(instance, options)
    result = AStarPlanner().solve(instance, SolveOptions(options.topple, options.max_topple), 30)
    assert result.status == ("infeasible" if best is None else "optimal")
    assert result.cost == best
    assert result.lower_bound == best


@pytest.mark.parametrize("topple", [True, False])
def test_six_blocks_without_buffers_are_proven(topple):
    for instance in read_suite("multi-6"):
        bare = make_instance(
            name=instance.name,
            blocks=instance.blocks,
            stacks=instance.stacks,
            start={q: instance.start[q] for q in instance.stacks},
            goal=instance.goal,
        )
        assert AStarPlanner().solve(bare, SolveOptions(topple), 30).status == "optimal"


def test_the_plan_of_a_solved_start_is_found_where_the_machine_code_is_there_at_once(monkeypatch):
    monkeypatch.setattr(driver.Compiler, "started", lambda: True)
    monkeypatch.setattr(driver.Compiler, "code", lambda deadline: driver.INTERPRETED)
    instance = make_instance(name="none", blocks=[], stacks=["s1"], start={}, goal=StacksGoal({}))
    assert searched(instance, PlanOptions(), LOOSE)[2] == []


@pytest.mark.slow
def test_compiled_and_interpreted_search_expand_the_same_nodes(monkeypatch):
    monkeypatch.setattr(engine, "WORK", {False: 1, True: 1})
    for instance in generate("multi", 8, buffers=0, count=6, seed=3):
        counts = []
        for nodes in (1_000_000, 1):
            monkeypatch.setattr(driver, "INTERPRETED_NODES", nodes)
            _, search, steps, _ = searched(instance, PlanOptions(topple=False), 60)
            counts.append((search.expanded, cost_of(steps), search.lower_bound))
        assert counts[0] == counts[1]


def test_a_spent_budget_leaves_a_plan_and_a_proven_bound():
    instance = generate("multi", 14, buffers=0)[0]
    result = AStarPlanner().solve(instance, SolveOptions(topple=False), 0.3)
    assert result.status in ("feasible", "optimal")
    assert 28 <= result.lower_bound <= result.cost
    assert result.bound_origin == "astar"


def test_spent_memory_ends_the_search_with_the_bound(monkeypatch):
    monkeypatch.setattr(driver, "INTERPRETED_NODES", 50)
    monkeypatch.setattr(driver.Compiler, "code", lambda deadline: None)
    monkeypatch.setattr(driver.StateSearch, "_grow", lambda self, deadline: setattr(self, "ended", "memory"))
    instance = generate("multi", 12, buffers=0)[0]
    result = AStarPlanner().solve(instance, SolveOptions(topple=False), 5)
    assert result.details["ended"] == "memory"
    assert result.status == "feasible"
    assert result.lower_bound < result.cost


@pytest.mark.parametrize("blocks", [40, 200])
def test_where_one_expansion_takes_long_there_is_the_first_bound_at_least(blocks):
    instance = generate("multi", blocks)[0]
    result = AStarPlanner().solve(instance, SolveOptions(topple=False), 1)
    assert 2 * blocks - 20 <= result.lower_bound <= result.cost


def test_three_hundred_blocks_are_left_to_others_with_the_greedy_plan():
    blocks = [f"b{number}" for number in range(300)]
    goal = StacksGoal({"s1": tuple(blocks)})
    instance = make_instance(name="many", blocks=blocks, stacks=["s1", "s2"], start={"s2": blocks}, goal=goal)
    result = AStarPlanner().solve(instance, SolveOptions(), 5)
    assert result.actions is not None
    assert result.status in ("feasible", "optimal")
