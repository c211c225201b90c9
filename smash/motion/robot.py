"""A robot as the rest of the package knows it: an arm of some joints with a hand of two fingers, read from files.

Who needs a robot is handed one; `smash.motion.robots.load_robot` makes it of a `smash-robot/1` file. Its base stands at
the world's origin, the table's top is z = 0. Bodies are numbered: 0 is the base, i what joint i moves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio
from numpy.typing import NDArray

from smash.motion.poses import Matrix, ToolPose, Vector

HAND = "hand"
"""What the hand is called where pairs of parts are named."""
SHIPPED = "panda"
"""The robot of old records, which say nothing about one."""


@dataclass(frozen=True, eq=False)
class Hand:
    """A hand of two fingers that open along one line.

    Its frame is the tool's, drawn back to the hand's root: z leaves the hand between the fingers, y is the line along
    which they open, x the thin side.

    Attributes:
        name: What it is called.
        root: Its root link.
        links: All its links.
        joints: The fingers' joints, the one on the side of y > 0 first: 0 is closed, and both open to `opening`.
        fingers: Their links.
        palm: Least and greatest corner of the palm in the hand's frame [m], shape (2, 3).
        finger: The same of the first finger, closed; the other one mirrors it.
        tool: The tool frame's origin in the hand's frame [m], shape (3,).
        finger_places: The fingers' link frames in the hand's frame, closed, shape (2, 4, 4).
        opening: Greatest travel of one finger from the middle [m].
        force: The most that a finger pushes with [N].
        speed: The most that it moves at [m/s].
        tip: How far the fingers' ends lie beyond the tool frame's origin, along its z axis [m].
    """

    name: str
    root: str
    links: tuple[str, ...]
    joints: tuple[str, str]
    fingers: tuple[str, str]
    palm: NDArray[np.float64]
    finger: NDArray[np.float64]
    tool: Vector
    finger_places: NDArray[np.float64]
    opening: float
    force: float
    speed: float
    tip: float

    @property
    def palm_thickness(self) -> float:
        """How far the palm stands out from the tool's axis along x, to the side where it does so most [m]."""
        return float(np.abs(self.palm[:, 0] - self.tool[0]).max())

    @property
    def finger_thickness(self) -> float:
        """The same of the fingers [m]."""
        return float(np.abs(self.finger[:, 0] - self.tool[0]).max())

    @property
    def palm_depth(self) -> float:
        """From the palm's end to the tool frame's origin, along z [m]."""
        return float(self.tool[2] - self.palm[1, 2])


@dataclass(frozen=True, eq=False)
class Robot:
    """An arm with a hand: limits, kinematics, what covers it. One object per file and process.

    Not to be shared between threads: pinocchio's workspace is part of it.

    Attributes:
        name: What it is called.
        label: The same in records; a robot from a file of one's own has its content's mark behind the name.
        path: Its file.
        files: That one and all others that it is made of: the hand's, both URDFs, meshes, the table of spheres.
        hand: The hand on its flange.
        base: The base link, whose frame is the world's.
        joints: Names of the joints in order, n of them.
        lower: Least positions [rad], shape (n,).
        upper: Greatest positions [rad], shape (n,).
        velocity: Limits [rad/s], shape (n,).
        acceleration: Limits [rad/s^2], shape (n,).
        jerk: Limits [rad/s^3], shape (n,).
        force: The most that each motor turns with [N m], shape (n,).
        ready: Where the arm begins [rad], shape (n,).
        postures: `ready`, and others that inverse kinematics begins with [rad], each of shape (n,).
        elbow: Number of the joint that is always bent and the side that it is bent to, or none.
        swivel: Number of the joint that undoes a turn of the first one, of an arm that has one to spare.
        urdf: Arm and hand as one URDF, meshes by absolute paths.
        bodies: Number of the body that each link of the arm belongs to.
        spheres: Table of the spheres that cover the links, where it was named.
        padding: How far these may stand out, body by body [m].
        forearm: Number of the last body before the wrist.
        touching: Pairs of bodies (or `HAND`) whose covers meet by construction: the hulls alone are asked.
        apart: Pairs that are not asked about.
        heights: How many levels of `LEVEL` a pile may have at which distance from the base [m]; between two the lesser.
        tool: Number of the tool's frame in `model`.
        model: pinocchio's model, fingers fixed.
        data: Its workspace.
        axes: Each joint's axis in its own frame, shape (n, 3).
    """

    name: str
    label: str
    path: Path
    files: tuple[Path, ...]
    hand: Hand
    base: str
    joints: tuple[str, ...]
    lower: Vector
    upper: Vector
    velocity: Vector
    acceleration: Vector
    jerk: Vector
    force: Vector
    ready: Vector
    postures: tuple[Vector, ...]
    elbow: tuple[int, int] | None
    swivel: int | None
    urdf: str
    bodies: Mapping[str, int]
    spheres: Path | None
    padding: tuple[float, ...]
    forearm: int
    touching: frozenset[frozenset[int | str]]
    apart: frozenset[frozenset[int | str]]
    heights: tuple[tuple[float, float], ...]
    tool: int
    model: Any
    data: Any
    axes: NDArray[np.float64]

    @property
    def count(self) -> int:
        """How many joints the arm has, n."""
        return len(self.joints)

    @cached_property
    def links(self) -> tuple[str, ...]:
        """The link that each joint moves, shape (n,)."""
        first: dict[int, str] = {}
        for link, body in self.bodies.items():
            first.setdefault(body, link)
        return tuple(first[body] for body in range(1, self.count + 1))

    def forward(self, joints: Vector) -> ToolPose:
        """Pose of the tool frame at `joints` [rad], shape (n,)."""
        pinocchio.forwardKinematics(self.model, self.data, joints)
        placement = pinocchio.updateFramePlacement(self.model, self.data, self.tool)
        return ToolPose(placement.translation.copy(), placement.rotation.copy())

    def jacobian(self, joints: Vector) -> Matrix:
        """Jacobian of the tool frame, shape (6, n): linear [m/rad] over angular rows, in world axes."""
        return np.asarray(
            pinocchio.computeFrameJacobian(self.model, self.data, joints, self.tool, pinocchio.LOCAL_WORLD_ALIGNED)
        )

    @cached_property
    def chain(self) -> NDArray[np.float64]:
        """Fixed transforms along the arm, shape (n + 1, 3, 4).

        Entry i < n is the frame of joint i + 1 in the one before it at angle zero, turned so that each joint turns
        about its z axis; the last one is the tool frame in the last of these.
        """
        fixed = [self.model.jointPlacements[joint] for joint in range(1, self.count + 1)]
        fixed.append(self.model.frames[self.tool].placement)
        turns = [np.eye(4), *self.turned_axes, np.eye(4)]
        placed = [
            before.T @ placement.homogeneous @ after
            for before, placement, after in zip(turns, fixed, turns[1:], strict=False)
        ]
        return np.stack([placement[:3, :] for placement in placed])

    @cached_property
    def turned_axes(self) -> NDArray[np.float64]:
        """For each joint the rotation that brings z to its axis, shape (n, 4, 4)."""
        turns = np.tile(np.eye(4), (self.count, 1, 1))
        for turn, axis in zip(turns, self.axes, strict=True):
            turn[:3, :3] = _z_to(axis)
        return turns

    def in_body(self, link: str) -> tuple[int, Matrix]:
        """The body of a link of the arm, and the link's frame in the body's frame of `chain`, shape (4, 4)."""
        frame = self.model.frames[self.model.getFrameId(link, pinocchio.FrameType.BODY)]
        body = self.bodies[link]
        placement = np.asarray(frame.placement.homogeneous)
        return body, placement if body == 0 else self.turned_axes[body - 1].T @ placement

    def within_limits(self, joints: NDArray[np.float64], tolerance: float = 1e-9) -> bool:
        """Whether `joints` [rad], shape (n,) or (N, n), keep the position limits."""
        return bool(np.all(joints >= self.lower - tolerance) and np.all(joints <= self.upper + tolerance))

    def nearest(self, joints: Vector, reference: Vector) -> Vector:
        """The same posture with joints that turn more than once turned to the revolution nearest to `reference`."""
        if not self.winds:
            return joints
        turns = 2 * np.pi * np.round((reference - joints) / (2 * np.pi))
        moved = np.where(self.winding, joints + turns, joints)
        moved = np.where(moved > self.upper, moved - 2 * np.pi, moved)
        return np.asarray(np.where(moved < self.lower, moved + 2 * np.pi, moved))

    @cached_property
    def winding(self) -> NDArray[np.bool_]:
        """Which joints can turn by more than a revolution, shape (n,)."""
        return np.asarray(self.upper - self.lower > 2 * np.pi + 1e-6)

    @cached_property
    def winds(self) -> bool:
        """Whether any joint can."""
        return bool(self.winding.any())

    @cached_property
    def twist(self) -> int:
        """How the last joint turns the tool about its z axis: 1, -1 for the other way, 0 for not at all."""
        tool = self.model.frames[self.tool].placement.rotation
        along = float(tool[:, 2] @ self.axes[-1])
        return round(along) if abs(along) > 1.0 - 1e-6 else 0

    @cached_property
    def upright(self) -> bool:
        """Whether the first joint turns the arm about the world's vertical, counter-clockwise."""
        first = self.model.jointPlacements[1]
        axis = first.rotation @ self.axes[0]
        return bool(axis[2] > 1.0 - 1e-9 and np.abs(first.translation[:2]).max() < 1e-6)

    @property
    def first_joint(self) -> Vector:
        """A turn of the first joint alone [rad], shape (n,)."""
        return np.asarray(np.eye(self.count)[0])

    def highest(self, radius: float) -> float:
        """How high a pile may be that is worked on from above at this distance from the base [m]; 0: out of reach."""
        radii = [known for known, _ in self.heights]
        if not radii[0] - 1e-9 <= radius <= radii[-1] + 1e-9:
            return 0.0
        around = [height for (known, height) in self.heights if abs(known - radius) < 1e-9]
        below = [height for known, height in self.heights if known < radius]
        above = [height for known, height in self.heights if known > radius]
        return around[0] if around else min(below[-1], above[0])

    def reach(self, least: float) -> tuple[float, float]:
        """The least and the greatest measured distance from the base at which a pile may be so high [m]."""
        radii = [radius for radius, height in self.heights if height >= least]
        return radii[0], radii[-1]

    @property
    def full_reach(self) -> tuple[float, float]:
        """The same for a pile that is as high as one may be anywhere [m]."""
        return self.reach(self.tallest)

    @property
    def tallest(self) -> float:
        """The greatest of these heights [m]."""
        return max(height for _, height in self.heights)


def _z_to(axis: Vector) -> Matrix:
    """A rotation that brings z to a unit vector, shape (3, 3); of z itself, exactly none."""
    z = np.array([0.0, 0.0, 1.0])
    if np.array_equal(axis, z):
        return np.eye(3)
    other = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    x = np.cross(other, axis)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(axis, x), axis], axis=1)
