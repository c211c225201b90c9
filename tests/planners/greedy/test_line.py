"""One and two locations without topple: a line of blocks that keeps its order."""

import pytest
from hypothesis import given, settings

from smash.planners.greedy.line import line_steps
from smash.problem import Law, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.views.numbered import Numbered
from tests.oracle import optimal_cost
from tests.strategies import instances

NO_TOPPLE = PlanOptions(topple=False)


@settings(max_examples=200, deadline=None)
@given(instances(max_blocks=5, max_stacks=2, max_buffers=0))
def test_steps_are_found_exactly_where_exhaustive_search_finds_a_plan_and_they_are_legal(instance):
    problem = Numbered.of(instance)
    steps = line_steps(problem)
    assert (steps is None) == (optimal_cost(instance, NO_TOPPLE) is None)
    if steps is not None:
        assert Law(instance, NO_TOPPLE).check(problem.actions(steps)).accepted


def two(start, goal, table=""):
    blocks = sorted({*table}.union(*start.values()))
    return Numbered.of(
        make_instance(name="x", blocks=blocks, stacks=["s1", "s2"], start=start, table=table, goal=StacksGoal(goal))
    )


def test_moving_the_gap_by_one_block_is_one_transfer():
    assert line_steps(two({"s1": "ab"}, {"s1": ("a",), "s2": ("b",)})) == [(1, 0, 1)]


def test_a_line_is_never_put_in_another_order():
    assert line_steps(two({"s1": "ab"}, {"s1": ("b", "a")})) is None
    assert line_steps(two({"s1": "ab"}, {"s2": ("a", "b")})) is None


def test_a_block_of_the_table_region_enters_the_line_anywhere():
    steps = line_steps(two({"s1": "ab"}, {"s1": ("a", "c", "b")}, table="c"))
    assert steps == [(1, 0, 1), (2, -1, 0), (1, 1, 0)]


def test_three_locations_are_no_line():
    instance = make_instance(name="x", blocks="a", stacks=["s1", "s2", "s3"], start={"s1": "a"}, goal=PositionsGoal({}))
    with pytest.raises(ValueError, match="one or two locations"):
        line_steps(Numbered.of(instance))
