"""How high a pile an arm can handle at which distance: what `[reach]` of a robot file says, measured."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from smash.motion.collision import CONTACT_MARGIN, CollisionChecker
from smash.motion.errors import NoIk, NoMotion
from smash.motion.kinematics import inverse
from smash.motion.obstacles import HandState, Scene
from smash.motion.planner import MotionPlanner
from smash.motion.poses import top_down
from smash.motion.robot import Robot
from smash.motion.robots.files import LEVEL

RADII = tuple(round(0.15 + 0.05 * step, 2) for step in range(18))
"""Distances from the base that are looked at [m]."""
MOST_LEVELS = 15
ROOM = 0.010
"""Between an open finger and the block [m]."""
DESCENT = 0.03
"""Length of the straight way down to the block, the least that picks and places have [m]."""
SOLUTIONS = 6


def measured_reach(robot: Robot, radii: Iterable[float] = RADII) -> Iterator[tuple[float, int]]:
    """Yield distances from the base [m] and how many blocks of 4.5 cm a pile may have there.

    The top block is taken from above, the fingers along either of its sides, and everything stands on the table; a
    level counts where all below it do. The pile stands straight ahead: arms turn about the vertical.
    """
    for radius in radii:
        levels = 0
        while levels < MOST_LEVELS and _reached(robot, radius, levels + 1):
            levels += 1
        yield radius, levels


def _reached(robot: Robot, radius: float, level: int) -> bool:
    """Whether the block of a level can be taken from above, with the levels below it standing."""
    below = [((index + 0.5) * LEVEL) for index in range(level - 1)]
    scene = Scene.of_boxes([str(z) for z in below], [[radius, 0.0, z] for z in below], LEVEL / 2).with_table()
    hand = HandState(min(robot.hand.opening, LEVEL / 2 + ROOM))
    checker = CollisionChecker(robot, scene, hand, CONTACT_MARGIN)
    planner = MotionPlanner(robot)
    for quarter in range(4):
        pose = top_down((radius, 0.0, (level - 0.5) * LEVEL), quarter * np.pi / 2)
        for joints in inverse(robot, pose, count=SOLUTIONS):
            if not checker.free(joints):
                continue
            try:
                planner.line(joints, (0.0, 0.0, DESCENT), scene, hand=hand)
            except (NoIk, NoMotion):
                continue
            return True
    return False
