"""The arms that come with the package beside the Panda: their data is whole, and they reach the default scene."""

import numpy as np
import pytest

from smash.execution.scene.scene_file import default_scene
from smash.motion.collision import CollisionChecker
from smash.motion.fit_spheres import fitted
from smash.motion.hulls import HullChecker
from smash.motion.kinematics import inverse
from smash.motion.obstacles import Scene
from smash.motion.poses import top_down
from smash.motion.reach import measured_reach
from smash.motion.robots import load_robot, robot_names

ARMS = ("ur5", "xarm7")
NOTHING = Scene.of_boxes([], np.empty((0, 3)), 0.0)


@pytest.fixture(params=ARMS)
def arm(request):
    return load_robot(request.param)


def test_the_arms_are_shipped_each_with_the_hand_of_the_panda():
    assert set(ARMS) <= set(robot_names())
    assert {load_robot(name).hand.name for name in ARMS} == {load_robot("panda").hand.name}


def test_an_arm_begins_with_the_hand_down_in_front_of_it_and_touches_nothing(arm):
    tool = arm.forward(arm.ready)
    assert tool.rotation[:, 2] == pytest.approx([0.0, 0.0, -1.0], abs=1e-3)
    assert tool.position[0] > 0.3
    assert abs(tool.position[1]) < 0.2
    for posture in arm.postures:
        assert CollisionChecker(arm, NOTHING).free(posture)
        assert HullChecker(arm, NOTHING).contact(posture) is None


def test_every_slot_of_the_default_scene_is_reached_the_first_joint_within_a_turn_of_ready(arm):
    scene = default_scene()
    for slot in (*scene.stacks, *scene.buffers):
        (found,) = inverse(arm, top_down((slot.x, slot.y, 4.5 * scene.side), slot.angle))
        assert np.abs(found - arm.ready).max() <= 2 * np.pi
        assert arm.highest(float(np.hypot(slot.x, slot.y))) >= 9 * scene.side


def test_a_motor_holds_the_arm_out_with_force_to_spare(arm):
    import pinocchio

    (out,) = inverse(arm, top_down((0.6, 0.0, 0.1), 0.0))
    holding = np.abs(pinocchio.computeGeneralizedGravity(arm.model, arm.data, out))
    inertia = np.diag(pinocchio.crba(arm.model, arm.data, out))
    assert np.all(holding + 0.5 * arm.acceleration * inertia < arm.force)


def test_the_covers_do_not_call_free_what_the_hulls_call_blocked(arm):
    spheres, hulls = CollisionChecker(arm, NOTHING, margin=0.0), HullChecker(arm, NOTHING)
    lower, upper = np.maximum(arm.lower, -np.pi), np.minimum(arm.upper, np.pi)
    blocked = 0
    for joints in np.random.default_rng(4).uniform(lower, upper, (300, arm.count)):
        contact = hulls.contact(joints)
        pair = set() if contact is None else {contact.part, contact.other}
        if pair and pair != {"base_link", "upper_arm_link"} and "wrist_1_link" not in pair:  # these pairs: hulls alone
            blocked += 1
            assert not spheres.free(joints), contact
    assert blocked > 20


def test_the_reach_of_an_arm_is_what_is_measured(arm):
    radius, level = arm.heights[-1]
    assert dict(measured_reach(arm, (radius,))) == {radius: round(level / 0.045)}


@pytest.mark.slow
def test_the_spheres_of_an_arm_are_what_is_fitted(arm):
    assert fitted(arm) == arm.spheres.read_text()
