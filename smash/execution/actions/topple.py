"""The topple: a straight push of the closed hand through the part of a pile that shall fall.

The hand points down, its thin side along the push. It starts a run-up before the pile, with the fingertips a little
above the cut, and goes on past the first contact by more than a block's side, so that the lowest falling block leaves
its support too (paper: "a translational offset that guarantees contact in the intended direction").
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from math import ceil, cos, fsum, sin

import numpy as np

from smash.execution.actions.arm_motions import ArmMotions, Segment
from smash.execution.actions.kind import AggregateMotion
from smash.execution.scene.area import Area
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.block_size import levels
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
"""Height of the fingertips above the cut, in heights of the lowest block that shall fall."""
PUSH_MARGIN = 0.003
"""Distance that the push keeps from all that shall not fall [m]."""
PUSH_SOLUTIONS = 6
LEAD = 0.08
"""Length of the straight descent to a push close to the table [m]."""
LANDING = {1: (0.23, 0.04), 2: (0.35, 0.05), 3: (0.52, 0.05), 4: (0.52, 0.10), 5: (0.68, 0.11)}
"""Measured: how far along the push and how far aside of it blocks come to rest [m], by the cubes that fall."""
HEAP = {1: 1.5, 5: 2.5}
"""How high they may lie, in edges of the longest, by the least number that fall: measured 1.0, and 2.1 off a rest."""
OVER_HEAP = 0.015
"""After a push the fingertips rise to this far above the highest heap [m]: the next motion passes over what fell."""


@dataclass(frozen=True, slots=True)
class Manner:
    """How a push is done.

    Attributes:
        speed: Of the tool [m/s].
        follow_through: How far the push goes on after the first contact, in sides of the widest block, or, above a
            rest, of the middle between it and the block that it leaves.
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


BOX_CUT = Manner(0.8, 2.0)
"""Boxes as high as up to 3 cubes fall from a rest: a slower push drags narrow ones below along."""

MOST_SWEPT = 9
"""More blocks than this are not swept off the table at once, ..."""
MOST_CUT = 4
"""... and no more than this off a standing rest: the upper ones would fall out of reach. They go in several pushes."""


def cubes_high(arm: ArmMotions, pile: Iterable[str], where: Geometry) -> list[float]:
    """How high each block of a pile is, bottom first, in cubes of those that pushes were measured with.

    Of a pile of boxes it is the height that decides how far they are thrown; the cubes of a scene count one each.
    """
    return [arm.height(block, where) / arm.tabletop.cube for block in pile]


def falling_cubes(tall: Sequence[float]) -> int:
    """How many cubes what falls counts as: a push is chosen, and a strip is as long, as for so many."""
    return max(1, round(sum(tall)))


def first_cut(height: int, tall: Sequence[float]) -> int:
    """The lowest level that the next push takes along, of a pile that shall be cut at `height`.

    Args:
        height: Of the cut, 1 is the bottom.
        tall: How high the pile's blocks are, bottom first, in cubes.
    """
    count, most = len(tall) - height + 1, MOST_SWEPT if height == 1 else MOST_CUT
    if falling_cubes(tall[height - 1 :]) <= most or count == 1:
        return height
    for pushes in range(ceil(falling_cubes(tall[height - 1 :]) / MOST_CUT), count + 1):
        cut = len(tall) - ceil(count / pushes) + 1
        if falling_cubes(tall[cut - 1 :]) <= MOST_CUT:
            return cut
    return len(tall)


def pushes_needed(height: int, tall: Sequence[float]) -> int:
    """How many pushes a pile takes that shall be cut at `height`, if each does what it should (as in `first_cut`)."""
    top, count = len(tall), 0
    while top >= height:
        top = first_cut(height, tall[:top]) - 1
        count += 1
    return count


def manner(height: int, falling: int, boxes: bool = False) -> Manner:
    """How to topple so many cubes, or boxes as high, from this height on; measured, see `smash topple-map`."""
    if height == 1:
        return SWEEP if falling < 5 else TALL_SWEEP if falling < 7 else TALLEST_SWEEP
    if falling > 3:
        return TALL_CUT
    return BOX_CUT if boxes else SHORT_CUT


@dataclass(frozen=True, slots=True)
class Strip:
    """Where toppled blocks may come to rest: from the slot's middle along the push, and to both sides [m]."""

    length: float
    half_width: float


def strip(falling: int) -> Strip:
    """The landing strip of a topple of so many cubes."""
    return Strip(*LANDING[min(falling, max(LANDING))])


def heap(falling: int) -> float:
    """How high so many toppled blocks may lie, in edges of the longest."""
    return HEAP[max(least for least in HEAP if least <= falling)]


def directions(slot: Slot, falling: int, others: Iterable[BlockPose], side: float) -> list[str]:
    """The slot's topple directions, those first whose landing strip holds the fewest other blocks.

    Args:
        slot: Where the pile stands.
        falling: How many cubes shall fall.
        others: Poses of all that stands or lies elsewhere.
        side: Longest edge of a block [m].
    """
    area = strip(falling)
    seen = [(float(pose.position[0]), float(pose.position[1])) for pose in others]

    def in_the_way(direction: str) -> int:
        places = [slot.coordinates(x, y, direction) for x, y in seen]
        return sum(
            -side < along < area.length + side and abs(aside) < area.half_width + side for along, aside in places
        )

    return sorted(slot.directions, key=in_the_way)


@dataclass(frozen=True, slots=True)
class Fall:
    """What one push makes fall.

    Attributes:
        blocks: The lowest first.
        cubes: How many cubes they count as.
        boxes: Whether the scene has boxes.
        level: Of the lowest one in the pile, 1 is the bottom.
        tip: Height of the fingertips as they push [m], ...
        above_cut: ... and above the foot of what falls [m].
        height: From the lowest block's foot to the top [m].
        lowest, widest, rest: Widths of the lowest block, of the widest one, and of the one that they leave [m].
        longest: Their longest edge [m].
    """

    blocks: tuple[str, ...]
    cubes: int
    boxes: bool
    level: int
    tip: float
    above_cut: float
    height: float
    lowest: float
    widest: float
    rest: float
    longest: float

    @property
    def manner(self) -> Manner:
        """How they are pushed."""
        return manner(self.level, self.cubes, self.boxes)

    @property
    def follow_through(self) -> float:
        """How far the push goes on after the first contact [m]: far enough for the lowest one, which it meets last."""
        unit = self.widest if self.level == 1 else (self.widest + self.rest) / 2
        return self.manner.follow_through * unit + (self.widest - self.lowest) / 2

    @property
    def heap(self) -> float:
        """How high they may lie afterwards [m]."""
        return heap(len(self.blocks)) * self.longest


def fall_of(arm: ArmMotions, pile: Sequence[str], cut: int, where: Geometry) -> Fall:
    """What a push at a level of a pile makes fall."""
    heights = [arm.height(block, where) for block in pile]
    widths = [_width(arm, block, where) for block in pile]
    lowest = heights[cut - 1]
    return Fall(
        blocks=tuple(pile[cut - 1 :]),
        cubes=falling_cubes(cubes_high(arm, pile[cut - 1 :], where)),
        boxes=not arm.tabletop.uniform,
        level=cut,
        tip=(levels(heights[: cut - 1], lowest) + ABOVE_CUT) * lowest,
        above_cut=ABOVE_CUT * lowest,
        height=fsum(heights[cut - 1 :]),
        lowest=widths[cut - 1],
        widest=max(widths[cut - 1 :]),
        rest=widths[cut - 2] if cut > 1 else 0.0,
        longest=max(arm.size(block).longest for block in pile[cut - 1 :]),
    )


def _width(arm: ArmMotions, block: str, where: Geometry) -> float:
    """The greater of a block's horizontal extents [m]."""
    size, pose = arm.size(block), where.blocks.get(block)
    return size.footprint if pose is None else max(size.extents(pose)[:2])


def topple(
    arm: ArmMotions,
    start: Vector,
    slot: Slot,
    pile: tuple[str, ...],
    height: int,
    where: Geometry,
    loose: frozenset[str] = frozenset(),
) -> list[Segment]:
    """From `start` [rad] to before the pile, through its upper part, back, and up.

    The push takes what lies above `height`, or the upper part of it where that is too much for one push (`first_cut`).

    Args:
        arm: Plans motions.
        start: Where the arm is [rad], shape (n,).
        slot: Where the pile stands.
        pile: Its blocks, bottom first.
        height: The lowest level that shall fall, 1 is the bottom.
        where: All that is known of where things are.
        loose: Blocks that lie on the table: where there is no other way, the push shoves them along.

    Raises:
        NoIk, NoMotion: where no direction allows it; the message is about the preferred one.
    """
    fall = fall_of(arm, pile, first_cut(height, cubes_high(arm, pile, where)), where)
    others = [pose for name, pose in where.blocks.items() if name not in pile] + list(where.carriers.values())
    scene = arm.around(where)
    preferred = directions(slot, fall.cubes, others, arm.tabletop.longest)
    problem: ExecutionFailure | None = None
    for shoved, direction in product(dict.fromkeys((frozenset[str](), loose)), preferred):
        try:
            return _push(arm, start, slot, direction, fall, scene, shoved)
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
        return topple(arm, start, slot, pile, action.height, where, loose)

    def areas(self, arm: ArmMotions, action: Topple, state: State, where: Geometry) -> tuple[Area, ...]:
        """Return the strips of all directions: which of them a push will take is settled when it is made."""
        slot = where.slots[action.location]
        fall = fall_of(arm, state.piles[action.location], action.height, where)
        room, fallen = strip(fall.cubes), frozenset(fall.blocks)
        return tuple(Area(slot, way, room.length, room.half_width, fall.heap, fallen) for way in slot.directions)

    def foresee(self, arm: ArmMotions, action: Topple, state: State, where: Geometry) -> None:
        """Forget the poses of what falls."""
        for block in kind_of(action).gathered(state, action):
            where.blocks.pop(block, None)

    def motions(self, arm: ArmMotions, action: Topple, state: State, where: Geometry) -> int:
        """Return the number of pushes."""
        return pushes_needed(action.height, cubes_high(arm, state.piles[action.location], where))

    def unfinished(self, action: Topple, state: State) -> bool:
        """Whether blocks still stand above the cut."""
        return bool(kind_of(action).gathered(state, action))

    def places(self, action: Topple) -> tuple[str, ...]:
        """Return the pile's location."""
        return (action.location,)


def _push(
    arm: ArmMotions, start: Vector, slot: Slot, direction: str, fall: Fall, scene: Scene, shoved: frozenset[str]
) -> list[Segment]:
    heading = slot.heading(direction)
    along = np.array([cos(heading), sin(heading), 0.0])
    reach = _first_contact(arm.robot.hand, fall)
    base = np.array([slot.x, slot.y, fall.tip + arm.robot.hand.tip])
    length = RUN_UP + fall.follow_through
    closed, fallen = HandState(0.0), shoved.union(fall.blocks)
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
                arm.move(push, closed, fallen, PUSH_MARGIN, Pace(tool_speed=fall.manner.speed)),
                arm.move(push.reversed(), closed, fallen, PUSH_MARGIN),
                *(_rise(arm, joints, fall, scene) or away),
            ]
    raise problem or NoIk(f"the hand cannot reach the start of a {direction} push at height {fall.level}")


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
        descent = arm.move(down, closed, margin=PUSH_MARGIN)
        return [*above, descent], [arm.back(descent)]


def _rise(arm: ArmMotions, joints: Vector, fall: Fall, scene: Scene) -> list[Segment]:
    """From before the pile upwards until the fingertips are above what may have fallen; nothing where they are.

    Nor where the arm cannot: it then stays where it was, and what is planned from there goes its own way.
    """
    missing = fall.heap + OVER_HEAP - fall.tip
    if missing <= 0.0:
        return []
    try:
        up = arm.planner.line(joints, (0.0, 0.0, missing), scene, hand=HandState(0.0), margin=PUSH_MARGIN)
    except ExecutionFailure:
        return []
    return [arm.move(up, HandState(0.0), margin=PUSH_MARGIN)]


def _first_contact(hand: Hand, fall: Fall) -> float:
    """Distance of the tool's axis from the pile's middle when hand or fingers first touch it [m].

    A single block passes below the palm and is met by the fingers; the palm is thicker and meets taller segments first.
    """
    palm_above_cut = fall.above_cut + hand.tip + hand.palm_depth
    return fall.widest / 2 + (hand.palm_thickness if fall.height > palm_above_cut else hand.finger_thickness)
