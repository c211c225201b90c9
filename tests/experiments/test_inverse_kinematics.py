"""The study of inverse kinematics: what counts as a solution, and ours on the arms that are shipped."""

import numpy as np

from smash.experiments.studies.inverse_kinematics import beginnings, poses, reaches, rows, shortened
from smash.motion.descent import LARGEST_STEP
from smash.motion.robots import load_robot


def test_ours_reaches_every_grasp_with_every_arm_that_is_shipped():
    found = list(rows(["panda", "ur5", "xarm7"], ["ours"]))
    assert [(row.solved, row.asked) for row in found] == [(192, 192)] * 3


def test_a_configuration_counts_where_it_brings_the_tool_to_the_pose():
    robot = load_robot("ur5")
    assert reaches(robot, robot.ready, robot.forward(robot.ready))
    assert not reaches(robot, robot.ready, poses()[0])
    assert not reaches(robot, None, poses()[0])
    assert not reaches(robot, robot.ready + 7.0, robot.forward(robot.ready + 7.0))


def test_libraries_begin_where_ours_does_and_step_no_farther():
    robot = load_robot("xarm7")
    first = next(iter(beginnings(robot, poses()[0])))
    assert np.array_equal(first, robot.ready)
    assert np.abs(shortened(np.array([4.0, -1.0]))).max() == LARGEST_STEP
    assert np.array_equal(shortened(np.array([0.1, 0.2])), [0.1, 0.2])
