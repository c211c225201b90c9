"""The fast collision checker: spheres and boxes of the robot against the boxes of a scene, in numba.

`CollisionChecker` binds one robot, one scene, one state of the hand and one margin; a state check takes microseconds.
Which parts can meet at all was found by sampling the hulls (links 5, 6, 7 and the hand reach links 0 to 2, link 7 and
the hand reach link 5; neighbours overlap by construction).
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from smash.motion import kernel
from smash.motion.obstacles import HandState, Scene, in_words
from smash.motion.poses import Vector
from smash.motion.robot import panda

DEFAULT_MARGIN = 0.010
"""Distance that a motion keeps from the scene [m]: more than the arm's tracking lag."""
CONTACT_MARGIN = -0.002
"""Margin of motions that end in contact (a block set down, a grasp): touching is no collision [m]."""
SMALLEST_STEP = 0.001
"""Least step between two checks where the arm is close to something, as the way of its fastest point [m].

With a margin the step is as long as the margin: the robot comes no nearer than half of it between two checks.
"""

BASE_PAIRS = np.array([(far, near) for far in (5, 6, 7) for near in (0, 1, 2)], dtype=np.int64)
WRIST_PAIRS = np.array([(7, 5)], dtype=np.int64)
HAND_MEETS = (0, 1, 2)
BLOCK_MEETS = (0, 1, 2, 3, 4)
FOREARM = 5
WRIST_ALLOWANCE = 0.010
"""The covers of link 5 and of the wrist may overlap by this [m]: the hulls, which are asked last, do not."""

# Hand and finger boxes in the hand's frame [m]: least and greatest corner of their hulls.
HAND_CORNERS = np.array([[-0.0317, -0.1041, -0.0260], [0.0317, 0.1005, 0.0661]])
FINGER_CORNERS = np.array([[-0.0106, -0.0002, 0.0584], [0.0106, 0.0265, 0.1123]])
FINGER_JOINT_Z = 0.0584
"""From the hand's frame to the fingers' frames, along z [m]."""
HAND_TO_TOOL = 0.105
"""From the hand's frame to the tool frame, along z [m]."""


@lru_cache(maxsize=1)
def arm_model() -> kernel.Arm:
    """The arm's spheres, from `panda_spheres.csv`."""
    rows = np.loadtxt(Path(__file__).with_name("panda_spheres.csv"), delimiter=",", skiprows=1)
    first = np.searchsorted(rows[:, 0], np.arange(9)).astype(np.int64)
    bounds = np.empty((8, 4))
    for link in range(8):
        own = rows[first[link] : first[link + 1], 1:]
        centre = (own[:, :3].min(axis=0) + own[:, :3].max(axis=0)) / 2
        bounds[link, :3] = centre
        bounds[link, 3] = np.max(np.linalg.norm(own[:, :3] - centre, axis=1) + own[:, 3])
    chain, spheres = np.ascontiguousarray(panda().chain()), np.ascontiguousarray(rows[:, 1:])
    return kernel.Arm(chain, spheres, first, bounds, BASE_PAIRS, WRIST_PAIRS)


class CollisionChecker:
    """Is a configuration, or the straight joint segment between two, free of collisions?

    Args:
        scene: What must not be touched; leave out what may be (`Scene.without`).
        hand: Finger opening and carried block.
        margin: Distance to keep from the scene [m].
    """

    def __init__(self, scene: Scene, hand: HandState | None = None, margin: float = DEFAULT_MARGIN) -> None:
        self.scene = scene
        self.hand = hand or HandState()
        self.margin = margin
        self._smallest = max(SMALLEST_STEP, float(margin))
        boxes = _hand_boxes(self.hand)
        demands = kernel.Demands(float(margin), WRIST_ALLOWANCE, *_hand_pairs(len(boxes.centres)))
        around = kernel.Boxes(scene.centres, scene.half_extents, scene.rotations)
        self._setting = (arm_model(), boxes, around, demands)

    def slack(self, joints: Vector) -> float:
        """How much nearer anything may come at `joints` [rad], shape (7,), before it is refused [m]; free above 0."""
        return float(kernel.state_slack(joints, *self._setting))

    def free(self, joints: Vector) -> bool:
        """Whether the configuration is free."""
        return self.slack(joints) > 0.0

    def segment_free(self, begin: Vector, end: Vector) -> bool:
        """Whether all of the straight joint segment is free."""
        return self.path_free(np.stack([begin, end]))

    def segment_reach(self, begin: Vector, end: Vector) -> float:
        """The part of the segment that is free, from its beginning: 1 is all of it."""
        return float(kernel.motion_free(begin, end, self._smallest, *self._setting))

    def path_free(self, waypoints: NDArray[np.float64]) -> bool:
        """Whether all segments between consecutive waypoints [rad], shape (W, 7), are free."""
        return kernel.polyline_free(np.ascontiguousarray(waypoints), self._smallest, *self._setting)

    def blockers(self, joints: Vector) -> tuple[str, ...]:
        """What is too close at `joints`: names of blocks, "the table", "the robot itself"; empty where free."""
        if not CollisionChecker(self.scene.none(), self.hand, self.margin).free(joints):
            return ("the robot itself",)
        close = []
        for index, name in enumerate(self.scene.names):
            if not CollisionChecker(self.scene.only(index), self.hand, self.margin).free(joints):
                close.append(in_words(name))
        return tuple(dict.fromkeys(close))


def _hand_boxes(hand: HandState) -> kernel.Boxes:
    """Hand, left and right finger, and what they hold, as boxes in the tool frame."""
    left = FINGER_CORNERS + np.array([0.0, hand.opening, 0.0])
    right = left * np.array([1.0, -1.0, 1.0])
    corners = np.stack([HAND_CORNERS, left, right])
    centres = corners.mean(axis=1) - np.array([0.0, 0.0, HAND_TO_TOOL])
    half = np.abs(corners[:, 1] - corners[:, 0]) / 2
    rotations = np.tile(np.eye(3), (3, 1, 1))
    if hand.attached is not None:
        centres = np.vstack([centres, hand.attached.translations])
        half = np.vstack([half, hand.attached.half_extents])
        rotations = np.concatenate([rotations, hand.attached.rotations])
    return kernel.Boxes(*(np.ascontiguousarray(array) for array in (centres, half, rotations)))


def _hand_pairs(boxes: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of hand box and link that can meet: those near the base, and those with the forearm."""
    base = [(box, link) for box in range(3) for link in HAND_MEETS]
    base += [(box, link) for box in range(3, boxes) for link in BLOCK_MEETS]
    wrist = [(box, FOREARM) for box in range(boxes)]
    return np.array(base, dtype=np.int64), np.array(wrist, dtype=np.int64)
