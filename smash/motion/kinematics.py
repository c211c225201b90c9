"""Inverse kinematics by damped least squares (Levenberg's step on the pose error), many seeds, nearest first.

The arm has seven joints for six coordinates, so a pose has a family of solutions; descending from a reference finds
the member near it. Everything is a function of its arguments: the random seeds come from the `seed` given.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from smash.motion.descent import descent
from smash.motion.poses import ToolPose, Vector
from smash.motion.robot import JOINTS, LOWER, READY, UPPER, Panda, panda

ITERATIONS = 40
RANDOM_SEEDS = 16
SAME_SOLUTION = 0.05
"""Solutions closer than this in every joint count once [rad]."""


def inverse(
    pose: ToolPose,
    reference: Vector = READY,
    *,
    count: int = 1,
    seed: int = 0,
    robot: Panda | None = None,
) -> list[Vector]:
    """Joint configurations within the limits that bring the tool to `pose`, nearest to `reference` first.

    Args:
        pose: Where the tool frame should be.
        reference: The configuration to stay near to [rad], shape (7,); it is the first seed.
        count: Stop after so many distinct solutions.
        seed: Of the random restarts.
        robot: The kinematics to use, the process's own by default.

    Returns:
        At most `count` configurations [rad], each of shape (7,); an empty list where none was found.
    """
    arm = robot or panda()
    found: list[Vector] = []
    for start in _seeds(pose, reference, seed, arm):
        solution = descend(pose, start, arm)
        if solution is None or any(np.max(np.abs(solution - other)) < SAME_SOLUTION for other in found):
            continue
        found.append(solution)
        if len(found) >= count:
            break
    return sorted(found, key=lambda joints: float(np.linalg.norm(joints - reference)))


def descend(pose: ToolPose, start: Vector, robot: Panda, iterations: int = ITERATIONS) -> Vector | None:
    """One damped descent from `start` [rad], shape (7,): the solution, or None where it ends elsewhere."""
    reached, joints = descent(
        _chain(robot), LOWER, UPPER, np.ascontiguousarray(pose.rotation), pose.position, start, iterations
    )
    return joints if reached else None


@lru_cache
def _chain(robot: Panda) -> NDArray[np.float64]:
    """The robot's fixed transforms, shape (8, 3, 4), as the compiled descent takes them."""
    return np.ascontiguousarray(robot.chain())


def along_line(
    start: Vector, displacements: Iterable[Vector], *, robot: Panda | None = None, largest_jump: float = 0.3
) -> list[Vector] | None:
    """Follow a straight line of the tool with its orientation kept, each pose's solution seeded by the one before.

    Args:
        start: Configuration at the line's beginning [rad], shape (7,).
        displacements: Tool positions relative to the beginning [m], each of shape (3,).
        robot: The kinematics to use.
        largest_jump: A joint that moves more between neighbours has left the line's branch [rad].

    Returns:
        One configuration per displacement, or None where the line leaves the arm's reach.
    """
    arm = robot or panda()
    beginning = arm.forward(start)
    joints, found = start, []
    for displacement in displacements:
        solution = descend(beginning.moved(displacement), joints, arm)
        if solution is None or np.max(np.abs(solution - joints)) > largest_jump:
            return None
        found.append(solution)
        joints = solution
    return found


def _seeds(pose: ToolPose, reference: Vector, seed: int, robot: Panda) -> Iterator[Vector]:
    """Where descents start: the reference, the ready pose turned towards the target, random configurations.

    All but the first are turned about the tool's axis by joint 7 as the pose asks. Joint 4 never starts at 0: stretched
    out, the arm is singular there and the limit is next to it.
    """
    first = np.array(reference, dtype=np.float64)
    first[3] = min(first[3], -0.2)
    yield first
    bearing = float(np.arctan2(pose.position[1], pose.position[0]))
    for shoulder in (0.0, 0.5, -0.5):
        turned = READY.copy()
        turned[0], turned[2] = bearing + shoulder, -shoulder
        yield _wrist_turned(turned, pose, robot)
    generator = np.random.default_rng(seed)
    for _ in range(RANDOM_SEEDS):
        joints = generator.uniform(LOWER, UPPER, JOINTS)
        joints[3] = min(joints[3], -0.4)
        yield _wrist_turned(joints, pose, robot)


def _wrist_turned(joints: Vector, pose: ToolPose, robot: Panda) -> Vector:
    """The configuration with joint 7 such that the tool's x axis points as the pose's does, as far as it goes."""
    limited = np.clip(joints, LOWER, UPPER)
    wanted = robot.forward(limited).rotation.T @ pose.rotation[:, 0]
    angle = limited[6] + float(np.arctan2(wanted[1], wanted[0]))
    limited[6] = np.clip((angle + np.pi) % (2 * np.pi) - np.pi, LOWER[6], UPPER[6])
    return limited
