"""The damped least squares of `kinematics`, compiled: a descent takes some tens of microseconds."""

from __future__ import annotations

import math

import numpy as np

from smash.motion.kernel import Array, compiled, link_frames

TOLERANCE = 1e-5
"""Error that counts as none: [m] for the linear and [rad] for the angular part."""
DAMPING = 1e-3
PATIENCE = 6
"""A descent ends when so many iterations in a row have not halved its error."""
LARGEST_STEP = 0.5
"""Largest change of any joint in one iteration [rad]."""
STRAIGHT = 1e-6
"""A turn by less than this [rad] is a shift."""
LEAST_PIVOT = 1e-15


@compiled
def pose_error(tool: Array, rotation: Array, position: Array) -> Array:
    """The motion in the tool's frame that takes one unit of time to the target: linear [m], angular [rad], (6,).

    The logarithm of SE(3): with the turn w of angle a about its axis and p the target in the tool's frame, the linear
    part is p - w x p / 2 + (1 - a / 2 cot(a / 2)) / a^2 w x (w x p) (Lynch & Park, Modern Robotics, 3.3.3).

    Args:
        tool: The tool's frame in the world, (3, 4).
        rotation: The target's axes in the world as columns, (3, 3).
        position: The target in the world [m], (3,).
    """
    turn = np.zeros((3, 3))
    away = np.zeros(3)
    for row in range(3):
        for inner in range(3):
            away[row] += tool[inner, row] * (position[inner] - tool[inner, 3])
            for column in range(3):
                turn[row, column] += tool[inner, row] * rotation[inner, column]
    # By the quaternion, whose greatest part is taken first: exact up to half a turn.
    real, i, j, k = 1.0 + turn[0, 0] + turn[1, 1] + turn[2, 2], 0.0, 0.0, 0.0
    if real > 1.0:
        i, j, k = turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]
    elif turn[0, 0] >= turn[1, 1] and turn[0, 0] >= turn[2, 2]:
        i, j, k = 1.0 + turn[0, 0] - turn[1, 1] - turn[2, 2], turn[0, 1] + turn[1, 0], turn[0, 2] + turn[2, 0]
        real = turn[2, 1] - turn[1, 2]
    elif turn[1, 1] >= turn[2, 2]:
        i, j, k = turn[0, 1] + turn[1, 0], 1.0 + turn[1, 1] - turn[0, 0] - turn[2, 2], turn[1, 2] + turn[2, 1]
        real = turn[0, 2] - turn[2, 0]
    else:
        i, j, k = turn[0, 2] + turn[2, 0], turn[1, 2] + turn[2, 1], 1.0 + turn[2, 2] - turn[0, 0] - turn[1, 1]
        real = turn[1, 0] - turn[0, 1]
    size = math.sqrt(i * i + j * j + k * k)
    error = np.empty(6)
    angle = 2.0 * math.atan2(size, abs(real))
    # A quarter of (1, i, j, k) of a small turn is half of it.
    scale = 0.5 if size < STRAIGHT else math.copysign(angle / size, real)
    x, y, z = scale * i, scale * j, scale * k
    bend = 1.0 / 12.0
    if angle > 1e-3:
        bend = (1.0 - angle / 2.0 / math.tan(angle / 2.0)) / (angle * angle)
    across = (y * away[2] - z * away[1], z * away[0] - x * away[2], x * away[1] - y * away[0])
    error[0] = away[0] - across[0] / 2.0 + bend * (y * across[2] - z * across[1])
    error[1] = away[1] - across[1] / 2.0 + bend * (z * across[0] - x * across[2])
    error[2] = away[2] - across[2] / 2.0 + bend * (x * across[1] - y * across[0])
    error[3], error[4], error[5] = x, y, z
    return error


@compiled
def tool_jacobian(frames: Array) -> Array:
    """Jacobian of the tool's frame in its own axes, (6, n): linear [m/rad] over angular rows.

    Args:
        frames: Of the links and of the tool, (n + 2, 3, 4), as of `link_frames`; joints turn about their z axes.
    """
    count = frames.shape[0] - 2
    tool = frames[count + 1]
    jacobian = np.zeros((6, count))
    for joint in range(count):
        frame = frames[joint + 1]
        x, y, z = frame[0, 2], frame[1, 2], frame[2, 2]
        dx, dy, dz = tool[0, 3] - frame[0, 3], tool[1, 3] - frame[1, 3], tool[2, 3] - frame[2, 3]
        moved = (y * dz - z * dy, z * dx - x * dz, x * dy - y * dx)
        for row in range(3):
            jacobian[row, joint] = tool[0, row] * moved[0] + tool[1, row] * moved[1] + tool[2, row] * moved[2]
            jacobian[row + 3, joint] = tool[0, row] * x + tool[1, row] * y + tool[2, row] * z
    return jacobian


@compiled
def cholesky(jacobian: Array, damping: float) -> Array:
    """The lower triangle L, (6, 6), with L L^T = J J^T + damping."""
    root = np.zeros((6, 6))
    for row in range(6):
        for column in range(row + 1):
            value = damping if row == column else 0.0
            for joint in range(jacobian.shape[1]):
                value += jacobian[row, joint] * jacobian[column, joint]
            for inner in range(column):
                value -= root[row, inner] * root[column, inner]
            root[row, column] = math.sqrt(max(value, LEAST_PIVOT)) if row == column else value / root[column, column]
    return root


@compiled
def damped_step(jacobian: Array, error: Array, damping: float) -> Array:
    """The step J^T (J J^T + damping)^-1 e [rad], (n,)."""
    root, weights, step = cholesky(jacobian, damping), error.copy(), np.zeros(jacobian.shape[1])
    for row in range(6):
        for inner in range(row):
            weights[row] -= root[row, inner] * weights[inner]
        weights[row] /= root[row, row]
    for row in range(5, -1, -1):
        for inner in range(row + 1, 6):
            weights[row] -= root[inner, row] * weights[inner]
        weights[row] /= root[row, row]
    for row in range(6):
        for joint in range(jacobian.shape[1]):
            step[joint] += jacobian[row, joint] * weights[row]
    return step


@compiled
def descent(
    chain: Array, lower: Array, upper: Array, rotation: Array, position: Array, start: Array, iterations: int
) -> tuple[bool, Array]:
    """Whether a descent from `start` ends at the target, and where it ends [rad], (n,).

    Args:
        chain: Fixed transforms along the arm, (n + 1, 3, 4).
        lower: Least joint positions [rad], (n,); all of a descent keeps them.
        upper: Greatest ones.
        rotation: The target's axes as columns, (3, 3).
        position: The target [m], (3,).
        start: [rad], (n,).
        iterations: At most so many.
    """
    count = start.shape[0]
    joints = np.empty(count)
    for joint in range(count):
        joints[joint] = min(max(start[joint], lower[joint]), upper[joint])
    halved, patience = math.inf, PATIENCE
    for _ in range(iterations):
        frames = link_frames(chain, joints)
        error = pose_error(frames[count + 1], rotation, position)
        square, greatest = 0.0, 0.0
        for value in error:
            square += value * value
            greatest = max(greatest, abs(value))
        if greatest < TOLERANCE:
            return True, joints
        if square < halved / 4.0:
            halved, patience = square, PATIENCE
        patience -= 1
        if patience < 0:
            break
        step = damped_step(tool_jacobian(frames), error, DAMPING * min(1.0, square))
        largest = 1e-12
        for value in step:
            largest = max(largest, abs(value))
        share = min(1.0, LARGEST_STEP / largest)
        for joint in range(count):
            joints[joint] = min(max(joints[joint] + share * step[joint], lower[joint]), upper[joint])
    return False, joints
