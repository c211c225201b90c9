"""The engine: a bound at the start, moves from it as steps, shares that fit the size."""

import pytest
from hypothesis import assume, given, settings

from smash.planners.astar.compiled import INTERPRETED
from smash.planners.astar.engine import Engine
from smash.planners.astar.task import TOPPLED, make_setting
from smash.problem import Law, PlanOptions, StacksGoal, make_instance
from smash.problem.sets.generators import generate
from smash.problem.views.numbered import TOPPLE, Numbered
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options


def engine_of(instance, options):
    return Engine(make_setting(Numbered.of(instance), options), INTERPRETED, False)


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4), plan_options())
def test_the_first_bound_is_no_more_than_the_optimum(instance, options):
    best = optimal_cost(instance, options)
    assume(best is not None)
    assert engine_of(instance, options).first_bound() <= best


def test_moves_become_steps_with_the_direct_moves_that_they_free():
    instance = make_instance(
        name="x", blocks="abc", stacks=["s1", "s2"], start={"s1": "abc"}, goal=StacksGoal({"s1": ("a", "c", "b")})
    )
    problem = Numbered.of(instance)
    steps = engine_of(instance, PlanOptions()).steps(problem, [(1, TOPPLED)])
    assert steps == [(TOPPLE, 0, 2), (2, -1, 0), (1, -1, 0)]


@pytest.mark.parametrize("topple", [True, False])
def test_a_start_that_only_needs_direct_moves_needs_no_other(topple):
    instance = make_instance(
        name="x", blocks="ab", stacks=["s1", "s2"], start={"s1": "ab"}, goal=StacksGoal({"s2": ("b", "a")})
    )
    assert engine_of(instance, PlanOptions(topple)).steps(Numbered.of(instance), []) == [(1, 0, 1), (0, 0, 1)]


def test_the_larger_the_problem_the_fewer_expansions_between_two_looks_at_the_clock():
    engines = [engine_of(generate("multi", size, buffers=2)[0], PlanOptions()) for size in (4, 9, 30, 200)]
    for figures in ([engine.share for engine in engines], [engine.tries for engine in engines]):
        assert figures == sorted(figures, reverse=True)
    assert engines[-1].share == 1


def test_a_block_may_be_moved_from_floor_to_floor_any_number_of_times():
    """Each such move begins a pile: there has to be room for as many as a plan makes."""
    instance = make_instance(
        name="x", blocks="ab", stacks=["s1", "s2", "s3"], start={"s1": "ab"}, goal=StacksGoal({"s1": "ba"})
    )
    problem = Numbered.of(instance)
    options = PlanOptions(topple=False)
    setting = make_setting(problem, options)
    floor = len(instance.blocks) + setting.class_of[1]
    steps = engine_of(instance, options).steps(problem, [(1, floor)] * 40 + [(0, floor)])
    assert len(steps) == 43
    report = Law(instance, options).check(problem.actions(steps))
    assert report.accepted
