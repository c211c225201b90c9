"""Does a layout keep the paper's two conditions? Where not, say so, in words.

*Object non-interactivity of stack locations*: whatever stands elsewhere, the top of a pile can be picked. Checked by
the hand's room: arm and open gripper, at each slot and several heights, must keep clear of full piles on all other
slots and of trays at all stations, in one of the four yaws, and the arm must reach slot and height from above.

*Monotone transformation non-interactivity*: toppled blocks can be picked in any order, and they lie in a region
disjoint from the stack locations. Checked by the landing strips: no slot and no station lies in one, and the arm
reaches them. That toppled blocks leave each other room is a matter of physics: `smash topple-map` measures it.

Where blocks differ, full piles are the highest that there are, and as wide as the widest block.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from smash.execution.actions.arm_motions import OPENINGS
from smash.execution.actions.topple import falling_cubes, strip
from smash.execution.scene.block_pose import QUARTER, standing
from smash.execution.scene.block_size import levels
from smash.execution.scene.tabletop import Slot, Tabletop
from smash.motion.collision import CONTACT_MARGIN, CollisionChecker
from smash.motion.kinematics import inverse
from smash.motion.obstacles import HandState, Scene
from smash.motion.poses import top_down
from smash.motion.robots import load_robot

FALLING = 4
"""Strips are checked for topples of so many blocks where the scene does not say how many shall fall.

The arm reaches them up to there at most: where blocks of larger topples come to rest is the planner's risk
(`max_topple`).
"""
FULL_STACK, FULL_BUFFER = 9, 4
"""Blocks of full piles where the scene does not say."""
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


def fallen_cubes(tabletop: Tabletop, count: int = FALLING) -> int:
    """How many cubes so many blocks of a scene, the highest ones, count as when they are toppled."""
    return falling_cubes([size.height / tabletop.cube for size in tabletop.greatest_heap(count)])


def violations(tabletop: Tabletop, height: int | None = None, buffer_height: int | None = None) -> list[Violation]:
    """Check a layout; an empty list where both conditions hold.

    Args:
        tabletop: The scene.
        height: Blocks of a full pile on a stack's slot; where None, what the slot was made for, or `FULL_STACK`.
        buffer_height: The same on a buffer's slot, or `FULL_BUFFER`.
    """
    names = [f"stacks[{index}]" for index in range(len(tabletop.stacks))]
    names += [f"buffers[{index}]" for index in range(len(tabletop.buffers))]
    named = dict(zip(names, tabletop.slots, strict=True))
    full = full_piles(tabletop, height, buffer_height)
    found = [problem for name in names for problem in _interactive(tabletop, named, name, full)]
    for name, slot in named.items():
        for direction in slot.directions:
            found += _strip_problems(tabletop, named, name, direction)
    return found


def full_piles(tabletop: Tabletop, height: int | None = None, buffer_height: int | None = None) -> dict[str, int]:
    """Blocks of a full pile on each slot, by what it is called in the scene's file (`violations` has the arguments)."""
    kinds = (("stacks", tabletop.stacks, height, FULL_STACK), ("buffers", tabletop.buffers, buffer_height, FULL_BUFFER))
    return {
        f"{kind}[{index}]": asked or slot.highest or usual
        for kind, slots, asked, usual in kinds
        for index, slot in enumerate(slots)
    }


def falling(slot: Slot) -> int:
    """How many blocks the strips of a slot are judged and drawn for."""
    return slot.falling or FALLING


def _interactive(tabletop: Tabletop, named: dict[str, Slot], name: str, full: dict[str, int]) -> list[Violation]:
    condition, slot, wide = "non-interactivity", named[name], tabletop.widest
    height = full[name]
    middles, heights = _column(tabletop, max(full.values()))
    others = [(other, level) for key, other in named.items() if key != name for level in range(full[key])]
    poses = [standing(o.x, o.y, middles[level], o.angle) for o, level in others]
    scene = Scene.of_boxes(
        [f"block {index}" for index in range(len(poses))],
        np.array([pose.position for pose in poses]).reshape(-1, 3),
        np.array([[wide / 2, wide / 2, heights[level] / 2] for _, level in others]).reshape(-1, 3),
        np.array([pose.rotation for pose in poses]).reshape(-1, 3, 3),
    )
    for index, station in enumerate(tabletop.stations):
        assert tabletop.tray is not None
        scene = scene.joined(tabletop.tray.scene(f"stations[{index}]", tabletop.tray_at(station)))
    robot = load_robot(tabletop.robot)
    hand = HandState(min(robot.hand.opening, wide / 2 + OPENINGS[-1]))
    checker = CollisionChecker(robot, scene, hand, CONTACT_MARGIN)
    for level in sorted({1, (height + 1) // 2, height}):
        point = (slot.x, slot.y, middles[level - 1])
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


def _column(tabletop: Tabletop, count: int) -> tuple[list[float], list[float]]:
    """Heights of the middles of the blocks of the highest pile of so many, lowest first, and their own heights [m]."""
    heights = [size.height for size in tabletop.greatest_heap(count)]
    return [(levels(heights[:level], own) + 0.5) * own for level, own in enumerate(heights)], heights


def _nearest(tabletop: Tabletop, named: dict[str, Slot], name: str) -> list[str]:
    slot, all_named = named[name], named | _stations(tabletop)
    others = sorted((other.distance(slot.x, slot.y), key) for key, other in all_named.items() if key != name)
    return [key for _, key in others[:2]]


def _stations(tabletop: Tabletop) -> dict[str, Slot]:
    return {f"stations[{index}]": slot for index, slot in enumerate(tabletop.stations)}


def _strip_problems(tabletop: Tabletop, named: dict[str, Slot], name: str, direction: str) -> list[Violation]:
    condition, slot, wide = "monotone transformation", named[name], tabletop.widest
    found = []
    area, robot = strip(fallen_cubes(tabletop, falling(slot))), load_robot(tabletop.robot)
    tray = 0.0 if tabletop.tray is None else min(tabletop.tray.size) / 2
    rooms = {key: (other, wide / 2) for key, other in named.items() if key != name}
    rooms |= {key: (station, tray) for key, station in _stations(tabletop).items()}
    for key, (other, half) in rooms.items():
        along, aside = slot.coordinates(other.x, other.y, direction)
        if 0 < along < area.length + half and abs(aside) < area.half_width + half:
            found.append(Violation(condition, name, f"{key} lies in the strip of a {direction} topple"))
    reached = min(area.length, strip(fallen_cubes(tabletop)).length)
    for along in np.linspace(min(2 * wide, reached), reached, STRIP_SAMPLES):
        x, y = slot.point(float(along), 0.0, direction)
        low = tabletop.block.height / 2
        if not any(inverse(robot, top_down((x, y, low), yaw), count=1) for yaw in (0.0, pi / 2)):
            problem = f"the {direction} strip is out of reach {100 * float(along):.0f} cm from the stack"
            found.append(Violation(condition, name, problem))
            break
    return found
