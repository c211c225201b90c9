"""Level motions: what the hand carries does not tilt and is hardly shaken, so that what stands on it stays.

A level way is a straight line up, one outward or inward, a turn of the first joint, whose axis is vertical, a line to
above the target and one down to it. The tool keeps its orientation on lines and turns about the vertical in between:
the way is level throughout, by construction. Each piece begins and ends at rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product
from math import atan2, cos, hypot, pi, sin, sqrt

import numpy as np

from smash.execution.collision import CONTACT_MARGIN, DEFAULT_MARGIN
from smash.execution.errors import ExecutionFailure, NoMotion
from smash.execution.paths import Path
from smash.execution.poses import ToolPose, Vector
from smash.execution.robot import LOWER, UPPER, panda
from smash.execution.scene import BodyName, HandState, Scene
from smash.execution.steps import Move, Steps
from smash.execution.timing import time_gently

GRAVITY = 9.81
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
    steps: Steps,
    start: Vector,
    target: ToolPose,
    scene: Scene,
    hand: HandState,
    ignored: frozenset[BodyName],
    manner: Gentleness,
) -> list[Move]:
    """Motions from `start` to `target` that keep the tool's tilt.

    Args:
        steps: Plans motions.
        start: Where the arm is [rad], shape (7,).
        target: Where the tool shall be; its orientation is the present one turned about the vertical.
        scene: What must not be touched; what is carried is left out.
        hand: Fingers and what they hold.
        ignored: Names of what is carried.
        manner: How fast.

    Raises:
        NoMotion: where no such way is free; the message is about the lowest.
    """
    tool = panda().forward(start)
    problem: ExecutionFailure | None = None
    ends = hypot(*tool.position[:2]), hypot(*target.position[:2])
    for rise, radius, turn in product(RISES, dict.fromkeys((*ends, *RADII)), _turns(start, tool, target)):
        height = max(tool.position[2], target.position[2]) + rise
        try:
            pieces = list(_pieces(steps, start, target, height, radius, turn, scene, hand))
        except ExecutionFailure as failure:
            problem = problem or failure
            continue
        return [_gentle(path, hand, ignored, margin, manner) for path, margin in pieces]
    raise problem or NoMotion("the first joint's limits leave no level way there")


def _turns(start: Vector, tool: ToolPose, target: ToolPose) -> list[float]:
    """Turns of the first joint that give the tool the target's yaw within the joint's limits [rad], shortest first."""
    relative = target.rotation @ tool.rotation.T
    turn = atan2(float(relative[1, 0]), float(relative[0, 0]))
    both = sorted((turn - 2 * pi, turn, turn + 2 * pi), key=abs)
    return [angle for angle in both if LOWER[0] <= start[0] + angle <= UPPER[0]]


def _pieces(
    steps: Steps,
    start: Vector,
    target: ToolPose,
    height: float,
    radius: float,
    turn: float,
    scene: Scene,
    hand: HandState,
) -> Iterator[tuple[Path, float]]:
    """The way's paths with the margins that they keep.

    Raises:
        NoIk, NoMotion: at the first that is not possible.
    """
    at = panda().forward(start).position
    bearing = atan2(at[1], at[0])
    turned = np.array([radius * cos(bearing + turn), radius * sin(bearing + turn), height])
    x, y, z = target.position
    now = start
    lines: Iterable[tuple[Vector, float]] = (
        (np.array([at[0], at[1], height]), CONTACT_MARGIN),
        (np.array([radius * cos(bearing), radius * sin(bearing), height]), DEFAULT_MARGIN),
        (turned, DEFAULT_MARGIN),
        (np.array([x, y, height]), DEFAULT_MARGIN),
        (np.array([x, y, z]), CONTACT_MARGIN),
    )
    for point, margin in lines:
        if point is turned:
            end = now + np.array([turn, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
            path = steps.motion.straight(now, end, scene, hand=hand, margin=margin)
        else:
            offset = point - panda().forward(now).position
            if np.linalg.norm(offset) < SHORTEST:
                continue
            path = steps.motion.line(now, offset, scene, hand=hand, margin=margin)
        now = path.end
        yield path, margin


SHORTEST = 0.0005
"""Lines shorter than this are left out [m]."""


def _gentle(path: Path, hand: HandState, ignored: frozenset[BodyName], margin: float, manner: Gentleness) -> Move:
    """The timed motion; on an arc half of the acceleration bends the way."""
    ends = panda().forward(path.start).position, panda().forward(path.end).position
    if path.kind == "straight":
        radius = hypot(*ends[0][:2]) + _reach(hand)
        length = max(radius * abs(float(path.end[0] - path.start[0])), SHORTEST)
        along = manner.acceleration / sqrt(2)
        trajectory = time_gently(path, length, min(manner.speed, sqrt(along * radius)), along)
    else:
        length = float(np.linalg.norm(ends[1] - ends[0]))
        trajectory = time_gently(path, length, manner.speed, manner.acceleration)
    return Move(path, trajectory, hand, ignored, margin)


def _reach(hand: HandState) -> float:
    """How far what is carried reaches from the tool's point [m], at most."""
    if hand.attached is None:
        return 0.0
    return float(np.linalg.norm(hand.attached.translations, axis=1).max())
