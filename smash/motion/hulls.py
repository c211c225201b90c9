"""The robot as the simulator has it: the convex hulls of its links' meshes, checked exactly with coal.

Slower than the spheres of `collision` and independent of them (pinocchio's kinematics, coal's narrow phase): the last
word, asked about every motion that the planner returns. Pairs that stay apart by spheres around the hulls are left out.
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
from smash.motion.kernel import link_frames
from smash.motion.nearness import Around, boxes_near, parts_near, places_along
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
    """The full robot, fingers included, its hulls, and which of them belong to what; hulls are known by number."""

    def __init__(self, robot: Robot) -> None:
        self.model: Any = pinocchio.buildModelFromXML(robot.urdf)
        self.data: Any = self.model.createData()
        self.tool: Any = self.model.frames[self.model.getFrameId(TOOL)]
        self.geometry = shapes(self.model, robot.urdf, str(robot.path))
        owners = [link_of(part) for part in self.geometry.geometryObjects]
        links = range(robot.count + 1)
        of_link = [[part for part, link in enumerate(owners) if robot.bodies.get(link) == body] for body in links]
        order = [link for link in robot.hand.links if link not in robot.hand.fingers] + list(robot.hand.fingers)
        of_hand = [part for link in order for part, owner in enumerate(owners) if owner == link]
        self.moving = [part for parts in of_link[2 if robot.upright else 1 :] for part in parts] + of_hand
        """Checked against the scene; what stands over its place on the table is not."""
        hand, held = links_that_hand_meets(robot, covers=False)
        self.meets_held = [part for link in held for part in of_link[link]]
        link_pairs = links_that_meet(robot, covers=False)
        self.pairs: list[tuple[int, int]] = []
        for beside_wrist in (False, True):
            near_links = [link for link in links if (link >= robot.forearm) == beside_wrist]
            for far, near in link_pairs:
                if near in near_links:
                    self.pairs += [(one, other) for one in of_link[far] for other in of_link[near]]
            near_hand = [link for link in hand if link in near_links]
            self.pairs += [(part, other) for part in of_hand for link in near_hand for other in of_link[link]]
        self._frames = np.array([robot.bodies.get(link, robot.count) for link in owners], dtype=np.int64)
        self._robot = robot
        shut, opened = self._middles(0.0), self._middles(1.0)
        self._shut, self._opening = shut, opened - shut
        self._radii = np.array([_radius(part) for part in self.geometry.geometryObjects])

    def around(self, hand: HandState) -> Around:
        """Spheres around the hulls, and then around what the hand holds."""
        owners, centres, radii = self._frames, self._shut + hand.opening * self._opening, self._radii
        if hand.attached is not None:
            load = hand.attached
            owners = np.append(owners, np.full(len(load.half_extents), self._robot.count + 1))
            centres = np.concatenate([centres, load.translations])
            radii = np.append(radii, np.linalg.norm(load.half_extents, axis=1))
        return Around(owners, centres, radii)

    def _middles(self, opening: float) -> NDArray[np.float64]:
        """Middles of the hulls in the frames of what they belong to, the fingers open by so much [m], shape (P, 3)."""
        pinocchio.forwardKinematics(self.model, self.data, np.append(self._robot.ready, [opening, opening]))
        frames, middles = link_frames(self._robot.chain, self._robot.ready), []
        for part, number in zip(self.geometry.geometryObjects, self._frames, strict=True):
            middle = (self.data.oMi[part.parentJoint] * part.placement).act(_middle(part))
            middles.append(frames[number, :, :3].T @ (middle - frames[number, :, 3]))
        return np.array(middles).reshape(-1, 3)


def _middle(part: Any) -> NDArray[np.float64]:
    """The middle of a shape's corners in its own frame [m], shape (3,)."""
    found = corners(part)
    return np.asarray((found.min(axis=0) + found.max(axis=0)) / 2)


def _radius(part: Any) -> float:
    """How far its furthest corner is from there [m]."""
    return float(np.linalg.norm(corners(part) - _middle(part), axis=1).max())


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
        self._tolerance = tolerance
        self._chain = robot.chain
        self._prefix = f"{robot.name}_"
        self._parts = parts = _parts(robot)
        self._around = parts.around(self.hand)
        known = len(parts.geometry.geometryObjects)
        held = range(known, len(self._around.radii))
        pairs = [*parts.pairs, *((load, part) for load in held for part in parts.meets_held)]
        self._pairs = np.array(pairs, dtype=np.int64).reshape(-1, 2)
        self._moving = np.array([*parts.moving, *held], dtype=np.int64)

    def contact(self, joints: NDArray[np.float64]) -> Contact | None:
        """The first contact along configurations [rad], shape (n,) or (T, n), or None where all are free."""
        motion = np.ascontiguousarray(np.atleast_2d(joints))
        geometry = self._near(motion)
        if not len(geometry.collisionPairs):
            return None
        model, data, results = self._parts.model, self._parts.data, geometry.createData()
        fingers = np.full(2, self.hand.opening)
        for step, row in enumerate(motion):
            if pinocchio.computeCollisions(model, data, geometry, results, np.concatenate([row, fingers]), True):
                return self._name_contact(geometry, results, step)
        return None

    def _near(self, motion: NDArray[np.float64]) -> Any:
        """The hulls, what is held and the boxes, with the pairs of them that come near each other along a motion."""
        owners, centres, radii = self._around
        scene, places = self.scene, places_along(self._chain, motion, owners, centres)
        geometry: Any = self._parts.geometry.copy()
        if self.hand.attached is not None:
            self._carry(geometry, self.hand.attached)
        for first, second in self._pairs[parts_near(places, radii, self._pairs)].tolist():
            geometry.addCollisionPair(pinocchio.CollisionPair(first, second))
        near = boxes_near(places, radii, self._moving, scene.centres, scene.half_extents, scene.rotations)
        for index in np.flatnonzero(near.any(axis=1)).tolist():
            box = _box(f"box {index}", 0, scene.half_extents[index] - self._tolerance)
            box.placement = pinocchio.SE3(scene.rotations[index], scene.centres[index])
            number = geometry.addGeometryObject(box)
            for part in self._moving[near[index]].tolist():
                geometry.addCollisionPair(pinocchio.CollisionPair(part, number))
        return geometry

    def _name_contact(self, geometry: Any, results: Any, step: int) -> Contact:
        index = next(number for number, result in enumerate(results.collisionResults) if result.isCollision())
        pair = geometry.collisionPairs[index]
        part, other = (self._say(geometry.geometryObjects[number]) for number in (pair.first, pair.second))
        return Contact(part, other, step)

    def _say(self, part: Any) -> str:
        name = str(part.name)
        if name.startswith("box "):
            return in_words(self.scene.names[int(name[4:])])
        if name.startswith(CARRIED):
            return CARRIED
        return link_of(part).removeprefix(self._prefix)

    def _carry(self, geometry: Any, load: Attached) -> None:
        """Hang what is held on the last link, where the hand is fixed."""
        tool = self._parts.tool
        for index, half in enumerate(load.half_extents):
            box = _box(f"{CARRIED} {index}", tool.parentJoint, half)
            box.placement = tool.placement * pinocchio.SE3(load.rotations[index], load.translations[index])
            geometry.addGeometryObject(box)


def _box(name: str, joint: int, half: NDArray[np.float64]) -> Any:
    return pinocchio.GeometryObject(name, joint, pinocchio.SE3.Identity(), coal.Box(*(2 * half)))
