import numpy as np
import pytest

from smash.execution.trials.motion_benchmark import run, touching
from smash.motion.collision import CollisionChecker
from smash.motion.errors import NoMotion
from smash.motion.hulls import HullChecker
from smash.motion.kinematics import inverse
from smash.motion.obstacles import Scene
from smash.motion.planner import MotionPlanner
from smash.motion.poses import top_down
from tests.motion.towers import SIDE, tower_scene
from tests.robots import PANDA, READY


def above(angle, height):
    return inverse(PANDA, top_down([0.45 * np.cos(angle), 0.45 * np.sin(angle), height], angle))[0]


def test_a_free_way_is_a_straight_joint_segment():
    path = MotionPlanner(PANDA).plan(READY, above(0.5, 0.3), tower_scene({-0.5: 2}))
    assert path.kind == "straight"
    assert np.array_equal(path.start, READY)


def test_a_tower_in_the_way_is_passed_and_the_same_seed_passes_it_the_same_way():
    scene = tower_scene({0.0: 9})
    start, goal = above(-0.5, 0.1), above(0.5, 0.1)
    assert not CollisionChecker(PANDA, scene).segment_free(start, goal)
    path = MotionPlanner(PANDA, seed=3).plan(start, goal, scene)
    MotionPlanner(PANDA, seed=9).plan(goal, start, scene)
    again = MotionPlanner(PANDA, seed=3).plan(start, goal, scene)
    assert path.kind == "tree"
    assert np.array_equal(path.waypoints, again.waypoints)
    assert CollisionChecker(PANDA, scene).path_free(path.waypoints)
    assert np.array_equal(path.start, start)
    assert np.array_equal(path.end, goal)


def test_a_blocked_goal_is_no_motion_and_names_the_block():
    scene = tower_scene({0.0: 3})
    with pytest.raises(NoMotion, match=r"the goal is closer than 10 mm to block '0\.0/2'") as caught:
        MotionPlanner(PANDA).plan(READY, above(0.0, SIDE * 3), scene)
    assert caught.value.failure == "no motion"


def test_a_line_through_a_tower_is_refused():
    scene = tower_scene({0.0: 9})
    with pytest.raises(NoMotion, match="is blocked by block"):
        MotionPlanner(PANDA).line(above(-0.4, 0.2), (0.0, 0.35, 0.0), scene)


def test_rounded_corners_stay_free_and_keep_the_ends():
    scene = tower_scene({0.0: 9})
    path = MotionPlanner(PANDA, seed=1).plan(above(-0.5, 0.1), above(0.5, 0.1), scene)
    turns = np.diff(path.waypoints, axis=0)
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    assert np.degrees(np.arccos(np.clip(np.sum(turns[1:] * turns[:-1], axis=1), -1, 1))).max() < 90
    assert HullChecker(PANDA, scene, None, 0.003).contact(path.waypoints) is None


def test_an_empty_scene_and_a_motion_to_where_the_arm_is():
    empty = Scene.of_boxes([], np.empty((0, 3)), 0.0)
    path = MotionPlanner(PANDA).plan(READY, READY, empty)
    assert path.length == 0.0


def test_of_several_goals_the_nearest_free_one_is_taken():
    scene = tower_scene({0.0: 3})
    goals = np.stack([above(0.0, SIDE * 3), above(0.6, 0.3), above(1.6, 0.3)])
    assert np.array_equal(MotionPlanner(PANDA).plan(READY, goals, scene).end, goals[1])


@pytest.mark.slow
def test_random_picks_places_and_pushes_are_mostly_straight_and_touch_nothing():
    tally = run(tables=40, blocks=9, seed=2)
    assert touching(tally) == 0
    assert tally.kinds["straight"] >= 0.6 * sum(tally.kinds.values())
    assert sum(tally.failures.values()) <= 4


@pytest.mark.timing
def test_a_motion_of_a_pick_is_found_within_40_milliseconds_every_second_time():
    assert np.median(run(tables=10, blocks=9, seed=2).seconds["a motion of a pick"]) < 0.04
