"""Plans as steps, the arrangements on the way, and plans without detours."""

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from smash.planners.astar.task import make_setting
from smash.planners.neighbourhood.course import arrangement_after, steps_of, without_detours
from smash.problem import Lift, OnGoal, Pick, Place, PlanOptions, StacksGoal, Topple, make_instance
from smash.problem.problem import Problem
from smash.problem.views.numbered import ON_TABLE, TOPPLE, cost_of
from tests.planners.neighbourhood.wandering import verdict_on, wandering_plan
from tests.strategies import EVERY_KIND, instances, plan_options


@settings(max_examples=100, deadline=None)
@given(instances(max_blocks=5, kinds=EVERY_KIND, odd_names=True), plan_options(), st.integers(0, 9999))
def test_actions_become_the_steps_that_they_came_from_and_lead_to_the_laws_states(instance, options, seed):
    planned = wandering_plan(instance, options, seed)
    assume(planned is not None)
    problem, steps = planned
    numbered = problem.numbered
    actions = numbered.actions(steps)
    assert steps_of(numbered, actions) == steps
    state = list(problem.law.states(actions))[-1]
    end, names = arrangement_after(numbered, steps), instance.blocks
    assert {names[block] for block in end.table} == state.table
    assert [[names[block] for block in pile] for pile in end.piles] == [state.piles[at] for at in instance.locations]


def test_a_block_that_is_put_back_makes_no_step():
    goal = OnGoal({"b": "a"})
    instance = make_instance(name="x", blocks="ab", stacks=["s1"], start={"s1": "a"}, table="b", goal=goal)
    numbered = Problem(instance, PlanOptions()).numbered
    actions = (Pick("a", "s1"), Place("a", "s1"), Topple("s1", 1), Pick("b", "table"), Place("b", "s1"))
    assert steps_of(numbered, actions) == [(TOPPLE, 0, 1), (1, ON_TABLE, 0)]


@settings(max_examples=200, deadline=None)
@given(instances(max_blocks=4, max_buffers=3, kinds=EVERY_KIND), plan_options(), st.integers(0, 9999))
def test_a_plan_without_its_detours_is_legal_and_passes_through_no_arrangement_twice(instance, options, seed):
    planned = wandering_plan(instance, options, seed, count=20)
    assume(planned is not None)
    problem, steps = planned
    class_of = make_setting(problem.numbered, options).class_of
    shorter = without_detours(problem.numbered, steps, class_of)
    assert verdict_on(problem, shorter).accepted
    assert cost_of(shorter) <= cost_of(steps)
    assert without_detours(problem.numbered, shorter, class_of) == shorter
    seen = []
    for count in range(len(shorter) + 1):
        arrangement = arrangement_after(problem.numbered, shorter[:count])
        piles = [(number, tuple(pile)) for number, pile in zip(class_of, arrangement.piles, strict=True)]
        seen.append((tuple(sorted(piles)), frozenset(arrangement.table)))
    assert len(set(seen)) == len(seen)


@pytest.mark.parametrize("buffer", [1, 2])
def test_what_goes_to_one_buffer_and_on_to_another_goes_there_at_once(buffer):
    goal = StacksGoal({"s1": ("b", "a")})
    instance = make_instance(
        name="x", blocks="ab", stacks=["s1"], buffers=["u1", "u2", "u3"], start={"s1": "ab"}, goal=goal
    )
    problem = Problem(instance, PlanOptions(topple=False))
    other = 3 - buffer
    steps = [(1, 0, buffer), (1, buffer, other), (0, 0, buffer), (1, other, 0), (0, buffer, 0)]
    shorter = without_detours(problem.numbered, steps, make_setting(problem.numbered, problem.options).class_of)
    assert cost_of(shorter) == cost_of(steps) - 2
    assert verdict_on(problem, shorter).accepted


def test_other_actions_make_no_steps():
    numbered = Problem(make_instance(name="x", blocks="a", stacks=["s1"], start={"s1": "a"}, goal=OnGoal({}))).numbered
    with pytest.raises(ValueError, match="no pick"):
        steps_of(numbered, (Lift("s1", 1, "s1"),))
