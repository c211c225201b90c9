"""The fast collision checker: spheres and boxes of the robot against the boxes of a scene, in numba.

`CollisionChecker` binds one robot, one scene, one state of the hand and one margin; a state check takes microseconds.
Which parts are asked about each other the robot's file says: neighbours overlap by construction, and others never meet.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from smash.motion import kernel
from smash.motion.covers import read_cover
from smash.motion.obstacles import HandState, Scene, in_words
from smash.motion.poses import Vector
from smash.motion.robot import HAND, Hand, Robot

DEFAULT_MARGIN = 0.010
"""Distance that a motion keeps from the scene [m]: more than the arm's tracking lag."""
CONTACT_MARGIN = -0.002
"""Margin of motions that end in contact (a block set down, a grasp): touching is no collision [m]."""
SMALLEST_STEP = 0.001
"""Least step between two checks where the arm is close to something, as the way of its fastest point [m].

With a margin the step is as long as the margin: the robot comes no nearer than half of it between two checks.
"""

WRIST_ALLOWANCE = 0.010
"""The covers of the forearm and of the wrist may overlap by this [m]: the hulls, which are asked last, do not."""
NOWHERE = -1e3
"""Radius of the sphere around a link that has no shape [m]: it is near nothing."""


def links_that_meet(robot: Robot, *, covers: bool) -> list[tuple[int, int]]:
    """Return the pairs of links that can meet, the outer one first; those that meet beside the wrist last.

    Args:
        robot: The robot.
        covers: Leave out those whose covers touch by construction.
    """
    left_out = robot.apart | robot.touching if covers else robot.apart
    links = range(robot.count + 1)
    pairs = [(far, near) for far in links for near in links[: max(0, far - 1)]]
    met = [pair for pair in pairs if frozenset(pair) not in left_out]
    return sorted(met, key=lambda pair: pair[1] >= robot.forearm)


def links_that_hand_meets(robot: Robot, *, covers: bool) -> tuple[list[int], list[int]]:
    """Return the links that the hand can meet, and those that what it holds can.

    Args:
        robot: The robot.
        covers: Leave out those whose covers touch by construction.
    """
    left_out = robot.apart | robot.touching if covers else robot.apart
    beyond = list(range(robot.count - 1))
    return [link for link in beyond if frozenset((HAND, link)) not in left_out], beyond


@lru_cache(maxsize=16)
def arm_model(robot: Robot) -> kernel.Arm:
    """The arm's spheres, from the table that its file names.

    Raises:
        MalformedFile: where there is none, or it is of other links.
    """
    spheres, first = read_cover(robot)
    links = robot.count + 1
    bounds = np.zeros((links, 4))
    bounds[:, 3] = NOWHERE
    for link in range(links):
        own = spheres[first[link] : first[link + 1]]
        if len(own):
            centre = (own[:, :3].min(axis=0) + own[:, :3].max(axis=0)) / 2
            bounds[link, :3] = centre
            bounds[link, 3] = np.max(np.linalg.norm(own[:, :3] - centre, axis=1) + own[:, 3])
    pairs = links_that_meet(robot, covers=True)
    base = [pair for pair in pairs if pair[1] < robot.forearm]
    wrist = [pair for pair in pairs if pair[1] >= robot.forearm]
    return kernel.Arm(
        robot.chain,
        np.ascontiguousarray(spheres),
        first,
        bounds,
        np.arange(links + 1),
        _pairs(base),
        _pairs(wrist),
        robot.forearm,
        2 if robot.upright else 1,
    )


class CollisionChecker:
    """Is a configuration, or the straight joint segment between two, free of collisions?

    Args:
        robot: Whose configurations they are.
        scene: What must not be touched; leave out what may be (`Scene.without`).
        hand: Finger opening and carried block.
        margin: Distance to keep from the scene [m].
    """

    def __init__(
        self, robot: Robot, scene: Scene, hand: HandState | None = None, margin: float = DEFAULT_MARGIN
    ) -> None:
        self.robot = robot
        self.scene = scene
        self.hand = hand or HandState()
        self.margin = margin
        self._smallest = max(SMALLEST_STEP, float(margin))
        boxes = _hand_boxes(robot.hand, self.hand)
        demands = kernel.Demands(float(margin), WRIST_ALLOWANCE, *_hand_pairs(robot, len(boxes.centres)))
        around = kernel.Boxes(scene.centres, scene.half_extents, scene.rotations)
        self._setting = (arm_model(robot), boxes, around, demands)

    def slack(self, joints: Vector) -> float:
        """How much nearer anything may come at `joints` [rad], shape (n,), before it is refused [m]; free above 0."""
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
        """Whether all segments between consecutive waypoints [rad], shape (W, n), are free."""
        return kernel.polyline_free(np.ascontiguousarray(waypoints), self._smallest, *self._setting)

    def blockers(self, joints: Vector) -> tuple[str, ...]:
        """What is too close at `joints`: names of blocks, "the table", "the robot itself"; empty where free."""
        if not CollisionChecker(self.robot, self.scene.none(), self.hand, self.margin).free(joints):
            return ("the robot itself",)
        close = []
        for index, name in enumerate(self.scene.names):
            if not CollisionChecker(self.robot, self.scene.only(index), self.hand, self.margin).free(joints):
                close.append(in_words(name))
        return tuple(dict.fromkeys(close))


def _hand_boxes(hand: Hand, state: HandState) -> kernel.Boxes:
    """Palm, left and right finger, and what they hold, as boxes in the tool frame."""
    boxes = _empty_hand(hand, state.opening)
    if state.attached is None:
        return boxes
    load = state.attached
    return kernel.Boxes(
        np.concatenate([boxes.centres, load.translations]),
        np.concatenate([boxes.half, load.half_extents]),
        np.concatenate([boxes.axes, load.rotations]),
    )


@lru_cache(maxsize=64)
def _empty_hand(hand: Hand, opening: float) -> kernel.Boxes:
    """Palm, left and right finger, so far open [m], as boxes in the tool frame."""
    left = hand.finger + np.array([0.0, opening, 0.0])
    right = left * np.array([1.0, -1.0, 1.0])
    corners = np.stack([hand.palm, left, right])
    return kernel.Boxes(
        corners.mean(axis=1) - hand.tool, np.abs(corners[:, 1] - corners[:, 0]) / 2, np.tile(np.eye(3), (3, 1, 1))
    )


@lru_cache(maxsize=64)
def _hand_pairs(robot: Robot, boxes: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of hand box and link that can meet: those near the base, and those with the forearm."""
    own, held = links_that_hand_meets(robot, covers=True)
    pairs = [(box, link) for box in range(boxes) for link in (own if box < 3 else held)]
    base = [pair for pair in pairs if pair[1] < robot.forearm]
    wrist = [pair for pair in pairs if pair[1] >= robot.forearm]
    return _pairs(base), _pairs(wrist)


def _pairs(pairs: list[tuple[int, int]]) -> NDArray[np.int64]:
    return np.array(pairs, dtype=np.int64).reshape(-1, 2)
