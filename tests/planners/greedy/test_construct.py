"""One pass of the greedy planner: legal steps that build the target, and no more than the digging it needs."""

import random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from smash.planners.greedy.construct import Construction
from smash.problem import Law, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.problem import Problem
from smash.problem.views.numbered import TOPPLE, Numbered, cost_of
from smash.problem.views.targets import target_piles
from tests.strategies import instances, plan_options


def built(instance, options, noise=0.0, first=(), due=None):
    problem = Numbered.of(instance)
    cap = options.max_topple or max(1, problem.blocks)
    pass_ = Construction(
        problem,
        target_piles(problem),
        topple=options.topple,
        cap=cap,
        due=due or [0.0] * problem.blocks,
        noise=noise,
        draw=random.Random(1),
    )
    return problem, pass_, pass_.run(first)


@settings(max_examples=100, deadline=None)
@given(instances(max_blocks=6), plan_options(), st.integers(0, 999), st.sampled_from([0.0, 1.0]))
def test_a_pass_is_a_legal_plan_that_builds_every_target_pile(instance, options, seed, noise):
    assume(options.topple or len(instance.locations) >= 3)
    assume(Problem(instance, options).infeasible is None)
    due = [random.Random(seed).random() for _ in instance.blocks]
    problem, pass_, steps = built(instance, options, noise, due=due)
    verdict = Law(instance, options).check(problem.actions(steps))
    assert verdict.accepted
    for pile, target in zip(pass_.piles, pass_.target, strict=True):
        assert tuple(pile[: len(target)]) == target


def reversal(buffers=1):
    """Three blocks to be built in the same order on another stack."""
    return make_instance(
        name="x",
        blocks="abc",
        stacks=["s1", "s2"],
        buffers=[f"u{number}" for number in range(buffers)],
        start={"s1": "abc"},
        goal=StacksGoal({"s2": ("a", "b", "c")}),
    )


def test_a_pile_in_the_way_is_toppled_whole_where_that_is_allowed():
    steps = built(reversal(), PlanOptions())[2]
    assert sum(step[0] == TOPPLE for step in steps) == 1
    assert cost_of(steps) == 7


def test_under_a_cap_of_one_each_block_falls_alone():
    steps = built(reversal(), PlanOptions(max_topple=1))[2]
    assert all(step[2] == 1 for step in steps if step[0] == TOPPLE)


def test_direct_moves_are_all_there_is_where_none_is_in_the_way():
    instance = make_instance(
        name="x", blocks="abc", stacks=["s1", "s2"], start={"s1": "abc"}, goal=StacksGoal({"s2": ("c", "b", "a")})
    )
    assert built(instance, PlanOptions())[2] == [(2, 0, 1), (1, 0, 1), (0, 0, 1)]


def test_stacks_to_be_toppled_first_are_toppled_first():
    steps = built(reversal(), PlanOptions(max_topple=2), first=[0])[2]
    assert steps[:2] == [(TOPPLE, 0, 2), (TOPPLE, 0, 1)]


@pytest.mark.parametrize("topple", [True, False])
def test_blocks_that_the_goal_does_not_name_stay_where_nothing_is_below_them(topple):
    instance = make_instance(
        name="x",
        blocks="abc",
        stacks=["s1", "s2", "s3"],
        start={"s1": "ab", "s3": "c"},
        goal=PositionsGoal({"b": ("s2", 1)}),
    )
    assert built(instance, PlanOptions(topple))[2] == [(1, 0, 1)]
