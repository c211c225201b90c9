"""Has the hand room at each slot, whatever stands elsewhere? Asked so often that poses are solved once a distance.

The arm stands on a vertical first joint: what it does at one bearing it does at all, as far as that joint turns. So
the arm's configurations for a distance and a height are found once and turned.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
from numpy.typing import NDArray

from smash.execution.actions.arm_motions import OPENINGS
from smash.execution.scene.block_pose import QUARTER
from smash.execution.scene.tabletop import Slot
from smash.motion.collision import CollisionChecker
from smash.motion.kinematics import along_line, inverse
from smash.motion.obstacles import HandState, Scene
from smash.motion.poses import Vector, top_down, yaw_rotation
from smash.motion.robot import Robot

ROOM = 0.004
"""The hand keeps this far from all piles [m]: more than a pick asks for."""
LIFT = (0.03, 0.06)
"""It comes straight down from so far above [m], the last one the beginning."""
POSTURES = 4
"""Configurations that are looked for with each of the four yaws."""


class HandRoom:
    """Asks the collision checker about picks among full piles.

    Args:
        side: Of a block [m].
        robot: Whose hand; its first joint turns it about the vertical.
    """

    def __init__(self, side: float, robot: Robot) -> None:
        self._side = side
        self._robot = robot
        self._hand = HandState(min(robot.hand.opening, side / 2 + OPENINGS[0]))
        self._ways: dict[tuple[float, int], list[NDArray[np.float64]]] = {}

    def among(self, slots: Sequence[Slot]) -> bool:
        """Whether the bottom, middle and top block of every pile can be picked while all others stand in full."""
        piles = self._piles(slots)
        for index, slot in enumerate(slots):
            assert slot.highest is not None
            others = piles.without([str(index)]).with_table()
            checker = CollisionChecker(self._robot, others, self._hand, ROOM)
            for level in sorted({1, (slot.highest + 1) // 2, slot.highest}):
                if not any(self._free(way, slot.angle, checker) for way in self._ways_down(slot.radius, level)):
                    return False
        return True

    def _piles(self, slots: Sequence[Slot]) -> Scene:
        tall = np.array([(slot.highest or 0) * self._side for slot in slots])
        centres = np.array([[slot.x, slot.y, high / 2] for slot, high in zip(slots, tall, strict=True)])
        half = np.array([[self._side / 2, self._side / 2, high / 2] for high in tall])
        turned = np.array([yaw_rotation(slot.angle) for slot in slots])
        return Scene.of_boxes([str(index) for index in range(len(slots))], centres, half, turned)

    def _free(self, way: NDArray[np.float64], angle: float, checker: CollisionChecker) -> bool:
        """Whether a way down, shape (3, n) [rad], is free at a bearing, at its three points."""
        turned = way.copy()
        turned[:, 0] = (way[:, 0] + angle + pi) % (2 * pi) - pi
        return self._robot.within_limits(turned) and all(checker.free(joints) for joints in turned)

    def _ways_down(self, radius: float, level: int) -> list[NDArray[np.float64]]:
        """Ways down to a block at this distance, straight ahead, the block's end first."""
        key = round(radius, 6), level
        if key not in self._ways:
            point = (radius, 0.0, (level - 0.5) * self._side)
            found: list[Vector] = []
            for turn in range(4):
                found += inverse(self._robot, top_down(point, turn * QUARTER), count=POSTURES)
            ups = [np.array([0.0, 0.0, up]) for up in LIFT]
            lifted = [(joints, along_line(self._robot, joints, ups)) for joints in found]
            self._ways[key] = [np.stack([joints, *rows]) for joints, rows in lifted if rows is not None]
        return self._ways[key]
