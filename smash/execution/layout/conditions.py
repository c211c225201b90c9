"""Does a layout keep the paper's two conditions? Where not, say so, in words.

*Object non-interactivity of stack locations*: whatever stands elsewhere, the top of a pile can be picked. Checked by
the hand's room: arm and open gripper, at each slot and several heights, must keep clear of full piles on all other
slots and of trays at all stations, in one of the four yaws, and the arm must reach slot and height from above.

*Monotone transformation non-interactivity*: toppled blocks can be picked in any order, and they lie in a region
disjoint from the stack locations. Checked by the landing strips: no slot and no station lies in one, and the arm
reaches them. That toppled blocks leave each other room is a matter of physics: `smash topple-map` measures it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from smash.execution.actions.arm_motions import OPENINGS
from smash.execution.actions.topple import strip
from smash.execution.scene.block_pose import QUARTER, standing
from smash.execution.scene.tabletop import Slot, Tabletop
from smash.motion.collision import CONTACT_MARGIN, CollisionChecker
from smash.motion.kinematics import inverse
from smash.motion.obstacles import HandState, Scene
from smash.motion.poses import top_down
from smash.motion.robots import load_robot

FALLING = 4
"""Strips are checked for topples of so many blocks: larger ones are the planner's risk (`max_topple`)."""
STRIP_SAMPLES = 6
SOLUTIONS = 8


@dataclass(frozen=True, slots=True)
class Violation:
    """Where a layout breaks a condition: which of the two, at which slot, and how."""

    condition: str
    slot: str
    problem: str

    def __str__(self) -> str:
        return f"{self.condition}: {self.slot}: {self.problem}"


def violations(tabletop: Tabletop, height: int = 9, buffer_height: int = 4) -> list[Violation]:
    """Check a layout; an empty list where both conditions hold.

    Args:
        tabletop: The scene.
        height: Blocks of a full pile on a stack's slot.
        buffer_height: The same on a buffer's slot.
    """
    names = [f"stacks[{index}]" for index in range(len(tabletop.stacks))]
    names += [f"buffers[{index}]" for index in range(len(tabletop.buffers))]
    named = dict(zip(names, tabletop.slots, strict=True))
    full = {name: height if slot.directions else buffer_height for name, slot in named.items()}
    found = [problem for name in names for problem in _interactive(tabletop, named, name, full)]
    for name, slot in named.items():
        for direction in slot.directions:
            found += _strip_problems(tabletop, named, name, direction)
    return found


def _interactive(tabletop: Tabletop, named: dict[str, Slot], name: str, full: dict[str, int]) -> list[Violation]:
    condition, slot, side = "non-interactivity", named[name], tabletop.side
    height = full[name]
    others = [(other, full[key]) for key, other in named.items() if key != name]
    poses = [standing(o.x, o.y, (level + 0.5) * side, o.angle) for o, count in others for level in range(count)]
    scene = Scene.of_boxes(
        [f"block {index}" for index in range(len(poses))],
        np.array([pose.position for pose in poses]).reshape(-1, 3),
        side / 2,
        np.array([pose.rotation for pose in poses]).reshape(-1, 3, 3),
    )
    for index, station in enumerate(tabletop.stations):
        assert tabletop.tray is not None
        scene = scene.joined(tabletop.tray.scene(f"stations[{index}]", tabletop.tray_at(station)))
    robot = load_robot(tabletop.robot)
    hand = HandState(min(robot.hand.opening, side / 2 + OPENINGS[-1]))
    checker = CollisionChecker(robot, scene, hand, CONTACT_MARGIN)
    for level in sorted({1, (height + 1) // 2, height}):
        point = (slot.x, slot.y, (level - 0.5) * side)
        solutions = [
            joints
            for turn in range(4)
            for joints in inverse(robot, top_down(point, slot.angle + turn * QUARTER), count=SOLUTIONS)
        ]
        if not solutions:
            return [Violation(condition, name, f"the hand does not reach height {level} from above")]
        if not any(checker.free(joints) for joints in solutions):
            blocked = ", ".join(_nearest(tabletop, named, name))
            problem = f"what stands at {blocked} leaves no room for the hand at height {level}"
            return [Violation(condition, name, problem)]
    return []


def _nearest(tabletop: Tabletop, named: dict[str, Slot], name: str) -> list[str]:
    slot, all_named = named[name], named | _stations(tabletop)
    others = sorted((other.distance(slot.x, slot.y), key) for key, other in all_named.items() if key != name)
    return [key for _, key in others[:2]]


def _stations(tabletop: Tabletop) -> dict[str, Slot]:
    return {f"stations[{index}]": slot for index, slot in enumerate(tabletop.stations)}


def _strip_problems(tabletop: Tabletop, named: dict[str, Slot], name: str, direction: str) -> list[Violation]:
    condition, slot, side = "monotone transformation", named[name], tabletop.side
    found = []
    area, robot = strip(FALLING), load_robot(tabletop.robot)
    tray = 0.0 if tabletop.tray is None else min(tabletop.tray.size) / 2
    rooms = {key: (other, side / 2) for key, other in named.items() if key != name}
    rooms |= {key: (station, tray) for key, station in _stations(tabletop).items()}
    for key, (other, half) in rooms.items():
        along, aside = slot.coordinates(other.x, other.y, direction)
        if 0 < along < area.length + half and abs(aside) < area.half_width + half:
            found.append(Violation(condition, name, f"{key} lies in the strip of a {direction} topple"))
    for along in np.linspace(2 * side, area.length, STRIP_SAMPLES):
        x, y = slot.point(float(along), 0.0, direction)
        if not any(inverse(robot, top_down((x, y, side / 2), yaw), count=1) for yaw in (0.0, pi / 2)):
            problem = f"the {direction} strip is out of reach {100 * float(along):.0f} cm from the stack"
            found.append(Violation(condition, name, problem))
            break
    return found
