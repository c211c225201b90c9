"""The arm at a table: free motions among blocks and trays, for whatever action asks for them.

Used twice by partial grounding: before the episode on the poses that are known, and during it on those that were
revealed. Nothing here knows the simulator.
"""

from __future__ import annotations

import importlib
from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from smash.execution.scene.area import Area
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.block_size import BESIDE, BlockSize, levels
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.tabletop import Tabletop
from smash.execution.scene.tray import Tray
from smash.motion.collision import CONTACT_MARGIN, DEFAULT_MARGIN, CollisionChecker
from smash.motion.errors import NoMotion
from smash.motion.move import Move
from smash.motion.obstacles import FIXTURE, BodyName, HandState, Scene
from smash.motion.paths import Path
from smash.motion.planner import MotionPlanner
from smash.motion.poses import Vector
from smash.motion.robots import load_robot
from smash.motion.timing import Pace, time_path
from smash.problem.errors import ExecutionFailure

OPENINGS = (0.010, BESIDE)
"""Room between a finger and the block before it is grasped [m], the wide one first."""
RELEASE_HEIGHT = 0.001
"""What the hand holds is let go this far above what carries it [m]."""
ENOUGH_CLEARANCE = 0.010
"""Grasps with this much clearance are equally good [m]."""
ESCAPES = (0.03, 0.06, 0.10, 0.15)
"""Heights that the hand is lifted by where it stands too close to something to begin a motion [m]."""
TIGHT_MARGINS = (0.005, 0.001)
"""Distances that a motion keeps where neither is possible [m]."""
CLOSE_SECONDS = 0.3
OPEN_SECONDS = 0.2
PAUSE = 0.05
"""Standing still between two motions, for the arm to catch up [s]."""


@dataclass(frozen=True, slots=True)
class Grip:
    """The fingers move to `opening` [m from the middle] for `seconds`, the arm stands still."""

    opening: float
    seconds: float


Segment = Move | Grip
"""A piece of an action: a motion of the arm, or one of the fingers."""


def duration(segments: Iterable[Segment]) -> float:
    """How long planned motions take when they are followed, in simulated time [s]."""
    return sum(
        segment.seconds if isinstance(segment, Grip) else segment.trajectory.duration + PAUSE for segment in segments
    )


class ArmMotions:
    """Plans the arm's motions in one scene.

    Args:
        tabletop: Sizes of blocks, trays, and the share of the arm's limits that motions use.
        seed: Of the motion planner.

    Attributes:
        robot: The scene's.
        planner: Plans paths.
    """

    def __init__(self, tabletop: Tabletop, seed: int = 0) -> None:
        self.tabletop = tabletop
        self.pace = Pace(tabletop.velocity, tabletop.acceleration)
        self.robot = load_robot(tabletop.robot)
        self.planner = MotionPlanner(self.robot, seed=seed)

    def warm_up(self) -> None:
        """Load and compile what motion planning uses, what names an obstacle too: no action's time is to be theirs."""
        bare = Scene.of_boxes([], np.empty((0, 3)), 0.0).with_table()
        ready = self.robot.ready
        turned = ready + 0.3 * self.robot.first_joint
        self.move(self.planner.plan(ready, turned, bare), HandState(0.0))
        self.move(self.planner.line(ready, (0.0, 0.0, 0.05), bare), HandState(0.0))
        in_the_way = Scene.of_boxes([FIXTURE], [self.robot.forward(turned).position], OPENINGS[0])
        with suppress(ExecutionFailure):
            self.planner.straight(ready, turned, bare.joined(in_the_way))
        importlib.import_module("smash.motion.rrtconnect")

    def scene(
        self,
        blocks: Mapping[str, BlockPose],
        carriers: Mapping[str, BlockPose] | None = None,
        areas: Iterable[Area] = (),
        unsure: Collection[str] = (),
    ) -> Scene:
        """Blocks, carriers and table as the motion planner sees them.

        Args:
            blocks: Poses of blocks.
            carriers: Poses of carriers.
            areas: Where blocks may be whose poses nobody knows: solid, as high as they may lie.
            unsure: Blocks of which nobody knows how they are turned: cubes that they fit into.
        """
        names = list(blocks)
        centres = np.array([blocks[name].position for name in names]).reshape(-1, 3)
        rotations = np.array([blocks[name].rotation for name in names]).reshape(-1, 3, 3)
        sizes = {name: self.size(name) for name in names}
        half = [np.full(3, size.longest / 2) if name in unsure else size.half for name, size in sizes.items()]
        scene = Scene.of_boxes(names, centres, np.array(half).reshape(-1, 3), rotations)
        for name, pose in (carriers or {}).items():
            scene = scene.joined(self.tray.scene(name, pose))
        for area in areas:
            scene = scene.joined(area.box())
        return scene.with_table()

    def around(self, where: Geometry) -> Scene:
        """All that is known of where things are, as the motion planner sees it."""
        return self.scene(where.blocks, where.carriers, where.areas, where.unsure)

    def size(self, block: str) -> BlockSize:
        """How large a block is."""
        return self.tabletop.size(block)

    def height(self, block: str, where: Geometry) -> float:
        """How high a block stands on the face that it lies on, or at most, where nobody knows that [m].

        A block of which nothing is known yet is taken to stand as it did at the start.
        """
        size, pose = self.size(block), where.blocks.get(block)
        if block in where.unsure:
            return size.longest
        return size.height if pose is None else size.upright(pose)

    def on_top(self, pile: Iterable[str], height: float, where: Geometry) -> float:
        """Height of the middle of a block that stands on a pile, itself `height` high [m]."""
        return (levels((self.height(block, where) for block in pile), height) + 0.5) * height

    @property
    def tray(self) -> Tray:
        """What carriers are in this scene."""
        assert self.tabletop.tray is not None, "a scene without a tray is bound to no instance with carriers"
        return self.tabletop.tray

    @property
    def rooms(self) -> tuple[float, ...]:
        """Room between each finger and a block before it is grasped [m], the widest first.

        Where blocks are not exactly where they are seen, that is as much as the hand has.
        """
        return (self.robot.hand.opening, *OPENINGS) if self.tabletop.noise.sees else OPENINGS

    def opening(self, width: float, room: float = OPENINGS[0]) -> float:
        """How far each finger is open around what is `width` wide, with so much room where there is [m]."""
        return min(self.robot.hand.opening, width / 2 + room)

    @property
    def release_height(self) -> float:
        """What the hand holds is let go this far above what carries it [m], whose height it does not know exactly."""
        return RELEASE_HEIGHT + 2 * self.tabletop.noise.size

    def transfer(
        self, start: Vector, goal: Vector, scene: Scene, hand: HandState, ignored: frozenset[BodyName] = frozenset()
    ) -> list[Move]:
        """A free motion between configurations [rad], shape (n,); closer to blocks where it must be.

        Raises:
            NoMotion: where there is none.
        """
        seen = scene.without(ignored)
        try:
            return [self.move(self.planner.plan(start, goal, seen, hand=hand), hand, ignored)]
        except NoMotion as failure:
            wide = CollisionChecker(self.robot, seen, hand, DEFAULT_MARGIN)
            close = [joints for joints in (start, goal) if not wide.free(joints)]
            if not close:
                raise
            for height in ESCAPES if close[0] is start else ():
                try:
                    up = self.planner.line(start, (0.0, 0.0, height), seen, hand=hand)
                    onward = self.planner.plan(up.end, goal, seen, hand=hand)
                except ExecutionFailure:
                    continue
                return [self.move(up, hand, ignored, CONTACT_MARGIN), self.move(onward, hand, ignored)]
            for margin in TIGHT_MARGINS:
                try:
                    path = self.planner.plan(start, goal, seen, hand=hand, margin=margin)
                except NoMotion:
                    continue
                return [self.move(path, hand, ignored, margin)]
            raise failure

    def move(
        self,
        path: Path,
        hand: HandState,
        ignored: frozenset[BodyName] = frozenset(),
        margin: float = DEFAULT_MARGIN,
        pace: Pace | None = None,
    ) -> Move:
        """A timed motion along `path`, at the usual pace where none is given."""
        return Move(self.robot, path, time_path(self.robot, path, pace or self.pace), hand, ignored, margin)

    def back(self, move: Move, hand: HandState | None = None) -> Move:
        """The same motion backwards, with another hand where one is given.

        Limits of speed and acceleration are the same both ways, so the way back is as fast.
        """
        return replace(move, path=move.path.reversed(), trajectory=move.trajectory.reversed(), hand=hand or move.hand)
