"""Where a block is: what counts is which of its axes is upright, how far it leans and how its sides are turned.

A cube has 24 equal orientations, a box with a square footprint has eight.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import acos, atan2, cos, pi, sin

import numpy as np
from numpy.typing import NDArray

QUARTER = pi / 2


@dataclass(frozen=True, eq=False)
class BlockPose:
    """Pose of one block in the world.

    Attributes:
        position: Centre [m], shape (3,).
        rotation: Axes as columns, shape (3, 3).
    """

    position: NDArray[np.float64]
    rotation: NDArray[np.float64]

    @property
    def upright_axis(self) -> int:
        """Which axis is nearest to the vertical."""
        return int(np.abs(self.rotation[2]).argmax())

    @property
    def tilt(self) -> float:
        """How far the axis nearest to the vertical leans [rad], 0 to 0.96."""
        return acos(min(1.0, float(np.abs(self.rotation[2]).max())))

    @property
    def yaw(self) -> float:
        """How the sides are turned about the vertical [rad], in [-pi/4, pi/4)."""
        side = self.rotation[:, (self.upright_axis + 1) % 3]
        return quarter_turn(atan2(float(side[1]), float(side[0])))

    def distance(self, x: float, y: float) -> float:
        """Horizontal distance of the centre from a point [m]."""
        return float(np.hypot(self.position[0] - x, self.position[1] - y))


def quarter_turn(yaw: float) -> float:
    """The representative of `yaw` [rad] modulo a quarter turn, in [-pi/4, pi/4)."""
    return (yaw + QUARTER / 2) % QUARTER - QUARTER / 2


def standing(x: float, y: float, z: float, yaw: float) -> BlockPose:
    """The pose of a block that stands upright with its centre at x, y, z [m], turned by `yaw` [rad]."""
    rotation = np.array([[cos(yaw), -sin(yaw), 0.0], [sin(yaw), cos(yaw), 0.0], [0.0, 0.0, 1.0]])
    return BlockPose(np.array([x, y, z]), rotation)


def quaternion_of(rotation: NDArray[np.float64]) -> list[float]:
    """Quaternion x, y, z, w of a rotation about the vertical followed by nothing else, or of any rotation matrix."""
    from scipy.spatial.transform import Rotation

    return [float(value) for value in Rotation.from_matrix(rotation).as_quat()]
