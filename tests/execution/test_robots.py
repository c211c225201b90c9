"""Another arm at the same table: worlds, refusals before anything moves, what is written of it."""

import dataclasses
from itertools import product

import numpy as np
import pytest

from smash.execution.ability import require_able
from smash.execution.actions.arm_motions import ArmMotions, Move
from smash.execution.actions.pick_and_place import PickAndPlace
from smash.execution.executor import Executor
from smash.execution.physics.engines import engine_of, world_of
from smash.execution.policy import OPEN
from smash.execution.scene.block_pose import standing
from smash.execution.scene.block_size import FOOTPRINTS, HEIGHTS, BlockSize, unfit
from smash.execution.scene.piles import needs_of
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


def test_motors_in_mujoco_turn_as_the_file_says_and_the_fingers_move_as_one(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    from smash.execution.physics import mujoco_model

    path = written(tmp_path)
    urdf = tmp_path / "panda-hand" / "panda-hand.urdf"
    urdf.write_text(urdf.read_text().replace('<mimic joint="panda_finger_joint1"/>', ""))
    model = mujoco_model.build(scene_of(None, robot=path), {}, {}, {})
    robot = load_robot(path)
    for name, force in zip(robot.joints, robot.force, strict=True):
        assert model.jnt_actfrcrange[model.joint(name).id].tolist() == [-force, force]
    assert model.neq == 1
    data = mujoco.MjData(model)
    left, right = (model.joint(name) for name in robot.hand.joints)
    data.qpos[[left.qposadr[0], right.qposadr[0]]] = 0.03
    data.ctrl[model.actuator(left.name).id] = 0.03
    mujoco.mj_step(model, data, 200)
    assert data.qpos[left.qposadr[0]] == pytest.approx(data.qpos[right.qposadr[0]], abs=0.001)


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
    scene.write_text(scene.read_text().replace("seven.toml", "seven"))
    with pytest.raises(MalformedFile, match=r"scene\.toml: robot: there is none called 'seven'"):
        read_scene(scene)


STACKS = '[[stacks]]\nradius = 0.45\nangle = 0\ntopple = ["clockwise"]\n'


def test_the_panda_by_name_is_the_scene_as_it_was():
    assert scene_of(None, robot="panda").fingerprint == default_scene().fingerprint
    with pytest.raises(SmashError, match="there is none called 'r2d2'"):
        scene_of(None, robot="r2d2")


def test_piles_out_of_the_arm_s_reach_are_named_before_anything_moves(path):
    instance, plan = swapped_pair(), swapped_plan()
    law, robot, scene = Law(instance), load_robot(path), default_scene()
    needs = needs_of(law, plan.actions)
    assert needs.highest == {"s2": 2}
    require_able(robot, scene, plan.actions, needs, {"s2": Slot(0.45, 0.0, ("clockwise",))})
    words = r"robot 'six' does not reach 2 blocks at 's2' of scene 'default', 0.90 m from its base; "
    with pytest.raises(DoesNotFit, match=words + "it reaches 12 from 0.20 to 0.50 m, 6 from 0.70 to 0.70 m"):
        require_able(robot, scene, plan.actions, needs, {"s2": Slot(0.90, 0.0, ("clockwise",))})


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("opening = 0.04", "opening = 0.02", "it is 0.045 m wide, and 0.03 m fit between the open fingers"),
        ("[0.0317, 0.1005, 0.0661]", "[0.0317, 0.1005, 0.0850]", "it is 0.045 m high, and the palm is 0.02 m above"),
        ("tip = 0.0072", "tip = 0.03", "it is 0.045 m high, and the fingertips are 0.03 m below"),
    ],
)
def test_a_hand_that_cannot_hold_the_blocks_of_a_scene_is_refused(tmp_path, before, after, words):
    path = written(tmp_path, hand=[(before, after)])
    with pytest.raises(DoesNotFit, match="hand 'panda_hand' does not hold a block of scene 'default'") as refusal:
        scene_of(None, robot=path)
    assert words in str(refusal.value)


def test_a_named_block_that_a_hand_cannot_hold_is_named(tmp_path):
    path = written(tmp_path, hand=[("opening = 0.04", "opening = 0.02")])
    scene = dataclasses.replace(default_scene(), side=0.03, sizes={"b": default_scene().block})
    with pytest.raises(DoesNotFit, match="does not hold block 'b' of scene 'default'"):
        scene.with_robot(str(path))


def test_blocks_that_the_hand_cannot_hold_are_refused_where_it_is_used():
    instance, plan = swapped_pair(), swapped_plan()
    scene = dataclasses.replace(default_scene(), sizes={"b1": BlockSize(0.09, 0.045, 0.1)})
    with pytest.raises(DoesNotFit, match=r"hand 'panda_hand' does not hold block 'b1' .* it is 0.09 m wide"):
        Executor(instance, plan, scene, engine=engine_of(scene))


def test_the_panda_s_hand_holds_whatever_a_scene_may_have():
    for footprint, height in product(FOOTPRINTS, HEIGHTS):
        assert unfit(BlockSize(footprint, height, 0.1), load_robot().hand) is None


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
    hyphened = dataclasses.replace(robot, name="my-arm")
    assert arm_topic(hyphened) == "/my_arm_arm_controller/joint_trajectory"
    samples = [(step / 480, robot.ready, 0.04) for step in range(1, 20)]
    write_trajectory(tmp_path / "t.csv", robot.joints, thinned(samples))
    assert (tmp_path / "t.csv").read_text().startswith("time,pan,lift,elbow,wrist1,wrist2,wrist3,finger_opening\n")
    assert read_trajectory(tmp_path / "t.csv")[1].shape[1] == 6


def test_the_tray_is_made_for_the_hand_that_takes_it(tmp_path):
    thick = written(tmp_path, hand=[("palm = [[-0.0317", "palm = [[-0.0417"), ("[0.0317, 0.1005", "[0.0417, 0.1005")])
    usual, wide = scoop_scene(), scoop_scene().with_robot(str(thick))
    assert wide.tray.size[0] == pytest.approx(usual.tray.size[0] + 2 * 0.010)
