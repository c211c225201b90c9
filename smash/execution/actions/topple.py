"""The topple: a straight push of the closed hand through the part of a pile that shall fall.

The hand points down, its thin side along the push. It starts a run-up before the pile, with the fingertips a little
above the cut, and goes on past the first contact by more than a block's side, so that the lowest falling block leaves
its support too (paper: "a translational offset that guarantees contact in the intended direction").
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import product
from math import ceil, cos, sin

import numpy as np

from smash.execution.actions.arm_motions import ArmMotions, Segment
from smash.execution.actions.kind import AggregateMotion
from smash.execution.scene.area import Area
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.tabletop import Slot
from smash.motion.errors import NoIk, NoMotion
from smash.motion.kinematics import inverse
from smash.motion.obstacles import HandState, Scene
from smash.motion.poses import Vector, top_down
from smash.motion.robot import Hand
from smash.motion.timing import Pace
from smash.problem.actions.registry import kind_of
from smash.problem.actions.topple import Topple
from smash.problem.errors import ExecutionFailure
from smash.problem.model import State

RUN_UP = 0.10
"""From the start of the push to the first contact [m]."""
ABOVE_CUT = 0.2
"""Height of the fingertips above the cut, in sides of a block."""
PUSH_MARGIN = 0.003
"""Distance that the push keeps from all that shall not fall [m]."""
PUSH_SOLUTIONS = 6
LEAD = 0.08
"""Length of the straight descent to a push close to the table [m]."""
LANDING = {1: (0.23, 0.04), 2: (0.35, 0.05), 3: (0.52, 0.05), 4: (0.52, 0.10), 5: (0.68, 0.11)}
"""Measured: how far along the push and how far aside of it blocks come to rest [m], by the number that fall."""
HEAP = {1: 1.5, 5: 2.5}
"""How high they may lie, in sides of a block, by the least number that fall: measured 1.0, and 2.1 in two pushes."""
OVER_HEAP = 0.015
"""After a push the fingertips rise to this far above the highest heap [m]: the next motion passes over what fell."""


@dataclass(frozen=True, slots=True)
class Manner:
    """How a push is done.

    Attributes:
        speed: Of the tool [m/s].
        follow_through: How far the push goes on after the first contact, in sides of a block.
    """

    speed: float
    follow_through: float


SWEEP = Manner(0.3, 2.6)
"""The whole pile falls and nothing stands below: slowly, and far enough to clear the pile's own place."""
TALL_SWEEP = Manner(0.15, 2.6)
"""The same with 5 or 6 blocks: the upper ones would be thrown out of reach by a faster push."""
TALLEST_SWEEP = Manner(0.08, 2.6)
"""The same with more. In several pushes a second one would ram what the first has left in the strip."""
SHORT_CUT = Manner(0.5, 2.0)
"""Up to 3 blocks fall from the rest of the pile."""
TALL_CUT = Manner(0.8, 1.1)
"""More fall: a quick, short push leaves the rest of the pile where it is, a long one drags it along."""


MOST_SWEPT = 9
"""More blocks than this are not swept off the table at once, ..."""
MOST_CUT = 4
"""... and no more than this off a standing rest: the upper ones would fall out of reach. They go in several pushes."""


def first_cut(height: int, top: int) -> int:
    """The lowest level that the next push takes along, of a pile of `top` blocks that shall be cut at `height`."""
    falling = top - height + 1
    if falling <= (MOST_SWEPT if height == 1 else MOST_CUT):
        return height
    pushes = ceil(falling / MOST_CUT)
    return top - ceil(falling / pushes) + 1


def pushes_needed(height: int, top: int) -> int:
    """How many pushes a pile of `top` blocks takes that shall be cut at `height`, if each does what it should."""
    count = 0
    while top >= height:
        top = first_cut(height, top) - 1
        count += 1
    return count


def manner(height: int, falling: int) -> Manner:
    """How to topple so many blocks from this height on; measured, see `smash topple-map`."""
    if height == 1:
        return SWEEP if falling < 5 else TALL_SWEEP if falling < 7 else TALLEST_SWEEP
    return SHORT_CUT if falling <= 3 else TALL_CUT


@dataclass(frozen=True, slots=True)
class Strip:
    """Where toppled blocks may come to rest: from the slot's middle along the push, and to both sides [m]."""

    length: float
    half_width: float


def strip(falling: int) -> Strip:
    """The landing strip of a topple of so many blocks."""
    return Strip(*LANDING[min(falling, max(LANDING))])


def heap(falling: int) -> float:
    """How high so many toppled blocks may lie, in sides of a block."""
    return HEAP[max(least for least in HEAP if least <= falling)]


def directions(slot: Slot, falling: int, others: Iterable[BlockPose], side: float) -> list[str]:
    """The slot's topple directions, those first whose landing strip holds the fewest other blocks.

    Args:
        slot: Where the pile stands.
        falling: How many blocks shall fall.
        others: Poses of all that stands or lies elsewhere.
        side: Side of a block [m].
    """
    area = strip(falling)
    seen = [(float(pose.position[0]), float(pose.position[1])) for pose in others]

    def in_the_way(direction: str) -> int:
        places = [slot.coordinates(x, y, direction) for x, y in seen]
        return sum(
            -side < along < area.length + side and abs(aside) < area.half_width + side for along, aside in places
        )

    return sorted(slot.directions, key=in_the_way)


def topple(
    arm: ArmMotions,
    start: Vector,
    slot: Slot,
    pile: tuple[str, ...],
    height: int,
    poses: Mapping[str, BlockPose],
    carriers: Mapping[str, BlockPose] | None = None,
    loose: frozenset[str] = frozenset(),
    areas: Iterable[Area] = (),
) -> list[Segment]:
    """From `start` [rad] to before the pile, through its upper part, back, and up.

    The push takes what lies above `height`, or the upper part of it where that is too much for one push (`first_cut`).

    Args:
        arm: Plans motions.
        start: Where the arm is [rad], shape (n,).
        slot: Where the pile stands.
        pile: Its blocks, bottom first.
        height: The lowest level that shall fall, 1 is the bottom.
        poses: All blocks whose poses are known.
        carriers: All carriers.
        loose: Blocks that lie on the table: where there is no other way, the push shoves them along.
        areas: Where there may be more blocks.

    Raises:
        NoIk, NoMotion: where no direction allows it; the message is about the preferred one.
    """
    cut = first_cut(height, len(pile))
    falling = pile[cut - 1 :]
    others = [pose for name, pose in poses.items() if name not in pile] + list((carriers or {}).values())
    scene = arm.scene(poses, carriers, areas)
    preferred = directions(slot, len(falling), others, arm.side)
    problem: ExecutionFailure | None = None
    for shoved, direction in product(dict.fromkeys((frozenset[str](), loose)), preferred):
        try:
            return _push(arm, start, slot, direction, falling, cut, scene, shoved)
        except ExecutionFailure as failure:
            problem = problem or failure
    raise problem or NoIk("the stack has no topple direction")


class ToppleMotion(AggregateMotion[Topple]):
    """A push through the pile; where its blocks come to rest, nobody knows before."""

    action = Topple

    def plan(self, arm: ArmMotions, start: Vector, action: Topple, state: State, where: Geometry) -> list[Segment]:
        """Plan the push.

        Raises:
            NoIk, NoMotion: where no direction allows it.
        """
        pile, slot = tuple(state.piles[action.location]), where.slots[action.location]
        loose = frozenset(state.table).intersection(where.blocks)
        return topple(arm, start, slot, pile, action.height, where.blocks, where.carriers, loose, where.areas)

    def areas(self, arm: ArmMotions, action: Topple, state: State, where: Geometry) -> tuple[Area, ...]:
        """Return the strips of all directions: which of them a push will take is settled when it is made."""
        slot, fallen = where.slots[action.location], frozenset(kind_of(action).gathered(state, action))
        room = strip(len(fallen))
        height = heap(len(fallen)) * arm.side
        return tuple(Area(slot, way, room.length, room.half_width, height, fallen) for way in slot.directions)

    def foresee(self, arm: ArmMotions, action: Topple, state: State, where: Geometry) -> None:
        """Forget the poses of what falls."""
        for block in kind_of(action).gathered(state, action):
            where.blocks.pop(block, None)

    def motions(self, action: Topple, state: State) -> int:
        """Return the number of pushes."""
        return pushes_needed(action.height, len(state.piles[action.location]))

    def unfinished(self, action: Topple, state: State) -> bool:
        """Whether blocks still stand above the cut."""
        return bool(kind_of(action).gathered(state, action))

    def places(self, action: Topple) -> tuple[str, ...]:
        """Return the pile's location."""
        return (action.location,)


def _push(
    arm: ArmMotions,
    start: Vector,
    slot: Slot,
    direction: str,
    falling: tuple[str, ...],
    height: int,
    scene: Scene,
    shoved: frozenset[str],
) -> list[Segment]:
    heading = slot.heading(direction)
    along = np.array([cos(heading), sin(heading), 0.0])
    reach = _first_contact(arm.robot.hand, len(falling), arm.side)
    base = np.array([slot.x, slot.y, (height - 1 + ABOVE_CUT) * arm.side + arm.robot.hand.tip])
    how = manner(height, len(falling))
    length = RUN_UP + how.follow_through * arm.side
    closed, fallen = HandState(0.0), shoved.union(falling)
    pushed = scene.without(fallen)
    problem: ExecutionFailure | None = None
    for yaw in (heading, heading + np.pi):
        pose = top_down(base - (reach + RUN_UP) * along, yaw)
        for joints in inverse(arm.robot, pose, start, count=PUSH_SOLUTIONS):
            try:
                push = arm.planner.line(joints, length * along, pushed, hand=closed, margin=PUSH_MARGIN)
                way, away = _way_in(arm, start, joints, scene)
            except ExecutionFailure as failure:
                problem = problem or failure
                continue
            return [
                *way,
                arm.move(push, closed, fallen, PUSH_MARGIN, Pace(tool_speed=how.speed)),
                arm.move(push.reversed(), closed, fallen, PUSH_MARGIN),
                *(_rise(arm, joints, height, len(falling), scene) or away),
            ]
    raise problem or NoIk(f"the hand cannot reach the start of a {direction} push at height {height}")


def _way_in(arm: ArmMotions, start: Vector, joints: Vector, scene: Scene) -> tuple[list[Segment], list[Segment]]:
    """From `start` to before the pile and away from there: directly, or from above where the table is close.

    Raises:
        NoIk, NoMotion: where neither is possible.
    """
    closed = HandState(0.0)
    try:
        return [*arm.transfer(start, joints, scene, closed)], []
    except NoMotion:
        down = arm.planner.line(joints, (0.0, 0.0, LEAD), scene, hand=closed, margin=PUSH_MARGIN).reversed()
        above = arm.transfer(start, down.start, scene, closed)
        return [*above, arm.move(down, closed, margin=PUSH_MARGIN)], [
            arm.move(down.reversed(), closed, margin=PUSH_MARGIN)
        ]


def _rise(arm: ArmMotions, joints: Vector, height: int, falling: int, scene: Scene) -> list[Segment]:
    """From before the pile upwards until the fingertips are above what may have fallen; nothing where they are.

    Nor where the arm cannot: it then stays where it was, and what is planned from there goes its own way.
    """
    missing = heap(falling) * arm.side + OVER_HEAP - (height - 1 + ABOVE_CUT) * arm.side
    if missing <= 0.0:
        return []
    try:
        up = arm.planner.line(joints, (0.0, 0.0, missing), scene, hand=HandState(0.0), margin=PUSH_MARGIN)
    except ExecutionFailure:
        return []
    return [arm.move(up, HandState(0.0), margin=PUSH_MARGIN)]


def _first_contact(hand: Hand, falling: int, side: float) -> float:
    """Distance of the tool's axis from the pile's middle when hand or fingers first touch it [m].

    A single block passes below the palm and is met by the fingers; the palm is thicker and meets taller segments first.
    """
    palm_above_cut = ABOVE_CUT * side + hand.tip + hand.palm_depth
    thickness = hand.palm[1, 0] if falling * side > palm_above_cut else hand.finger[1, 0]
    return side / 2 + float(thickness)
