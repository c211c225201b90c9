"""Tool poses: where the point between the fingertips is and how the hand is turned.

The tool frame's z axis leaves the hand between the fingers, its y axis is the line along which the fingers open (the
hand's long axis, 0.2 m), its x axis the hand's thin side. World frame: the robot's base at the origin, table top z = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ToolPose:
    """A pose of the tool frame in the world.

    Attributes:
        position: Point between the fingertips [m], shape (3,).
        rotation: Tool axes as columns, shape (3, 3).
    """

    position: Vector
    rotation: Matrix

    def moved(self, displacement: ArrayLike) -> ToolPose:
        """The same orientation, displaced by `displacement` [m] in the world frame, shape (3,)."""
        return ToolPose(self.position + np.asarray(displacement, dtype=np.float64), self.rotation)


def yaw_rotation(yaw: float) -> Matrix:
    """Rotation by `yaw` [rad] about the world's z axis, shape (3, 3)."""
    cosine, sine = float(np.cos(yaw)), float(np.sin(yaw))
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def top_down(position: ArrayLike, yaw: float) -> ToolPose:
    """The gripper points down; its thin side (tool x) points along `yaw` [rad], its fingers open across it.

    A grasp of a block whose side is turned by `yaw` uses `yaw` or `yaw + pi/2`; a topple along the direction `yaw`
    uses `yaw` or `yaw + pi` with closed fingers.

    Args:
        position: Point between the fingertips [m], shape (3,).
        yaw: Direction of the tool's x axis in the world [rad].
    """
    flip = np.diag([1.0, -1.0, -1.0])
    return ToolPose(np.asarray(position, dtype=np.float64).copy(), yaw_rotation(yaw) @ flip)
