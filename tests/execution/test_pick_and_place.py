"""Ways down to blocks and places: what makes the hand choose another one."""

import numpy as np
import pytest

from smash.execution.actions.arm_motions import ArmMotions
from smash.execution.actions.pick_and_place import PickAndPlace
from smash.execution.scene.block_pose import BlockPose, standing
from smash.execution.scene.scene_file import default_scene
from smash.motion.errors import NoMotion
from smash.motion.move import Move
from smash.motion.robot import READY

SIDE = 0.045


@pytest.fixture(scope="module")
def arm():
    return ArmMotions(default_scene())


@pytest.fixture(scope="module")
def hand(arm):
    return PickAndPlace(arm)


def test_a_promised_way_down_is_given_up_where_a_block_came_to_rest_on_the_place(arm, hand):
    slot = default_scene().stacks[1]
    target = standing(slot.x, slot.y, SIDE / 2, slot.angle)
    held = {"held": standing(0.3, 0.3, 0.3, 0.0)}
    way = hand.landing(READY, "held", target, arm.scene(held))
    near = {"other": standing(*slot.point(0.05, 0.0, "counter-clockwise"), SIDE / 2, slot.angle)}
    on_it = {"other": standing(slot.x + 0.02, slot.y, SIDE / 2, slot.angle)}
    assert hand.still_free(way, "held", arm.scene(held))
    assert not hand.still_free(way, "held", arm.scene(held | on_it))
    with pytest.raises(NoMotion):
        hand.landing(READY, "held", target, arm.scene(held | on_it))
    again = hand.landing(READY, "held", target, arm.scene(held | near))
    assert hand.still_free(again, "held", arm.scene(held | near))


def test_a_block_is_lifted_without_touching_its_neighbour_where_there_is_a_way(arm, hand):
    slot = default_scene().stacks[1]
    block = standing(slot.x, slot.y, SIDE / 2, 0.0)
    scene = arm.scene({"a": block, "b": standing(slot.x + SIDE + 0.001, slot.y, SIDE / 2, 0.0)})
    lift = [segment for segment in hand.pick(READY, "a", block, scene) if isinstance(segment, Move)][-1]
    assert lift.hand.attached is not None
    assert lift.free(scene, 0.0)


def test_a_block_under_a_leaning_one_is_picked_all_the_same(arm, hand):
    slot = default_scene().stacks[1]
    block = standing(slot.x, slot.y, SIDE / 2, 0.0)
    turn = np.array([[np.cos(0.5), 0, np.sin(0.5)], [0, 1, 0], [-np.sin(0.5), 0, np.cos(0.5)]])
    leaning = BlockPose(np.array([slot.x + 0.048, slot.y, 0.035]), turn)
    assert hand.pick(READY, "a", block, arm.scene({"a": block, "b": leaning}))
