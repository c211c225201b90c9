"""The Franka Panda: its URDF in pinocchio, limits, tool frame and forward kinematics."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio
from numpy.typing import NDArray

from smash.motion.poses import Matrix, ToolPose, Vector

JOINTS = 7
ARM_JOINTS = tuple(f"panda_joint{number}" for number in range(1, JOINTS + 1))
TOOL_FRAME = "panda_grasptarget"

# The manufacturer's limits: positions [rad], velocities [rad/s], accelerations [rad/s^2], jerks [rad/s^3], per joint.
LOWER = np.array([-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973])
UPPER = np.array([2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973])
VELOCITY = np.array([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61])
ACCELERATION = np.array([15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0])
JERK = np.array([7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0])

READY = np.array([0.0, -np.pi / 4, 0.0, -3 * np.pi / 4, 0.0, np.pi / 2, np.pi / 4])
MAX_OPENING = 0.04
"""Greatest travel of one finger from the middle [m]."""
FINGERTIP_BEYOND_TOOL = 0.0072
"""How far the fingers' ends lie beyond the tool frame's origin, along its z axis [m]."""


def panda_urdf() -> Path:
    """The Panda of the package: the same file for every simulator, the kinematics and the hulls.

    It is the one of `pybullet_data` (Apache-2.0, its licence lies beside it) with the meshes that collide alone.
    """
    return Path(__file__).parent / "robots" / "panda" / "panda.urdf"


class Panda:
    """Kinematics of the seven arm joints (the fingers do not move the tool frame).

    Not to be shared between threads: pinocchio's workspace is part of it.
    """

    def __init__(self) -> None:
        full = pinocchio.buildModelFromUrdf(str(panda_urdf()))
        fingers = [full.getJointId(f"panda_finger_joint{number}") for number in (1, 2)]
        self.model: Any = pinocchio.buildReducedModel(full, fingers, np.zeros(full.nq))
        self.data: Any = self.model.createData()
        self.tool: int = self.model.getFrameId(TOOL_FRAME)

    def forward(self, joints: Vector) -> ToolPose:
        """Pose of the tool frame at `joints` [rad], shape (7,)."""
        pinocchio.forwardKinematics(self.model, self.data, joints)
        placement = pinocchio.updateFramePlacement(self.model, self.data, self.tool)
        return ToolPose(placement.translation.copy(), placement.rotation.copy())

    def jacobian(self, joints: Vector) -> Matrix:
        """Jacobian of the tool frame, shape (6, 7): linear [m/rad] over angular rows, in world axes."""
        return np.asarray(
            pinocchio.computeFrameJacobian(self.model, self.data, joints, self.tool, pinocchio.LOCAL_WORLD_ALIGNED)
        )

    def chain(self) -> NDArray[np.float64]:
        """Fixed transforms along the arm, shape (8, 3, 4).

        Entry i < 7 is the frame of joint i + 1 in the link before it at angle zero (each joint turns about its z
        axis); the last one is the tool frame in link 7.
        """
        fixed = [self.model.jointPlacements[joint] for joint in range(1, JOINTS + 1)]
        fixed.append(self.model.frames[self.tool].placement)
        return np.stack([placement.homogeneous[:3, :] for placement in fixed])


@lru_cache(maxsize=1)
def panda() -> Panda:
    """The one Panda of this process."""
    return Panda()


def within_limits(joints: Vector, tolerance: float = 1e-9) -> bool:
    """Whether `joints` [rad], shape (7,) or (N, 7), keep the position limits."""
    return bool(np.all(joints >= LOWER - tolerance) and np.all(joints <= UPPER + tolerance))
