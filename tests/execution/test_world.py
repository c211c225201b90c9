"""The simulated world: blocks at rest stay, blocks in the air fall, the arm goes where it is sent."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from smash.execution.physics.simulated_robot import FINGER_SIDES, simulated_panda
from smash.execution.physics.world import STEP, World, quaternion_of
from smash.execution.scene.block_pose import standing
from smash.execution.scene.scene_file import default_scene
from smash.motion.collision import FINGER_CORNERS, FINGER_JOINT_Z
from smash.motion.kinematics import inverse
from smash.motion.poses import top_down, yaw_rotation
from smash.motion.robot import READY, panda
from smash.motion.timing import trapezoid

SCENE = default_scene()
SIDE = SCENE.side


def test_a_block_falls_onto_the_table_and_one_on_another_stays():
    start = {
        "low": standing(0.4, 0.2, SIDE / 2, 0.3),
        "high": standing(0.4, 0.2, 1.5 * SIDE, 0.3),
        "falling": standing(0.4, -0.2, SIDE / 2 + 0.05, 0.0),
    }
    with World(SCENE, start, READY) as world:
        assert world.settle()
        assert world.still()
        found = world.poses()
    assert list(found) == list(start)
    for block, height in (("low", SIDE / 2), ("high", 1.5 * SIDE), ("falling", SIDE / 2)):
        assert found[block].position[2] == pytest.approx(height, abs=0.001)
        assert found[block].distance(*start[block].position[:2]) < 0.001


def test_time_goes_in_steps_and_every_step_is_recorded():
    frames = []
    with World(SCENE, {}, READY, on_frame=lambda world: frames.append(world.time)) as world:
        world.wait(1.0)
        assert world.time == pytest.approx(1.0)
        assert len(world.recorded) == round(1.0 / STEP)
    assert len(frames) == 25


def test_the_arm_follows_a_trajectory_to_its_end_and_the_fingers_open():
    goal = READY + np.array([0.3, 0, 0, 0, 0, 0, 0])
    with World(SCENE, {}, READY) as world:
        world.follow(trapezoid(READY, goal), opening=0.01)
        world.wait(0.5)
        assert np.array_equal(world.commanded(), goal)
        assert world.joints() == pytest.approx(goal, abs=0.005)
        assert world.tool_position() == pytest.approx(panda().forward(goal).position, abs=0.005)
        assert world.opening == 0.01


@pytest.mark.parametrize("meant", [frozenset(), frozenset({"a"})])
def test_a_block_that_the_hand_shoves_is_noted_unless_it_is_meant_to(meant):
    lowered = inverse(top_down((0.4, 0.0, SIDE / 2), 0.0))[0]
    turned = lowered + np.array([0.4, 0, 0, 0, 0, 0, 0])
    x, y = panda().forward(lowered + np.array([0.25, 0, 0, 0, 0, 0, 0])).position[:2]
    blocks = {"a": standing(x, y, SIDE / 2, 0.0), "b": standing(-0.4, 0.0, SIDE / 2, 0.0)}
    with World(SCENE, blocks, lowered) as world:
        world.wait(0.1)
        assert world.touched() == []
        world.meant = meant
        world.follow(trapezoid(lowered, turned))
        assert world.pose("a").distance(x, y) > 0.02
        assert world.touched() == ([] if meant else ["a"])
        assert world.touched() == []


def test_a_quaternion_of_a_quarter_turn():
    assert quaternion_of(yaw_rotation(np.pi / 2)) == pytest.approx([0, 0, 0.5**0.5, 0.5**0.5])


def test_the_simulators_fingers_are_the_boxes_of_the_collision_checker():
    with simulated_panda() as urdf:
        robot = ET.parse(urdf).getroot()
    size = FINGER_CORNERS[1] - FINGER_CORNERS[0]
    for link in robot.findall("link"):
        side = FINGER_SIDES.get(link.get("name"))
        if side is None:
            continue
        (shape,) = link.findall("collision")
        assert [float(part) for part in shape.find("geometry/box").get("size").split()] == pytest.approx(size, abs=1e-5)
        _, y, z = (float(part) for part in shape.find("origin").get("xyz").split())
        assert y * side > 0
        assert z + FINGER_JOINT_Z == pytest.approx(FINGER_CORNERS[:, 2].mean(), abs=1e-5)
