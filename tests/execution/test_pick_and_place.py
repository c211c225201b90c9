"""Ways down to blocks and places: what makes the hand choose another one."""

import numpy as np
import pytest

from smash.execution.actions import pick_and_place
from smash.execution.actions.arm_motions import RELEASE_HEIGHT, ArmMotions
from smash.execution.actions.grasps import CENTRED, GRASPS
from smash.execution.actions.pick_and_place import ROOM, PickAndPlace
from smash.execution.performing import follow
from smash.execution.physics.engines import engine_of, world_of
from smash.execution.scene.block_pose import QUARTER, BlockPose, standing
from smash.execution.scene.scene_file import default_scene
from smash.motion.collision import CONTACT_MARGIN, CollisionChecker
from smash.motion.errors import NoMotion
from smash.motion.kinematics import inverse
from smash.motion.move import Move
from smash.motion.obstacles import HandState
from tests.robots import PANDA, READY

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
    lift = [segment for segment in hand.pick(READY, "a", block, scene)[0] if isinstance(segment, Move)][-1]
    assert lift.hand.attached is not None
    assert lift.free(scene, 0.0)


def test_a_block_under_a_leaning_one_is_picked_all_the_same(arm, hand):
    slot = default_scene().stacks[1]
    block = standing(slot.x, slot.y, SIDE / 2, 0.0)
    turn = np.array([[np.cos(0.5), 0, np.sin(0.5)], [0, 1, 0], [-np.sin(0.5), 0, np.cos(0.5)]])
    leaning = BlockPose(np.array([slot.x + 0.048, slot.y, 0.035]), turn)
    assert hand.pick(READY, "a", block, arm.scene({"a": block, "b": leaning}))[0]


def tower_beside(away, levels=9):
    """A block at a stack's place, and a tower whose middle is `away` from it."""
    slot = default_scene().stacks[1]
    block = standing(slot.x, slot.y, SIDE / 2, slot.angle)
    x, y = slot.point(away, 0.0, "counter-clockwise")
    walls = {f"w{level}": standing(x, y, (level + 0.5) * SIDE, slot.angle) for level in range(levels)}
    return block, walls


@pytest.mark.parametrize("away", [0.050, 0.055, 0.060])
def test_a_block_at_the_foot_of_a_tower_is_taken_beside_its_middle_and_put_down_in_its_place(arm, hand, away):
    block, walls = tower_beside(away)
    scene = arm.scene({"a": block, **walls})
    segments, grasp = hand.pick(READY, "a", block, scene)
    moves = [segment for segment in segments if isinstance(segment, Move)]
    assert all(move.free(scene, 0.0) for move in moves)
    target = standing(*default_scene().stacks[2].point(0.0, 0.0, "outward"), 1.5 * SIDE, 0.2)
    way = hand.landing(moves[-1].path.end, "a", target, scene, grasp)
    tool = PANDA.forward(way.line.end)
    held = grasp.hand(SIDE).attached
    stands = tool.position + tool.rotation @ held.translations[0]
    assert way.grasp == grasp
    assert np.allclose(stands[:2], target.position[:2], atol=1e-4)
    assert stands[2] == pytest.approx(target.position[2] + RELEASE_HEIGHT, abs=1e-4)


@pytest.mark.parametrize(("grasp", "levels"), [(GRASPS[2], 1), (GRASPS[4], 5)])
def test_a_block_held_beside_its_middle_or_leaning_stands_where_it_shall_then(arm, hand, grasp, levels, monkeypatch):
    """In physics; what stands beside it stays. Beside a tower the wrist has no room but for a hand that leans."""
    monkeypatch.setattr(pick_and_place, "GRASPS", (grasp,))
    block, walls = tower_beside(0.058, levels)
    target = standing(*default_scene().stacks[2].point(0.0, 0.0, "outward"), 0.5 * SIDE, 0.2)
    with world_of(engine_of(default_scene()))(default_scene(), {"a": block, **walls}, READY) as world:
        world.settle()
        segments, held = hand.pick(READY, "a", world.pose("a"), arm.scene(world.poses()))
        follow(world, segments)
        scene = arm.scene(world.poses())
        way = hand.landing(world.commanded(), "a", target, scene, held)
        follow(world, hand.place(world.commanded(), "a", way, scene))
        world.settle()
        assert held == grasp
        assert world.touched() == []
        assert np.linalg.norm(world.pose("a").position - target.position) < 0.003
        assert world.pose("a").tilt < 0.02
        assert all(np.linalg.norm(world.pose(b).position - pose.position) < 0.002 for b, pose in walls.items())


def test_a_block_that_stands_free_is_taken_by_its_middle(arm, hand):
    block = standing(0.45, 0.1, SIDE / 2, 0.3)
    assert hand.pick(READY, "a", block, arm.scene({"a": block}))[1] == CENTRED


def test_a_block_at_the_foot_of_a_tower_has_no_centred_grasp(arm):
    """So that the grasps beside the middle are what helps."""
    block, walls = tower_beside(0.050)
    scene = arm.scene(walls)
    hands = [CENTRED.tool(block.position, block.yaw + turn * QUARTER) for turn in range(4)]
    checker = CollisionChecker(PANDA, scene, HandState(min(arm.openings)), CONTACT_MARGIN)
    assert not any(checker.free(joints) for tool in hands for joints in inverse(PANDA, tool, READY, count=3))


@pytest.mark.parametrize("yaw", np.linspace(0.0, np.pi / 2, 7))
@pytest.mark.parametrize("away", [0.049, 0.055, 0.061, 0.067])
def test_the_open_hand_comes_down_beside_neighbours_and_not_on_their_edges(arm, hand, yaw, away):
    """Where any grasp has room, none is taken that grazes."""
    block = standing(0.35, 0.25, SIDE / 2, 0.2)
    scene = arm.scene({"a": block, "b": standing(0.35 + away, 0.25, SIDE / 2, yaw)})
    segments, _ = hand.pick(READY, "a", block, scene)
    down = [segment for segment in segments if isinstance(segment, Move)][-2]
    assert CollisionChecker(PANDA, scene.without(["a"]), down.hand, ROOM - 1e-6).free(down.path.end)
