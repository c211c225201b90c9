"""The numbers of a problem: which locations are alike, how a state is filed, what does not fit."""

import pytest

from smash.planners.astar import state
from smash.planners.astar.task import make_setting
from smash.problem import OnGoal, PlanOptions, PositionsGoal, StacksGoal, make_instance
from smash.problem.views.numbered import Numbered
from tests.arrangements import wide


def setting_of(goal, topple=True, start=None, table=(), cap=None):
    start = {"s1": "ab"} if start is None else start
    blocks = sorted({*table}.union(*start.values()))
    instance = make_instance(
        name="x", blocks=blocks, stacks=["s1", "s2", "s3"], buffers=["u1", "u2"], start=start, table=table, goal=goal
    )
    return make_setting(Numbered.of(instance), PlanOptions(topple, cap))


def test_locations_without_a_goal_pile_are_alike_where_nothing_can_be_toppled():
    kinds = setting_of(StacksGoal({"s2": ("a", "b")}), topple=False).class_of
    assert kinds[0] == kinds[2] == kinds[3] == kinds[4] != kinds[1]


def test_with_topple_stacks_and_buffers_are_told_apart():
    kinds = setting_of(StacksGoal({"s2": ("a", "b")})).class_of
    assert kinds[0] == kinds[2]
    assert kinds[3] == kinds[4]
    assert len(set(kinds)) == 3


def test_relations_leave_all_locations_alike():
    setting = setting_of(OnGoal({"b": "a"}), topple=False)
    assert len(set(setting.class_of)) == 1
    assert setting.task.anywhere == 1


def test_a_state_is_filed_by_what_is_below_each_block():
    setting = setting_of(PositionsGoal({}), start={"s1": "ab"}, table="c")
    below_a, below_b, below_c = setting.start
    assert below_a == 3 + setting.class_of[0]
    assert below_b == 0
    assert below_c == 3 + setting.task.classes


def test_a_topple_takes_no_more_than_the_cap_and_no_more_than_there_are():
    assert setting_of(PositionsGoal({}), cap=1).task.cap == 1
    assert setting_of(PositionsGoal({}), cap=9).task.cap == 2
    assert setting_of(PositionsGoal({})).task.cap == 2


@pytest.mark.parametrize(("blocks", "tidy"), [("abc", 1), ("abcd", 0)])
def test_relations_are_built_at_once_only_where_every_block_has_a_location(blocks, tidy):
    """Three stacks: with fewer locations than blocks a tower begun too early may take the place of another."""
    assert setting_of(OnGoal({"b": "a"}), start={"s1": blocks}).task.tidy == tidy
    assert setting_of(PositionsGoal({"a": ("s1", 1)}), start={"s1": blocks}).task.tidy == 1


@pytest.mark.parametrize(("blocks", "width"), [(0, 1), (250, 1), (254, 1), (255, 2), (300, 2)])
def test_a_state_has_the_bytes_that_what_is_below_a_block_needs(blocks, width):
    names = [f"b{number}" for number in range(blocks)]
    instance = make_instance(
        name="x", blocks=names, stacks=["s1"], start={"s1": names}, goal=StacksGoal({"s1": tuple(names)})
    )
    setting = make_setting(Numbered.of(instance), PlanOptions())
    assert setting.task.width == width
    assert len(setting.start) == width * blocks
    assert max(setting.start, default=0) < 256


@pytest.mark.parametrize("seed", range(3))
def test_a_wide_state_is_what_was_filed(seed):
    problem = Numbered.of(wide(300, 7, seed, buffers=2))
    setting = make_setting(problem, PlanOptions(topple=False))
    cells, row = list(setting.cells), [0] * len(setting.start)
    state.unpack(setting.task, cells, setting.start, 0)
    state.pack(setting.task, cells, row, 0)
    assert row == setting.start
    piles = sorted(
        cells[setting.task.content + slot * 300 : setting.task.content + slot * 300 + cells[setting.task.length + slot]]
        for slot in range(cells[setting.task.counters])
    )
    assert [pile for pile in piles if pile] == sorted(list(pile) for pile in problem.start if pile)
