import numpy as np
import pinocchio

from smash.motion.descent import descent, pose_error, tool_jacobian
from smash.motion.kernel import link_frames
from tests.robots import PANDA


def configurations(count, seed=3):
    return np.random.default_rng(seed).uniform(PANDA.lower, PANDA.upper, (count, PANDA.count))


def test_the_compiled_jacobian_is_pinocchio_s():
    arm, chain = PANDA, PANDA.chain
    for joints in configurations(50):
        known = pinocchio.computeFrameJacobian(arm.model, arm.data, joints, arm.tool, pinocchio.LOCAL)
        assert np.allclose(tool_jacobian(link_frames(chain, joints)), known, atol=1e-10)


def test_the_error_of_a_pose_is_the_logarithm_of_the_motion_to_it():
    generator = np.random.default_rng(4)
    for angle in (0.0, 1e-9, 1e-4, 0.3, 2.0, 3.0, np.pi - 1e-6):
        for _ in range(20):
            axis, place = generator.normal(size=3), generator.normal(size=3)
            here = pinocchio.SE3(pinocchio.exp3(generator.normal(size=3)), generator.normal(size=3))
            turn = pinocchio.exp3(angle * axis / np.linalg.norm(axis))
            there = pinocchio.SE3(here.rotation @ turn, place)
            error = pose_error(
                np.ascontiguousarray(here.homogeneous[:3]), np.ascontiguousarray(there.rotation), there.translation
            )
            assert np.allclose(error, pinocchio.log6(here.actInv(there)).vector, atol=1e-7)


def test_a_descent_that_says_so_has_reached_its_target_within_the_limits():
    arm, chain = PANDA, PANDA.chain
    ends = []
    for start, goal in zip(configurations(40), configurations(40, seed=5), strict=True):
        target = arm.forward(goal)
        reached, joints = descent(
            chain, PANDA.lower, PANDA.upper, np.ascontiguousarray(target.rotation), target.position, start, 40
        )
        assert np.all(joints >= PANDA.lower)
        assert np.all(joints <= PANDA.upper)
        ends.append(reached)
        if reached:
            end = arm.forward(joints)
            assert np.allclose(end.position, target.position, atol=1e-4)
            assert np.allclose(end.rotation, target.rotation, atol=1e-4)
    assert any(ends)
