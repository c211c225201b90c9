"""A block is where the grasp says, however the hand stands beside it or leans."""

import numpy as np
import pytest

from smash.execution.actions.grasps import CENTRED, GRASPS
from smash.execution.scene.block_pose import BlockPose

SIDE = 0.045


def block_in_hand(grasp, tool):
    """The pose of the block that the hand holds, in the world."""
    held = grasp.of((SIDE, SIDE, SIDE)).hand().attached
    return BlockPose(tool.position + tool.rotation @ held.translations[0], tool.rotation @ held.rotations[0])


@pytest.mark.parametrize("grasp", GRASPS)
@pytest.mark.parametrize("yaw", [0.0, 0.7, 2.0, -1.5])
def test_the_block_between_the_pads_is_the_one_that_was_taken(grasp, yaw):
    middle = np.array([0.4, 0.1, 0.2])
    block = block_in_hand(grasp, grasp.tool(middle, yaw))
    assert np.allclose(block.position, middle)
    assert block.tilt < 1e-6
    assert np.cos(4 * (block.yaw - yaw)) == pytest.approx(1.0)


def test_the_hand_takes_a_block_by_its_middle_first_and_straight_from_above():
    tool = GRASPS[0].tool((0.4, 0.1, 0.2), 0.3)
    assert GRASPS[0] == CENTRED
    assert np.allclose(tool.position, [0.4, 0.1, 0.2])
    assert np.allclose(tool.rotation[:, 2], [0, 0, -1])


@pytest.mark.parametrize("grasp", GRASPS)
def test_the_pads_stay_upright_along_the_sides_of_the_block_and_hold_it_well_inside(grasp):
    """The fingers close along y: level, and across the side of the block."""
    tool = grasp.tool((0.4, 0.1, 0.2), 0.0)
    assert np.allclose(np.abs(tool.rotation[:, 1]), [0, 1, 0])
    assert np.linalg.norm(tool.position - [0.4, 0.1, 0.2]) < SIDE / 4
