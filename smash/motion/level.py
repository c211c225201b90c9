"""Level motions: what the hand carries does not tilt and is hardly shaken, so that what stands on it stays.

A level way is a straight line up, one outward or inward, a turn of the first joint, whose axis is vertical, a line to
above the target and one down to it. The tool keeps its orientation on lines and turns about the vertical in between:
the way is level throughout, by construction. Each piece begins and ends at rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike

from smash.motion.collision import CONTACT_MARGIN, DEFAULT_MARGIN, CollisionChecker
from smash.motion.errors import NoMotion
from smash.motion.kinematics import descend
from smash.motion.move import Move
from smash.motion.obstacles import BodyName, HandState, Scene
from smash.motion.paths import Path
from smash.motion.planner import MotionPlanner
from smash.motion.poses import ToolPose, Vector
from smash.motion.robot import Robot
from smash.motion.timing import time_gently
from smash.problem.errors import ExecutionFailure

Piece = tuple[Path, float]
"""A path and the distance from other things that it keeps [m]."""

GRAVITY = 9.81
SHORTEST = 0.0005
"""Lines shorter than this are left out [m]."""
FRICTION_SHARE = 0.4
"""What is carried is accelerated by this share of what friction would bear."""
SPEED = 0.5
"""Greatest speed of what is carried [m/s]."""
RISES = (0.05, 0.10, 0.16, 0.22, 0.28, 0.34)
"""How far above the higher of both ends the way runs [m], the first that is free."""
RADII = (0.45, 0.38, 0.52, 0.58, 0.32)
"""Distances from the first joint's axis at which the turn is tried, after those of both ends [m]."""


@dataclass(frozen=True, slots=True)
class Gentleness:
    """How what is carried may be moved.

    Attributes:
        acceleration: Greatest, in any horizontal direction [m/s2].
        speed: Greatest [m/s].
    """

    acceleration: float
    speed: float = SPEED

    @staticmethod
    def of_friction(*coefficients: float) -> Gentleness:
        """As gentle as a contact of two bodies with these Coulomb coefficients asks for."""
        return Gentleness(FRICTION_SHARE * float(np.prod(coefficients)) * GRAVITY)


def level_way(
    planner: MotionPlanner,
    start: Vector,
    target: ToolPose,
    scene: Scene,
    hand: HandState,
    ignored: frozenset[BodyName],
    manner: Gentleness,
) -> list[Move]:
    """Motions from `start` to `target` that keep the tool's tilt.

    Args:
        planner: Plans the pieces.
        start: Where the arm is [rad], shape (n,).
        target: Where the tool shall be; its orientation is the present one turned about the vertical.
        scene: What must not be touched; what is carried is left out.
        hand: Fingers and what they hold.
        ignored: Names of what is carried.
        manner: How fast.

    Raises:
        NoIk, NoMotion: where no such way is free; the message is about the lowest.
    """
    if not planner.robot.upright:
        raise NoMotion(f"the first joint of robot {planner.robot.name!r} does not turn it about the vertical")
    search = _Search(planner, target, scene, hand)
    pieces = search.way(start)
    return [_gentle(planner.robot, path, hand, ignored, margin, manner) for path, margin in pieces]


class _Search:
    """Level ways to one target, low ones first; a piece that is blocked rules out all ways that begin with it."""

    def __init__(self, planner: MotionPlanner, target: ToolPose, scene: Scene, hand: HandState) -> None:
        self._planner = planner
        self._robot = planner.robot
        self._target = target
        self._scene = scene
        self._hand = hand

    def way(self, start: Vector) -> list[Piece]:
        """The first way that is free.

        Raises:
            NoIk, NoMotion: where none is.
        """
        tool, target = self._robot.forward(start), self._target
        turns = self._turns(start, tool)
        x, y, z = (float(value) for value in tool.position)
        bearing = atan2(y, x)
        radii = dict.fromkeys((hypot(x, y), hypot(*target.position[:2]), *RADII))
        problem: ExecutionFailure | None = None
        for rise in RISES:
            height = max(z, float(target.position[2])) + rise
            try:
                up = self._line(start, (x, y, height), CONTACT_MARGIN)
            except ExecutionFailure as failure:
                raise problem or failure from None
            for radius in radii:
                try:
                    out = self._line(_end(up, start), (radius * cos(bearing), radius * sin(bearing), height))
                except ExecutionFailure as failure:
                    problem = problem or failure
                    continue
                for turn in turns:
                    try:
                        return [*up, *out, *self._turned(_end([*up, *out], start), turn, height)]
                    except ExecutionFailure as failure:
                        problem = problem or failure
        assert problem is not None
        raise problem

    def _turns(self, start: Vector, tool: ToolPose) -> list[float]:
        """Turns of the first joint that give the tool the target's yaw and leave the target in reach [rad].

        Raises:
            NoMotion: where there is none.
        """
        relative = self._target.rotation @ tool.rotation.T
        turn = atan2(float(relative[1, 0]), float(relative[0, 0]))
        both = sorted((turn - 2 * pi, turn, turn + 2 * pi), key=abs)
        checker = CollisionChecker(self._robot, self._scene, self._hand, CONTACT_MARGIN)
        for angle in list(both):
            there = descend(self._robot, self._target, start + angle * self._robot.first_joint)
            if there is None or not checker.free(there):
                both.remove(angle)
        if not both:
            raise NoMotion("no turn of the first joint brings what is carried to its place")
        return both

    def _turned(self, now: Vector, turn: float, height: float) -> list[Piece]:
        """The turn, the line to above the target, and the line down.

        Raises:
            NoIk, NoMotion: at the first that is not possible.
        """
        x, y, z = (float(value) for value in self._target.position)
        around = self._planner.straight(now, now + turn * self._robot.first_joint, self._scene, hand=self._hand)
        across = self._line(around.end, (x, y, height))
        down = self._line(_end(across, around.end), (x, y, z), CONTACT_MARGIN)
        return [(around, DEFAULT_MARGIN), *across, *down]

    def _line(self, now: Vector, point: ArrayLike, margin: float = DEFAULT_MARGIN) -> list[Piece]:
        """A straight line to a point, or nothing where the tool is there.

        Raises:
            NoIk, NoMotion: where it is not possible.
        """
        offset = np.asarray(point) - self._robot.forward(now).position
        if np.linalg.norm(offset) < SHORTEST:
            return []
        return [(self._planner.line(now, offset, self._scene, hand=self._hand, margin=margin), margin)]


def _end(pieces: Sequence[Piece], start: Vector) -> Vector:
    return pieces[-1][0].end if pieces else start


def _gentle(
    robot: Robot, path: Path, hand: HandState, ignored: frozenset[BodyName], margin: float, manner: Gentleness
) -> Move:
    """The timed motion; on an arc half of the acceleration bends the way."""
    ends = robot.forward(path.start).position, robot.forward(path.end).position
    if path.kind == "straight":
        radius = hypot(*ends[0][:2]) + _reach(hand)
        length = max(radius * abs(float(path.end[0] - path.start[0])), SHORTEST)
        along = manner.acceleration / sqrt(2)
        trajectory = time_gently(robot, path, length, min(manner.speed, sqrt(along * radius)), along)
    else:
        length = float(np.linalg.norm(ends[1] - ends[0]))
        trajectory = time_gently(robot, path, length, manner.speed, manner.acceleration)
    return Move(robot, path, trajectory, hand, ignored, margin)


def _reach(hand: HandState) -> float:
    """How far what is carried reaches from the tool's point [m], at most."""
    if hand.attached is None:
        return 0.0
    return float(np.linalg.norm(hand.attached.translations, axis=1).max())
