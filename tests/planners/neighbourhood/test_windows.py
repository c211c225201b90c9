"""Windows: problems of their own whose plans serve in the plan, and hold no block that is not concerned."""

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from smash.planners.neighbourhood.course import Arrangement, arrangement_after
from smash.planners.neighbourhood.windows import SPARE, final_piles, window_of
from smash.problem import OnGoal, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.problem import Problem
from smash.problem.rules import Law
from smash.problem.views.numbered import ON_TABLE, TOPPLE, Numbered
from tests.planners.neighbourhood.wandering import wandering_plan
from tests.strategies import EVERY_KIND, instances, plan_options


def windows_of(problem, steps, begin, end):
    """Return the window of some steps of a plan, or None."""
    numbered = problem.numbered
    final = final_piles(numbered, arrangement_after(numbered, steps)) if end == len(steps) else None
    if end == len(steps) and final is None:
        return None
    return window_of(numbered, arrangement_after(numbered, steps[:begin]), steps[begin:end], final)


@settings(max_examples=200, deadline=None)
@given(
    instances(max_blocks=4, kinds=EVERY_KIND),
    plan_options(),
    st.integers(0, 9999),
    st.integers(0, 8),
    st.integers(1, 9),
)
def test_the_steps_of_a_window_are_a_plan_of_its_problem(instance, options, seed, begin, size):
    planned = wandering_plan(instance, options, seed)
    assume(planned is not None and begin < len(planned[1]))
    problem, steps = planned
    end = min(len(steps), begin + size)
    window = windows_of(problem, steps, begin, end)
    assume(window is not None)
    number = {block: index for index, block in enumerate(window.blocks)}
    place = {location: index for index, location in enumerate(window.locations)} | {ON_TABLE: ON_TABLE}
    own = [
        (TOPPLE, place[second], third) if first == TOPPLE else (number[first], place[second], place[third])
        for first, second, third in steps[begin:end]
    ]
    assert window.in_plan(own) == steps[begin:end]
    law = Law(window.problem.instance, options)
    asked = window.problem.instance.goal.stacks
    states = list(law.states(window.problem.actions(own)))
    for location, pile in states[-1].piles.items():
        assert tuple(pile[: len(asked.get(location, ()))]) == asked.get(location, ())
    assert window.whole == (sum(map(len, asked.values())) == len(window.blocks))
    moved = {step[0] for step in steps[begin:end]} - {TOPPLE}
    assert moved <= set(window.blocks)


def swapped():
    """Two blocks to be exchanged below a third, a fourth far away."""
    return make_instance(
        name="x",
        blocks="abcd",
        stacks=["s1", "s2", "s3", "s4", "s5", "s6", "s7"],
        buffers=["u1"],
        start={"s1": "abc", "s7": "d"},
        goal=StacksGoal({"s1": ("b", "a", "c"), "s7": ("d",)}),
    )


def test_a_window_has_the_blocks_above_the_lowest_that_moves_and_a_few_more_locations():
    problem = Problem(swapped(), PlanOptions(topple=False))
    steps = [(2, 0, 1), (1, 0, 2), (0, 0, 3), (1, 2, 0), (0, 3, 0), (2, 1, 0)]
    window = windows_of(problem, steps, 0, 1)
    assert window.blocks == (2,)
    assert len(window.locations) == 2 + SPARE + 1  # both that are touched, spare stacks, the buffer
    assert windows_of(problem, steps, 0, 6).blocks == (0, 1, 2)
    assert window.problem.stacks == 2 + SPARE


def test_turned_round_it_goes_from_the_end_to_the_begin():
    problem = Problem(swapped(), PlanOptions(topple=False))
    steps = [(2, 0, 1), (1, 0, 2), (0, 0, 3), (1, 2, 0), (0, 3, 0), (2, 1, 0)]
    window = windows_of(problem, steps, 1, 4)
    turned = window.reversed()
    back = [(block, target, source) for block, source, target in reversed(steps[1:4])]
    number = {block: index for index, block in enumerate(window.blocks)}
    place = {location: index for index, location in enumerate(window.locations)}
    own = [(number[block], place[source], place[target]) for block, source, target in back]
    assert Law(turned.instance, PlanOptions(topple=False)).check(turned.actions(own)).accepted


def test_no_window_ends_with_a_block_in_the_table_region_that_was_not_there_before():
    problem = Problem(swapped(), PlanOptions())
    steps = [(TOPPLE, 0, 3), (1, ON_TABLE, 0), (0, ON_TABLE, 0), (2, ON_TABLE, 0)]
    assert windows_of(problem, steps, 0, 3) is None
    assert windows_of(problem, steps, 0, 4) is not None
    assert windows_of(problem, steps, 1, 2).problem.table


@pytest.mark.parametrize(
    ("goal", "piles"),
    [
        (StacksGoal({"s1": ("a",), "s2": ("b", "c")}), ((0,), (1, 2))),
        (PositionsGoal({"b": ("s2", 1)}), ((), (1,))),
        (OnGoal({"c": "b"}), ((), (1, 2))),
        (OnGoal({}, ("a",)), ((0,), ())),
        (OnGoal({"c": "b"}, clear=("c",)), ((0,), (1, 2))),
        (OnGoal({}, ontable=("a", "b")), ((0,), (1, 2))),
    ],
)
def test_what_must_lie_where_at_the_end(goal, piles):
    instance = make_instance(name="x", blocks="abc", stacks=["s1", "s2"], start={"s1": "abc"}, goal=goal)
    numbered = Numbered.of(instance)
    assert final_piles(numbered, Arrangement([[0], [1, 2]])) == piles


def test_where_a_block_must_lie_in_the_table_region_no_tail_is_made_anew():
    goal = OnGoal({}, ontable=("a",))
    instance = make_instance(name="x", blocks="ab", stacks=["s1"], start={"s1": "ba"}, goal=goal)
    assert final_piles(Numbered.of(instance), Arrangement([[1]], {0})) is None
