import numpy as np

from smash.motion.kinematics import along_line, inverse
from smash.motion.poses import top_down
from tests.robots import PANDA, READY


def reachable_poses(count, seed=1):
    generator = np.random.default_rng(seed)
    for _ in range(count):
        radius, angle = generator.uniform(0.30, 0.65), generator.uniform(-2.6, 2.6)
        height, yaw = generator.uniform(0.02, 0.45), generator.uniform(-np.pi, np.pi)
        yield top_down([radius * np.cos(angle), radius * np.sin(angle), height], yaw)


def test_every_top_down_pose_in_reach_is_solved_within_the_joint_limits():
    for pose in reachable_poses(100):
        joints = inverse(PANDA, pose)[0]
        reached = PANDA.forward(joints)
        assert np.allclose(reached.position, pose.position, atol=1e-4)
        assert np.allclose(reached.rotation, pose.rotation, atol=1e-4)
        assert PANDA.within_limits(joints)


def test_a_pose_out_of_reach_has_no_solution():
    assert inverse(PANDA, top_down([2.0, 0.0, 0.2], 0.0)) == []


def test_solutions_come_nearest_to_the_reference_first_and_are_the_same_every_time():
    pose = top_down([0.45, 0.1, 0.2], 0.3)
    first, again = inverse(PANDA, pose, READY, count=4, seed=5), inverse(PANDA, pose, READY, count=4, seed=5)
    assert len(first) > 1
    assert all(np.array_equal(one, other) for one, other in zip(first, again, strict=True))
    distances = [np.linalg.norm(joints - READY) for joints in first]
    assert distances == sorted(distances)


def test_a_line_keeps_the_orientation_and_stays_straight():
    start = inverse(PANDA, top_down([0.45, -0.2, 0.3], 0.5))[0]
    offsets = [np.array([0.0, 0.0, -0.01 * step]) for step in range(1, 11)]
    beginning = PANDA.forward(start)
    for offset, joints in zip(offsets, along_line(PANDA, start, offsets), strict=True):
        reached = PANDA.forward(joints)
        assert np.allclose(reached.position, beginning.position + offset, atol=1e-4)
        assert np.allclose(reached.rotation, beginning.rotation, atol=1e-4)


def test_a_line_out_of_reach_is_none():
    start = inverse(PANDA, top_down([0.6, 0.0, 0.2], 0.0))[0]
    assert along_line(PANDA, start, [np.array([0.05 * step, 0.0, 0.0]) for step in range(1, 20)]) is None


def test_the_jacobian_is_the_derivative_of_the_tool_position():
    step = 1e-6
    jacobian = PANDA.jacobian(READY)
    for joint in range(7):
        moved = READY.copy()
        moved[joint] += step
        derivative = (PANDA.forward(moved).position - PANDA.forward(READY).position) / step
        assert np.allclose(jacobian[:3, joint], derivative, atol=1e-5)


def test_the_ready_pose_looks_down_and_is_within_the_limits():
    assert np.allclose(PANDA.forward(READY).rotation, top_down([0, 0, 0], 0.0).rotation, atol=1e-6)
    assert np.all(PANDA.lower < READY)
    assert np.all(PANDA.upper > READY)
