"""The simulated world, in every engine: blocks at rest stay, blocks in the air fall, the arm goes where it is sent."""

import xml.etree.ElementTree as ET
from functools import partial

import numpy as np
import pytest

from smash.execution.physics.engines import world_of
from smash.execution.physics.simulated_robot import simulated_robot
from smash.execution.physics.world import STEP
from smash.execution.scene.block_pose import quaternion_of, standing
from smash.execution.scene.scene_file import default_scene
from smash.motion.kinematics import inverse
from smash.motion.poses import top_down, yaw_rotation
from smash.motion.timing import trapezoid
from smash.problem.extras import ENGINES
from tests.robots import PANDA, READY

SCENE = default_scene()
SIDE = SCENE.side


@pytest.fixture(params=ENGINES)
def engine(request):
    """Each engine that is installed, one after the other."""
    pytest.importorskip(ENGINES[request.param])
    return request.param


@pytest.fixture
def opened(engine):
    """A world of the engine, to be opened with blocks and the arm's joints."""
    return partial(world_of(engine), SCENE)


def test_a_block_falls_onto_the_table_and_one_on_another_stays(opened):
    start = {
        "low": standing(0.4, 0.2, SIDE / 2, 0.3),
        "high": standing(0.4, 0.2, 1.5 * SIDE, 0.3),
        "falling": standing(0.4, -0.2, SIDE / 2 + 0.05, 0.0),
    }
    with opened(start, READY) as world:
        assert world.settle()
        assert world.still()
        found = world.poses()
    assert list(found) == list(start)
    for block, height in (("low", SIDE / 2), ("high", 1.5 * SIDE), ("falling", SIDE / 2)):
        assert found[block].position[2] == pytest.approx(height, abs=0.001)
        assert found[block].distance(*start[block].position[:2]) < 0.001


def test_time_goes_in_steps_and_every_step_is_recorded(opened):
    frames = []
    with opened({}, READY, on_frame=lambda world: frames.append(world.time)) as world:
        world.wait(1.0)
        assert world.time == pytest.approx(1.0)
        assert len(world.recorded) == round(1.0 / STEP)
    assert len(frames) == 25


def test_the_arm_follows_a_trajectory_to_its_end_and_the_fingers_open(opened):
    goal = READY + np.array([0.3, 0, 0, 0, 0, 0, 0])
    with opened({}, READY) as world:
        world.follow(trapezoid(PANDA, READY, goal), opening=0.01)
        world.wait(0.5)
        assert np.array_equal(world.commanded(), goal)
        assert world.joints() == pytest.approx(goal, abs=0.005)
        assert world.tool_position() == pytest.approx(PANDA.forward(goal).position, abs=0.005)
        assert world.opening == 0.01


@pytest.mark.parametrize("meant", [frozenset(), frozenset({"a"})])
def test_a_block_that_the_hand_shoves_is_noted_unless_it_is_meant_to(opened, meant):
    lowered = inverse(PANDA, top_down((0.4, 0.0, SIDE / 2), 0.0))[0]
    turned = lowered + np.array([0.4, 0, 0, 0, 0, 0, 0])
    x, y = PANDA.forward(lowered + np.array([0.25, 0, 0, 0, 0, 0, 0])).position[:2]
    blocks = {"a": standing(x, y, SIDE / 2, 0.0), "b": standing(-0.4, 0.0, SIDE / 2, 0.0)}
    with opened(blocks, lowered) as world:
        world.wait(0.1)
        assert world.touched() == []
        world.meant = meant
        world.follow(trapezoid(PANDA, lowered, turned))
        assert world.pose("a").distance(x, y) > 0.02
        assert world.touched() == ([] if meant else ["a"])
        assert world.touched() == []


def test_a_quaternion_of_a_quarter_turn():
    assert quaternion_of(yaw_rotation(np.pi / 2)) == pytest.approx([0, 0, 0.5**0.5, 0.5**0.5])


def test_the_simulators_fingers_are_the_boxes_of_the_collision_checker():
    with simulated_robot(PANDA) as urdf:
        robot = ET.parse(urdf).getroot()
    hand = PANDA.hand
    size = hand.finger[1] - hand.finger[0]
    for link in robot.findall("link"):
        if link.get("name") not in hand.fingers:
            continue
        side = (1, -1)[hand.fingers.index(link.get("name"))]
        (shape,) = link.findall("collision")
        assert [float(part) for part in shape.find("geometry/box").get("size").split()] == pytest.approx(size, abs=1e-5)
        _, y, z = (float(part) for part in shape.find("origin").get("xyz").split())
        assert y * side > 0
        assert z + 0.0584 == pytest.approx(hand.finger[:, 2].mean(), abs=1e-5)


LOWERED = np.array([0.0, 0.14, 0.0, -2.719, 0.0, 2.86, 0.785])
PILE = {name: standing(0.376, 0.137, (level + 0.5) * SIDE, 0.1) for level, name in enumerate("abc")}
SWEPT = (
    (0.3760004524268831, 0.13700783561597465, 0.022489373115714244),
    (0.31997953239603183, 0.26425068581355077, 0.022489999999169848),
    (0.3097084862125108, 0.362785459633262, 0.022489999997163335),
)
"""Where the blocks of `PILE` lie in PyBullet after the sweep, as they did before there was another engine."""


def swept(opened):
    """A world in which the arm has swept the upper part of a pile down."""
    with opened(PILE, LOWERED) as world:
        world.follow(trapezoid(PANDA, LOWERED, LOWERED + np.array([0.8, 0, 0, 0, 0, 0, 0])), opening=0.02)
        world.wait(0.5)
        poses = list(world.poses().values())
        everything = [pose.position for pose in poses] + [pose.rotation for pose in poses]
        return np.concatenate([array.ravel() for array in (*everything, world.joints(), world.links())])


def test_the_same_is_simulated_twice_bit_for_bit(opened):
    assert np.array_equal(swept(opened), swept(opened))


def test_looking_changes_nothing(opened):
    def looked(blocks, ready):
        return opened(blocks, ready, on_frame=lambda world: (world.poses(), world.links(), world.tool_position()))

    assert np.array_equal(swept(looked), swept(opened))


def test_links_and_tool_are_where_the_kinematics_has_them(opened):
    with opened({}, READY) as world:
        world.wait(0.2)
        links, joints = world.links(), world.joints()
        assert links.shape == (10, 7)
        assert np.linalg.norm(links[:, 3:], axis=1) == pytest.approx(1.0)
        assert world.tool_position() == pytest.approx(PANDA.forward(joints).position, abs=1e-4)
        tool = PANDA.forward(joints)
        assert links[7, :3] + PANDA.hand.tool[2] * tool.rotation[:, 2] == pytest.approx(tool.position, abs=1e-4)
        assert world.fingers() == pytest.approx([0.04, 0.04], abs=0.001)
        assert world.torques().shape == (7,)


def test_a_pile_of_nine_does_not_creep(opened):
    start = {str(level): standing(0.45, 0.0, (level + 0.5) * SIDE, 0.2) for level in range(9)}
    with opened(start, READY) as world:
        world.wait(3.0)
        assert max(pose.distance(0.45, 0.0) for pose in world.poses().values()) < 0.001


def test_pybullet_simulates_as_it_did_when_it_was_the_one_engine():
    """Processors differ in the last bits of a motion, and contacts magnify them: 3 mm were seen."""
    pytest.importorskip("pybullet")
    assert swept(partial(world_of("pybullet"), SCENE))[:9] == pytest.approx(np.ravel(SWEPT), abs=0.01)
