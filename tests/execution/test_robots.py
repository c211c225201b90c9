"""Another arm at the same table: worlds, refusals before anything moves, what is written of it."""

import dataclasses

import numpy as np
import pytest

from smash.execution.ability import highest_piles, require_able
from smash.execution.actions.arm_motions import ArmMotions, Move
from smash.execution.actions.pick_and_place import PickAndPlace
from smash.execution.executor import Executor
from smash.execution.physics.engines import engine_of, world_of
from smash.execution.policy import OPEN
from smash.execution.scene.block_pose import standing
from smash.execution.scene.scene_file import default_scene, read_scene, scene_of
from smash.execution.scene.tabletop import DoesNotFit, Slot
from smash.execution.viewing.recording import Recording
from smash.execution.viewing.ros_bag import arm_topic, hand_topic
from smash.execution.viewing.trajectory_file import read_trajectory, thinned, write_trajectory
from smash.motion.robots import load_robot
from smash.motion.timing import trapezoid
from smash.problem import Carry, Law
from smash.problem.errors import MalformedFile, SmashError, Unsupported
from smash.problem.extras import ENGINES
from tests.execution.episodes import plan_of, swapped_pair, swapped_plan
from tests.execution.scooping import scoop, scoop_scene
from tests.six_joints import written

SIDE = default_scene().side


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return written(tmp_path_factory.mktemp("six"))


@pytest.fixture(params=ENGINES)
def engine(request):
    """Each engine that is installed, one after the other."""
    pytest.importorskip(ENGINES[request.param])
    return request.param


def test_an_arm_of_six_joints_goes_where_it_is_sent_in_every_engine(path, engine):
    scene = scene_of(None, robot=path)
    robot, recording = load_robot(scene.robot), Recording()
    goal = robot.ready + 0.3 * robot.first_joint
    with world_of(engine)(scene, {"a": standing(0.4, 0.3, SIDE / 2, 0.1)}, robot.ready) as world:
        recording.take(world)
        world.follow(trapezoid(robot, robot.ready, goal), opening=0.01)
        world.wait(0.5)
        assert world.joints() == pytest.approx(goal, abs=0.01)
        assert world.tool_position() == pytest.approx(robot.forward(goal).position, abs=0.005)
        assert world.fingers() == pytest.approx([0.01, 0.01], abs=0.001)
        assert world.links().shape == (9, 7)
        assert world.torques().shape == (6,)
        assert np.abs(world.torques()).max() < robot.force.max()
    assert recording.joints[0].shape == (8,)


def test_a_block_is_taken_by_friction_whatever_arm_the_hand_is_on(path, engine):
    scene = scene_of(None, robot=path)
    arm = ArmMotions(scene)
    block = standing(0.4, 0.2, SIDE / 2, 0.3)
    with world_of(engine)(scene, {"a": block}, arm.robot.ready) as world:
        segments, _ = PickAndPlace(arm).pick(arm.robot.ready, "a", block, arm.scene({"a": block}))
        for segment in segments:
            if isinstance(segment, Move):
                world.follow(segment.trajectory, segment.opening)
            else:
                world.grip(segment.opening, segment.seconds)
        world.wait(0.1)
        assert world.pose("a").position[2] > 0.07


@pytest.mark.slow
def test_an_episode_of_six_joints_succeeds_and_says_whose_it_is(path, engine):
    scene = scene_of(None, robot=path)
    episode = Executor(swapped_pair(), swapped_plan(), scene, policy=OPEN, engine=engine).run()
    assert episode.success, episode.failure
    assert episode.robot == load_robot(path).label


def test_a_scene_names_its_robot_beside_it(path, tmp_path):
    scene = path.parent / "scene.toml"
    scene.write_text('format = "smash-scene/1"\nname = "sixth"\nbase = "default"\nrobot = "six.toml"\n' + STACKS)
    table = read_scene(scene)
    assert ArmMotions(table).robot is load_robot(path)
    assert table.fingerprint != dataclasses.replace(table, robot=None).fingerprint
    scene.write_text(scene.read_text().replace("six.toml", "seven.toml"))
    with pytest.raises(MalformedFile, match=r"seven\.toml: cannot be read"):
        read_scene(scene)


STACKS = '[[stacks]]\nradius = 0.45\nangle = 0\ntopple = ["clockwise"]\n'


def test_the_panda_by_name_is_the_scene_as_it_was():
    assert scene_of(None, robot="panda").fingerprint == default_scene().fingerprint
    with pytest.raises(SmashError, match="there is none called 'r2d2'"):
        scene_of(None, robot="r2d2")


def test_piles_out_of_the_arm_s_reach_are_named_before_anything_moves(path):
    instance, plan = swapped_pair(), swapped_plan()
    law, robot, scene = Law(instance), load_robot(path), default_scene()
    assert highest_piles(law, plan.actions) == {"s2": 2}
    require_able(robot, scene, law, plan.actions, {"s2": Slot(0.45, 0.0, ("clockwise",))})
    words = r"robot 'six' does not reach 2 blocks at 's2' of scene 'default', 0.90 m from its base; "
    with pytest.raises(DoesNotFit, match=words + "it reaches 12 from 0.20 to 0.50 m, 6 from 0.70 to 0.70 m"):
        require_able(robot, scene, law, plan.actions, {"s2": Slot(0.90, 0.0, ("clockwise",))})


def test_an_arm_that_cannot_turn_about_the_vertical_carries_nothing(tmp_path):
    path = written(tmp_path, arm=[('xyz="0 0 0.15" rpy="0 0 0"/>', 'xyz="0 0 0.15" rpy="0.1 0 0"/>')])
    instance = scoop()
    plan = plan_of("scoop", Carry("tray", "right"), Carry("tray", "left"))
    engine = engine_of(default_scene())
    with pytest.raises(Unsupported, match="which carry needs"):
        Executor(instance, plan, scoop_scene().with_robot(str(path)), engine=engine)


def test_files_of_an_episode_are_of_its_robot(path, tmp_path):
    robot = load_robot(path)
    assert (arm_topic(robot), hand_topic(robot)) == (
        "/six_arm_controller/joint_trajectory",
        "/panda_hand_controller/joint_trajectory",
    )
    samples = [(step / 480, robot.ready, 0.04) for step in range(1, 20)]
    write_trajectory(tmp_path / "t.csv", robot.joints, thinned(samples))
    assert (tmp_path / "t.csv").read_text().startswith("time,pan,lift,elbow,wrist1,wrist2,wrist3,finger_opening\n")
    assert read_trajectory(tmp_path / "t.csv")[1].shape[1] == 6


def test_the_tray_is_made_for_the_hand_that_takes_it(tmp_path):
    thick = written(tmp_path, hand=[("palm = [[-0.0317", "palm = [[-0.0417"), ("[0.0317, 0.1005", "[0.0417, 0.1005")])
    usual, wide = scoop_scene(), scoop_scene().with_robot(str(thick))
    assert wide.tray.size[0] == pytest.approx(usual.tray.size[0] + 2 * 0.010)
