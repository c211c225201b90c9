"""Ways down to blocks and places: what makes the hand choose another one."""

import numpy as np
import pytest

from smash.execution.actions.pick_and_place import Move, Steps
from smash.execution.scene.block_pose import BlockPose, standing
from smash.execution.scene.scene_file import default_scene
from smash.motion.errors import NoMotion
from smash.motion.robot import READY

SIDE = 0.045


@pytest.fixture(scope="module")
def steps():
    return Steps(default_scene())


def test_a_promised_way_down_is_given_up_where_a_block_came_to_rest_on_the_place(steps):
    slot = default_scene().stacks[1]
    target = standing(slot.x, slot.y, SIDE / 2, slot.angle)
    held = {"held": standing(0.3, 0.3, 0.3, 0.0)}
    way = steps.landing(READY, "held", target, steps.scene(held))
    near = {"other": standing(*slot.point(0.05, 0.0, "counter-clockwise"), SIDE / 2, slot.angle)}
    on_it = {"other": standing(slot.x + 0.02, slot.y, SIDE / 2, slot.angle)}
    assert steps.still_free(way, "held", steps.scene(held))
    assert not steps.still_free(way, "held", steps.scene(held | on_it))
    with pytest.raises(NoMotion):
        steps.landing(READY, "held", target, steps.scene(held | on_it))
    again = steps.landing(READY, "held", target, steps.scene(held | near))
    assert steps.still_free(again, "held", steps.scene(held | near))


def test_a_block_is_lifted_without_touching_its_neighbour_where_there_is_a_way(steps):
    slot = default_scene().stacks[1]
    block = standing(slot.x, slot.y, SIDE / 2, 0.0)
    scene = steps.scene({"a": block, "b": standing(slot.x + SIDE + 0.001, slot.y, SIDE / 2, 0.0)})
    lift = [segment for segment in steps.pick(READY, "a", block, scene) if isinstance(segment, Move)][-1]
    assert lift.hand.attached is not None
    assert lift.free(scene, 0.0)


def test_a_block_under_a_leaning_one_is_picked_all_the_same(steps):
    slot = default_scene().stacks[1]
    block = standing(slot.x, slot.y, SIDE / 2, 0.0)
    turn = np.array([[np.cos(0.5), 0, np.sin(0.5)], [0, 1, 0], [-np.sin(0.5), 0, np.cos(0.5)]])
    leaning = BlockPose(np.array([slot.x + 0.048, slot.y, 0.035]), turn)
    assert steps.pick(READY, "a", block, steps.scene({"a": block, "b": leaning}))
