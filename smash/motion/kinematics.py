"""Inverse kinematics by damped least squares (Levenberg's step on the pose error), many seeds, nearest first.

An arm of six joints has some solutions for a pose, one of more joints a family of them; descending from a reference
finds the one near it. Everything is a function of its arguments: the random seeds come from the `seed` given.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache

import numpy as np

from smash.motion.descent import descent
from smash.motion.poses import ToolPose, Vector
from smash.motion.robot import Robot

ITERATIONS = 40
RANDOM_SEEDS = 16
SWIVELS = (0.0, 0.5, -0.5)
"""Turns of the first joint that an arm with a swivel begins with beside the target's bearing [rad]."""
BENT, WELL_BENT = 0.2, 0.4
"""The least that an elbow is bent where a descent begins: from the reference, and elsewhere [rad]."""
SAME_SOLUTION = 0.05
"""Solutions closer than this in every joint count once [rad]."""


def inverse(
    robot: Robot, pose: ToolPose, reference: Vector | None = None, *, count: int = 1, seed: int = 0
) -> list[Vector]:
    """Joint configurations within the limits that bring the tool to `pose`, nearest to `reference` first.

    Args:
        robot: Whose.
        pose: Where the tool frame should be.
        reference: The configuration to stay near to [rad], shape (n,), ready by default; it is the first seed.
        count: Stop after so many distinct solutions.
        seed: Of the random restarts.

    Returns:
        At most `count` configurations [rad], each of shape (n,); an empty list where none was found.
    """
    near = robot.ready if reference is None else reference
    found: list[Vector] = []
    for start in _seeds(robot, pose, near, seed):
        solution = descend(robot, pose, start)
        if solution is None:
            continue
        solution = robot.nearest(solution, near)
        if any(np.abs(solution - other).max() < SAME_SOLUTION for other in found):
            continue
        found.append(solution)
        if len(found) >= count:
            break
    return sorted(found, key=lambda joints: float(np.linalg.norm(joints - near)))


def descend(robot: Robot, pose: ToolPose, start: Vector, iterations: int = ITERATIONS) -> Vector | None:
    """One damped descent from `start` [rad], shape (n,): the solution, or None where it ends elsewhere."""
    reached, joints = descent(
        robot.chain,
        robot.lower,
        robot.upper,
        np.ascontiguousarray(pose.rotation),
        pose.position,
        start,
        iterations,
    )
    return joints if reached else None


def along_line(
    robot: Robot, start: Vector, displacements: Iterable[Vector], *, largest_jump: float = 0.3
) -> list[Vector] | None:
    """Follow a straight line of the tool with its orientation kept, each pose's solution seeded by the one before.

    Args:
        robot: Whose.
        start: Configuration at the line's beginning [rad], shape (n,).
        displacements: Tool positions relative to the beginning [m], each of shape (3,).
        largest_jump: A joint that moves more between neighbours has left the line's branch [rad].

    Returns:
        One configuration per displacement, or None where the line leaves the arm's reach.
    """
    beginning = robot.forward(start)
    joints, found = start, []
    for displacement in displacements:
        solution = descend(robot, beginning.moved(displacement), joints)
        if solution is None or np.abs(solution - joints).max() > largest_jump:
            return None
        found.append(solution)
        joints = solution
    return found


def _seeds(robot: Robot, pose: ToolPose, reference: Vector, seed: int) -> Iterator[Vector]:
    """Where descents start: the reference, the robot's postures turned towards the target, random configurations.

    All but the first are turned about the tool's axis by the last joint as the pose asks. An elbow never starts at 0:
    stretched out, the arm is singular there.
    """
    yield _bent(robot, np.array(reference, dtype=np.float64), BENT)
    bearing = float(np.arctan2(pose.position[1], pose.position[0]))
    for posture in robot.postures:
        ahead = bearing - _bearing(robot, posture)
        for swivel in SWIVELS if robot.swivel is not None else SWIVELS[:1]:
            turned = posture.copy()
            turned[0] = posture[0] + ahead + swivel
            if robot.swivel is not None:
                turned[robot.swivel] = posture[robot.swivel] - swivel
            yield _wrist_turned(robot, turned, pose)
    generator = np.random.default_rng(seed)
    lower = np.where(robot.winding, np.maximum(robot.lower, -np.pi), robot.lower)
    upper = np.where(robot.winding, np.minimum(robot.upper, np.pi), robot.upper)
    for _ in range(RANDOM_SEEDS):
        yield _wrist_turned(robot, _bent(robot, generator.uniform(lower, upper, robot.count), WELL_BENT), pose)


def _bent(robot: Robot, joints: Vector, least: float) -> Vector:
    """The configuration with the elbow bent by `least` [rad] or more to the side that it is always bent to."""
    if robot.elbow is not None:
        joint, side = robot.elbow
        joints[joint] = side * max(side * joints[joint], least)
    return joints


@lru_cache(maxsize=64)
def _bearing_of(robot: Robot, posture: bytes) -> float:
    x, y, _ = robot.forward(np.frombuffer(posture)).position
    return round(float(np.arctan2(y, x)), 6)


def _bearing(robot: Robot, posture: Vector) -> float:
    """Where the tool is in a posture, seen from the base [rad]."""
    return _bearing_of(robot, posture.tobytes())


def _wrist_turned(robot: Robot, joints: Vector, pose: ToolPose) -> Vector:
    """The configuration with the last joint such that the tool's x axis points as the pose's does, if it can."""
    limited = np.minimum(np.maximum(joints, robot.lower), robot.upper)
    if robot.twist:
        wanted = robot.forward(limited).rotation.T @ pose.rotation[:, 0]
        angle = limited[-1] + robot.twist * float(np.arctan2(wanted[1], wanted[0]))
        limited[-1] = min(max((angle + np.pi) % (2 * np.pi) - np.pi, robot.lower[-1]), robot.upper[-1])
    return limited
