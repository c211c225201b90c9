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

from smash.motion.collision import links_that_hand_meets, links_that_meet
from smash.motion.obstacles import Attached, HandState, Scene, in_words
from smash.motion.robot import Robot
from smash.motion.robots.composing import TOOL
from smash.motion.robots.meshes import corners, link_of, shapes

CARRIED = "what is carried"


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


class _Parts:
    """The full robot, fingers included, its hulls, and which of them belong to what."""

    def __init__(self, robot: Robot) -> None:
        self.model: Any = pinocchio.buildModelFromXML(robot.urdf)
        self.geometry = shapes(self.model, robot.urdf, str(robot.path))
        named = [(str(part.name), link_of(part)) for part in self.geometry.geometryObjects]
        links = range(robot.count + 1)
        self.of_link = [[name for name, link in named if robot.bodies.get(link) == body] for body in links]
        order = [link for link in robot.hand.links if link not in robot.hand.fingers] + list(robot.hand.fingers)
        self.of_hand = [name for link in order for name, owner in named if owner == link]
        moving = [name for of_link in self.of_link[2 if robot.upright else 1 :] for name in of_link]
        self.moving = (*moving, *self.of_hand)
        """Checked against the scene; what stands over its place on the table is not."""
        hand, self.meets_held = links_that_hand_meets(robot, covers=False)
        link_pairs = links_that_meet(robot, covers=False)
        self.pairs: list[tuple[str, str]] = []
        for beside_wrist in (False, True):
            near_links = [link for link in links if (link >= robot.forearm) == beside_wrist]
            for far, near in link_pairs:
                if near in near_links:
                    self.pairs += [(one, other) for one in self.of_link[far] for other in self.of_link[near]]
            near_hand = [link for link in hand if link in near_links]
            self.pairs += [(part, other) for part in self.of_hand for link in near_hand for other in self.of_link[link]]


@lru_cache(maxsize=16)
def _parts(robot: Robot) -> _Parts:
    return _Parts(robot)


def link_vertices(robot: Robot, link: str) -> NDArray[np.float64]:
    """Hull corners of a link of the arm in its own frame [m], shape (V, 3); none where it has no shape."""
    parts = _parts(robot)
    frame = parts.model.frames[parts.model.getFrameId(link, pinocchio.FrameType.BODY)].placement
    found = [np.empty((0, 3))]
    for part in parts.geometry.geometryObjects:
        if link_of(part) == link:
            placed = frame.actInv(part.placement).homogeneous
            found.append(corners(part) @ placed[:3, :3].T + placed[:3, 3])
    return np.vstack(found)


class HullChecker:
    """Exact checks of one scene and one state of the hand.

    Args:
        robot: Whose configurations they are.
        scene: What must not be touched.
        hand: Finger opening and carried block.
        tolerance: Boxes may be entered by this much: touching is no collision [m].
    """

    def __init__(self, robot: Robot, scene: Scene, hand: HandState | None = None, tolerance: float = 0.001) -> None:
        self.scene = scene
        self.hand = hand or HandState()
        self._prefix = f"{robot.name}_"
        self._parts = _parts(robot)
        self._model = self._parts.model
        self._geometry: Any = self._parts.geometry.copy()
        for first, second in self._parts.pairs:
            self._pair(first, second)
        parts = self._parts.moving
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
        """The first contact along configurations [rad], shape (n,) or (T, n), or None where all are free."""
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
        return link_of(self._geometry.geometryObjects[index]).removeprefix(self._prefix)

    def _pair(self, first: str, second: str) -> None:
        ids = self._geometry.getGeometryId(first), self._geometry.getGeometryId(second)
        self._geometry.addCollisionPair(pinocchio.CollisionPair(*ids))

    def _add_box(self, name: str, half: NDArray[np.float64]) -> Any:
        return pinocchio.GeometryObject(name, 0, pinocchio.SE3.Identity(), coal.Box(*(2 * half)))

    def _carry(self, load: Attached) -> tuple[str, ...]:
        """Hang what is held on the last link, where the hand is fixed; return the names of its boxes."""
        frame = self._model.frames[self._model.getFrameId(TOOL)]
        names = tuple(f"{CARRIED} {index}" for index in range(len(load.half_extents)))
        for index, name in enumerate(names):
            in_tool = pinocchio.SE3(load.rotations[index], load.translations[index])
            shape = coal.Box(*(2 * load.half_extents[index]))
            box = pinocchio.GeometryObject(name, frame.parentJoint, frame.placement * in_tool, shape)
            self._geometry.addGeometryObject(box)
            for link in self._parts.meets_held:
                for near in self._parts.of_link[link]:
                    self._pair(name, near)
        return names
