import numpy as np
import pytest

from smash.execution.collision import CollisionChecker
from smash.execution.errors import NoMotion
from smash.execution.kinematics import solve
from smash.execution.motion import MotionPlanner
from smash.execution.motion_benchmark import run, touching
from smash.execution.poses import top_down
from smash.execution.robot import READY, panda
from smash.execution.scene import Attached, HandState, Scene
from tests.execution.towers import SIDE, tower_scene

OPEN = HandState(SIDE / 2 + 0.01)


def above(angle, height):
    return solve(top_down([0.45 * np.cos(angle), 0.45 * np.sin(angle), height], angle))


def test_a_free_way_is_a_straight_joint_segment():
    path = MotionPlanner().plan(READY, above(0.5, 0.3), tower_scene({-0.5: 2}))
    assert path.kind == "straight"
    assert np.array_equal(path.start, READY)


def test_a_tower_in_the_way_is_passed_and_the_same_seed_passes_it_the_same_way():
    scene = tower_scene({0.0: 9})
    start, goal = above(-0.5, 0.1), above(0.5, 0.1)
    assert not CollisionChecker(scene).segment_free(start, goal)
    path = MotionPlanner(seed=3).plan(start, goal, scene)
    MotionPlanner(seed=9).plan(goal, start, scene)
    again = MotionPlanner(seed=3).plan(start, goal, scene)
    assert path.kind == "tree"
    assert np.array_equal(path.waypoints, again.waypoints)
    assert CollisionChecker(scene).path_free(path.waypoints)
    assert np.array_equal(path.start, start)
    assert np.array_equal(path.end, goal)


def test_a_blocked_goal_is_no_motion_and_names_the_block():
    scene = tower_scene({0.0: 3})
    with pytest.raises(NoMotion, match=r"the goal is closer than 10 mm to block '0\.0/2'") as caught:
        MotionPlanner().plan(READY, above(0.0, SIDE * 3), scene)
    assert caught.value.failure == "no motion"


def test_the_fingers_reach_around_the_block_to_grasp_and_lift_it_away():
    scene = tower_scene({0.0: 3, 0.7: 1})
    block = "0.0/2"
    pose = top_down([0.45, 0.0, SIDE * 2.5], 0.0)
    planner = MotionPlanner()
    reach = planner.reach(READY, [pose], scene, hand=OPEN, contact_scene=scene.without([block]))
    assert np.allclose(panda().forward(reach.approach.end).position, pose.position, atol=1e-4)
    held = HandState(SIDE / 2, Attached.cube(SIDE))
    lift = planner.line(reach.approach.end, (0.0, 0.0, 0.1), scene.without([block]), hand=held)
    place = top_down([0.45 * np.cos(0.7), 0.45 * np.sin(0.7), SIDE * 1.5], 0.7)
    set_down = planner.reach(lift.end, [place], scene.without([block]), hand=held)
    assert np.allclose(panda().forward(set_down.approach.end).position, place.position, atol=1e-4)


def test_a_line_through_a_tower_is_refused():
    scene = tower_scene({0.0: 9})
    with pytest.raises(NoMotion, match="is blocked by block"):
        MotionPlanner().line(above(-0.4, 0.2), (0.0, 0.35, 0.0), scene)


def test_rounded_corners_stay_free_and_keep_the_ends():
    scene = tower_scene({0.0: 9})
    path = MotionPlanner(seed=1).plan(above(-0.5, 0.1), above(0.5, 0.1), scene)
    turns = np.diff(path.waypoints, axis=0)
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    assert np.degrees(np.arccos(np.clip(np.sum(turns[1:] * turns[:-1], axis=1), -1, 1))).max() < 90
    assert MotionPlanner().contact(path.waypoints, scene) is None


def test_an_empty_scene_and_a_motion_to_where_the_arm_is():
    empty = Scene.of_boxes([], np.empty((0, 3)), 0.0)
    path = MotionPlanner().plan(READY, READY, empty)
    assert path.length == 0.0


def test_of_several_goals_the_nearest_free_one_is_taken():
    scene = tower_scene({0.0: 3})
    goals = np.stack([above(0.0, SIDE * 3), above(0.6, 0.3), above(1.6, 0.3)])
    assert np.array_equal(MotionPlanner().plan(READY, goals, scene).end, goals[1])


@pytest.mark.slow
def test_random_picks_places_and_pushes_are_fast_mostly_straight_and_touch_nothing():
    tally = run(tables=40, blocks=9, seed=2)
    assert touching(tally) == 0
    assert tally.kinds["straight"] >= 0.6 * sum(tally.kinds.values())
    assert np.median(tally.seconds["free motion"]) < 0.02
    assert sum(tally.failures.values()) <= 4
