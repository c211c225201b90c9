"""Who is named where blocks move that an action is not about."""

import numpy as np

from smash.execution.actions.arm_motions import ArmMotions
from smash.execution.grounding import Grounder
from smash.execution.scene.block_pose import standing
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.scene_file import default_scene
from smash.execution.scene.start import starting_poses
from smash.execution.watching import Watch, part_of, spoilt
from smash.problem import Law, Pick, Place, PositionsGoal, State, Topple, make_instance
from tests.robots import READY

SCENE = default_scene()


def row_of(**places):
    return {block: standing(x, 0.4, 0.0225, 0.0) for block, x in places.items()}


def test_a_block_that_has_moved_is_named_with_how_far_and_only_once():
    watch = Watch(row_of(a=0.0, b=0.1))
    assert watch.disturbed(row_of(a=0.03, b=0.115), ()) == {"a": np.float64(0.03)}
    assert watch.disturbed(row_of(a=0.03, b=0.115), ()) == {}


def test_what_the_action_is_about_may_move():
    watch = Watch(row_of(a=0.0, b=0.1))
    assert watch.disturbed(row_of(a=0.5, b=0.1), {"a"}) == {}
    assert watch.disturbed(row_of(a=0.5, b=0.1), ()) == {}


def test_a_block_that_creeps_is_named_when_it_has_come_too_far():
    watch = Watch(row_of(a=0.0))
    assert [bool(watch.disturbed(row_of(a=x), ())) for x in (0.012, 0.024, 0.036)] == [False, True, False]


def test_a_topple_is_about_what_falls_and_nothing_below():
    state = State({"s1": ["a", "b", "c"]}, set(), None)
    assert set(part_of(Topple("s1", 2), state)) == {"b", "c"}
    assert set(part_of(Pick("c", "s1"), state)) == {"c"}


def grounded(*actions):
    instance = make_instance(
        name="two",
        blocks=["a", "b"],
        stacks=["s1", "s2", "s3"],
        start={"s2": ["a"]},
        table=["b"],
        goal=PositionsGoal({}),
    )
    slots = SCENE.bind(instance)
    poses = starting_poses(instance, slots, SCENE, np.random.default_rng(0))
    arm = ArmMotions(SCENE)
    return arm, poses, Grounder(arm).ground(actions, Law(instance), Geometry(slots, blocks=poses), READY)


def test_a_block_that_moved_spoils_the_grasp_planned_for_it_and_no_other_motion_that_it_is_not_in():
    arm, poses, tasks = grounded(Pick("a", "s2"), Place("a", "s3"), Pick("b", "table"), Place("b", "s2"))
    x, y, _ = poses["b"].position
    assert spoilt(tasks, "b", standing(x * 0.9, y * 0.9, 0.0225, 0.0), arm) is tasks[2]
    assert spoilt(tasks[:2], "b", standing(x * 0.9, y * 0.9, 0.0225, 0.0), arm) is None


def test_a_block_that_came_to_lie_on_a_place_spoils_the_motion_there():
    arm, _, tasks = grounded(Pick("a", "s2"), Place("a", "s3"))
    slot = SCENE.stacks[2]
    assert spoilt(tasks, "b", standing(slot.x + 0.01, slot.y, 0.0225, 0.0), arm) is tasks[1]
