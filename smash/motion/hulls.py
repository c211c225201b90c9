"""The robot as the simulator has it: the convex hulls of its links' meshes, checked exactly with coal.

Slower than the spheres of `collision` and independent of them (pinocchio's kinematics, coal's narrow phase): the last
word, asked about every motion that the planner returns.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import coal
import numpy as np
import pinocchio
from numpy.typing import NDArray

from smash.motion.obstacles import Attached, HandState, Scene, in_words
from smash.motion.robot import panda_urdf

HAND = ("panda_hand_0", "panda_leftfinger_0", "panda_rightfinger_0")
CARRIED = "what is carried"
_NEAR_BASE = tuple(f"panda_link{link}_0" for link in (0, 1, 2))
_WRIST = tuple(f"panda_link{link}_0" for link in (5, 6, 7))
SELF_PAIRS = (
    *((far, near) for far in (*_WRIST, *HAND) for near in _NEAR_BASE),
    *((part, "panda_link5_0") for part in ("panda_link7_0", *HAND)),
)
MOVING = tuple(f"panda_link{link}_0" for link in range(2, 8)) + HAND
"""Parts that are checked against the scene; the base and the first link stand where they stand."""


@dataclass(frozen=True)
class Contact:
    """Two things that touch.

    Attributes:
        part: The robot's part, or the carried block.
        other: The block, "the table", or the robot's other part.
        step: Index of the configuration at which they do.
    """

    part: str
    other: str
    step: int

    def __str__(self) -> str:
        return f"{self.part} touches {self.other}"


@lru_cache(maxsize=1)
def _robot() -> tuple[Any, Any]:
    """The full Panda, fingers included, and its hulls."""
    urdf = panda_urdf()
    model = pinocchio.buildModelFromUrdf(str(urdf))
    geometry = pinocchio.buildGeomFromUrdf(
        model, str(urdf), pinocchio.GeometryType.COLLISION, package_dirs=[str(urdf.parent)]
    )
    for part in geometry.geometryObjects:
        part.geometry.buildConvexHull(True, "Qt")
        part.geometry = part.geometry.convex
    return model, geometry


def link_vertices(link: int) -> NDArray[np.float64]:
    """Hull corners of arm link 0 to 7 in its frame [m], shape (V, 3)."""
    _, geometry = _robot()
    part = geometry.geometryObjects[geometry.getGeometryId(f"panda_link{link}_0")]
    return np.array([part.geometry.point(index) for index in range(part.geometry.num_points)])


class HullChecker:
    """Exact checks of one scene and one state of the hand.

    Args:
        scene: What must not be touched.
        hand: Finger opening and carried block.
        tolerance: Boxes may be entered by this much: touching is no collision [m].
    """

    def __init__(self, scene: Scene, hand: HandState | None = None, tolerance: float = 0.001) -> None:
        self.scene = scene
        self.hand = hand or HandState()
        self._model, robot = _robot()
        self._geometry: Any = robot.copy()
        for first, second in SELF_PAIRS:
            self._pair(first, second)
        parts = MOVING
        if self.hand.attached is not None:
            parts += self._carry(self.hand.attached)
        for index in range(len(scene.names)):
            box = self._add_box(f"box {index}", scene.half_extents[index] - tolerance)
            box.placement = pinocchio.SE3(scene.rotations[index], scene.centres[index])
            self._geometry.addGeometryObject(box)
            for part in parts:
                self._pair(part, box.name)
        self._data = self._model.createData()
        self._geometry_data = self._geometry.createData()

    def contact(self, joints: NDArray[np.float64]) -> Contact | None:
        """The first contact along configurations [rad], shape (7,) or (T, 7), or None where all are free."""
        fingers = np.full(2, self.hand.opening)
        for step, row in enumerate(np.atleast_2d(joints)):
            hit = pinocchio.computeCollisions(
                self._model, self._data, self._geometry, self._geometry_data, np.concatenate([row, fingers]), True
            )
            if hit:
                return self._name_contact(step)
        return None

    def _name_contact(self, step: int) -> Contact:
        results = self._geometry_data.collisionResults
        index = next(number for number, result in enumerate(results) if result.isCollision())
        pair = self._geometry.collisionPairs[index]
        return Contact(self._say(pair.first), self._say(pair.second), step)

    def _say(self, index: int) -> str:
        name = str(self._geometry.geometryObjects[index].name)
        if name.startswith("box "):
            return in_words(self.scene.names[int(name[4:])])
        if name.startswith(CARRIED):
            return CARRIED
        return name.removeprefix("panda_").removesuffix("_0")

    def _pair(self, first: str, second: str) -> None:
        ids = self._geometry.getGeometryId(first), self._geometry.getGeometryId(second)
        self._geometry.addCollisionPair(pinocchio.CollisionPair(*ids))

    def _add_box(self, name: str, half: NDArray[np.float64]) -> Any:
        return pinocchio.GeometryObject(name, 0, pinocchio.SE3.Identity(), coal.Box(*(2 * half)))

    def _carry(self, load: Attached) -> tuple[str, ...]:
        """Hang what is held on link 7, where the hand is fixed; return the names of its boxes."""
        frame = self._model.frames[self._model.getFrameId("panda_grasptarget")]
        names = tuple(f"{CARRIED} {index}" for index in range(len(load.half_extents)))
        for index, name in enumerate(names):
            in_tool = pinocchio.SE3(load.rotations[index], load.translations[index])
            shape = coal.Box(*(2 * load.half_extents[index]))
            box = pinocchio.GeometryObject(name, frame.parentJoint, frame.placement * in_tool, shape)
            self._geometry.addGeometryObject(box)
            for near in (*_NEAR_BASE, "panda_link3_0", "panda_link4_0", "panda_link5_0"):
                self._pair(name, near)
        return names
