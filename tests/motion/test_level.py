"""Level ways and timed motions."""

from itertools import pairwise
from math import acos

import numpy as np
import pytest

from smash.motion.kinematics import inverse
from smash.motion.level import FRICTION_SHARE, GRAVITY, Gentleness, level_way
from smash.motion.move import Move
from smash.motion.obstacles import Attached, HandState, Scene
from smash.motion.planner import MotionPlanner
from smash.motion.poses import top_down
from smash.motion.timing import time_path
from smash.problem.errors import ExecutionFailure
from tests.robots import PANDA, READY

EMPTY = Scene.of_boxes([], np.empty((0, 3)), 0.0)
HELD = HandState(0.0225, Attached.cube(0.045))
MANNER = Gentleness(1.5, 0.4)


def way(scene=EMPTY):
    start = inverse(PANDA, top_down([0.45, -0.2, 0.2], 0.0))[0]
    return level_way(MotionPlanner(PANDA), start, top_down([0.3, 0.35, 0.25], 0.6), scene, HELD, frozenset(), MANNER)


def test_a_load_is_accelerated_by_a_share_of_what_friction_bears():
    assert Gentleness.of_friction(0.5, 0.8).acceleration == pytest.approx(FRICTION_SHARE * 0.4 * GRAVITY)


def test_a_level_way_is_in_one_piece_does_not_tilt_and_ends_at_the_target():
    moves = way()
    assert all(np.allclose(one.path.end, other.path.start) for one, other in pairwise(moves))
    tool = [PANDA.forward(joints) for move in moves for joints in move.trajectory.sample(0.02)]
    assert max(acos(min(1.0, -pose.rotation[2, 2])) for pose in tool) < 0.01
    target = top_down([0.3, 0.35, 0.25], 0.6)
    assert tool[-1].position == pytest.approx(target.position, abs=1e-4)
    assert np.allclose(tool[-1].rotation, target.rotation, atol=1e-3)


def test_a_level_way_keeps_the_speed_of_its_manner():
    step = 0.01
    for move in way():
        points = np.array([PANDA.forward(joints).position for joints in move.trajectory.sample(step)])
        speeds = np.linalg.norm(np.diff(points, axis=0), axis=1) / step
        assert speeds.max(initial=0.0) <= 1.02 * MANNER.speed


def test_a_target_that_is_walled_in_is_a_named_failure():
    wall = Scene.of_boxes(["w"], [[0.3, 0.35, 0.25]], 0.04)
    with pytest.raises(ExecutionFailure):
        way(wall)


def straight(hand, margin=0.01):
    path = MotionPlanner(PANDA).plan(READY, READY + np.array([0.5, 0, 0, 0, 0, 0, 0]), EMPTY)
    return Move(PANDA, path, time_path(PANDA, path), hand, frozenset(["mine"]), margin)


def test_fingers_are_sent_shut_where_they_hold_something():
    assert straight(HandState(0.03)).opening == 0.03
    assert straight(HELD).opening == 0.0


def test_a_motion_is_good_in_another_scene_while_nothing_it_may_not_touch_is_in_its_way():
    move = straight(HandState(0.0))
    middle = PANDA.forward(move.path.waypoints.mean(axis=0)).position
    assert move.free(Scene.of_boxes(["mine"], [middle], 0.02), 0.0)
    assert not move.free(Scene.of_boxes(["other"], [middle], 0.02), 0.0)


@pytest.mark.parametrize(("gap", "allowance", "good"), [(0.005, 0.0, False), (0.005, 0.007, True), (0.02, 0.0, True)])
def test_an_allowance_lets_things_come_closer_than_the_motion_was_planned_to_keep(gap, allowance, good):
    """A plate `gap` below the fingertips, half of the way along; the motion was planned to keep 10 mm."""
    move = straight(HandState(0.0), margin=0.01)
    x, y, z = PANDA.forward(move.path.waypoints.mean(axis=0)).position
    top = z - PANDA.hand.tip - gap
    plate = Scene.of_boxes(["plate"], [[x, y, top - 0.01]], [[0.03, 0.03, 0.01]])
    assert move.free(plate, allowance) == good
