"""How the arm carries out one pick or place, given where the blocks are: grasps and the motions to them.

Used twice by partial grounding: before the episode on the poses that are known, and during it on those that were
revealed. Nothing here knows the simulator.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from smash.execution.scene.block_pose import QUARTER, BlockPose
from smash.execution.scene.tabletop import Tabletop
from smash.execution.scene.tray import Tray
from smash.motion.collision import CONTACT_MARGIN, DEFAULT_MARGIN, CollisionChecker
from smash.motion.errors import ExecutionFailure, NoIk, NoMotion
from smash.motion.kinematics import inverse
from smash.motion.motions import MotionPlanner
from smash.motion.obstacles import Attached, BodyName, HandState, Scene
from smash.motion.paths import Path
from smash.motion.poses import Vector, top_down
from smash.motion.robot import MAX_OPENING, READY
from smash.motion.timing import Pace, Trajectory, time_path

OPENINGS = (0.010, 0.005)
"""Room between a finger and the block before it is grasped [m], the wide one first."""
HOVERS = (0.10, 0.06, 0.03)
"""Lengths of the straight descent to a block [m], the long one first."""
ENOUGH_CLEARANCE = 0.010
"""Grasps with this much clearance are equally good [m]."""
RELEASE_HEIGHT = 0.001
"""A block is let go this far above what carries it [m]."""
ESCAPES = (0.03, 0.06, 0.10, 0.15)
"""Heights that the hand is lifted by where it stands too close to something to begin a motion [m]."""
TIGHT_MARGINS = (0.005, 0.001)
"""Distances that a motion keeps where neither is possible [m]."""
SOLUTIONS = 3
CLOSE_SECONDS = 0.3
OPEN_SECONDS = 0.2


@dataclass(frozen=True, eq=False)
class Move:
    """One motion of the arm.

    Attributes:
        path: Where.
        trajectory: When.
        hand: Fingers and what they hold meanwhile.
        ignored: Blocks and carriers that it may touch.
        margin: Distance that it was planned to keep [m].
    """

    path: Path
    trajectory: Trajectory
    hand: HandState
    ignored: frozenset[BodyName]
    margin: float

    @property
    def opening(self) -> float:
        """What the fingers are sent to [m]: shut where they hold a block."""
        return 0.0 if self.hand.attached is not None else self.hand.opening

    def free(self, scene: Scene, allowance: float) -> bool:
        """Whether the motion keeps its margin, less `allowance` [m], in another scene."""
        checker = CollisionChecker(scene.without(self.ignored), self.hand, self.margin - allowance)
        return checker.path_free(self.path.waypoints)


@dataclass(frozen=True, slots=True)
class Grip:
    """The fingers move to `opening` [m from the middle] for `seconds`, the arm stands still."""

    opening: float
    seconds: float


Segment = Move | Grip


@dataclass(frozen=True, eq=False)
class Approach:
    """The straight way down to a block or a place, and how much room the hand has there.

    Attributes:
        line: From above down to the contact.
        opening: Of the fingers when they are open there [m].
        clearance: Room between hand or fingers and everything else [m].
    """

    line: Path
    opening: float
    clearance: float


class Steps:
    """Plans the motions of single actions.

    Args:
        tabletop: Blocks, trays, and the share of the arm's limits that motions use.
        seed: Of the motion planner.
    """

    def __init__(self, tabletop: Tabletop, seed: int = 0) -> None:
        self.tabletop = tabletop
        self.side = tabletop.side
        self.pace = Pace(tabletop.velocity, tabletop.acceleration)
        self.motion = MotionPlanner(seed=seed)
        self.holding = HandState(self.side / 2, Attached.cube(self.side))

    def warm_up(self) -> None:
        """Load and compile what motion planning uses, so that the first action's time is not theirs."""
        bare = Scene.of_boxes([], np.empty((0, 3)), 0.0).with_table()
        turned = READY + np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        self.move(self.motion.plan(READY, turned, bare), HandState(0.0))
        self.move(self.motion.line(READY, (0.0, 0.0, 0.05), bare), HandState(0.0))
        importlib.import_module("smash.motion.rrtconnect")

    def scene(self, blocks: Mapping[str, BlockPose], carriers: Mapping[str, BlockPose] | None = None) -> Scene:
        """Blocks, carriers and table as the motion planner sees them."""
        names = list(blocks)
        centres = np.array([blocks[name].position for name in names]).reshape(-1, 3)
        rotations = np.array([blocks[name].rotation for name in names]).reshape(-1, 3, 3)
        scene = Scene.of_boxes(names, centres, self.side / 2, rotations)
        for name, pose in (carriers or {}).items():
            scene = scene.joined(self.tray.scene(name, pose))
        return scene.with_table()

    @property
    def tray(self) -> Tray:
        """What carriers are in this scene."""
        assert self.tabletop.tray is not None, "a scene without a tray is bound to no instance with carriers"
        return self.tabletop.tray

    def pick(self, start: Vector, block: str, pose: BlockPose, scene: Scene) -> list[Segment]:
        """From `start` [rad] to above the block, down, close, and up again.

        Raises:
            NoIk, NoMotion: where no grasp can be reached; the message is about the one with most room.
        """
        yaws = [pose.yaw + turn * QUARTER for turn in range(4)]
        near = scene.without([block])
        approaches = self._approaches(start, pose.position, yaws, near, self._openings(), carrying=False)
        problem: ExecutionFailure | None = None
        for approach in approaches:
            open_hand = HandState(approach.opening)
            try:
                transfer = self.transfer(start, approach.line.start, scene, open_hand)
            except NoMotion as failure:
                problem = problem or failure
                continue
            touched: frozenset[BodyName] = frozenset([block])
            return [
                *transfer,
                self.move(approach.line, open_hand, touched, CONTACT_MARGIN),
                Grip(0.0, CLOSE_SECONDS),
                self.move(approach.line.reversed(), self.holding, touched, CONTACT_MARGIN),
            ]
        raise problem or NoMotion(f"no room for the hand around block {block!r}")

    def landing(self, start: Vector, block: str, target: BlockPose, scene: Scene) -> Approach:
        """The way down to where `block`, which is in the hand, shall stand.

        Raises:
            NoIk, NoMotion: where there is none.
        """
        point = target.position + np.array([0.0, 0.0, RELEASE_HEIGHT])
        yaws = [target.yaw + turn * QUARTER for turn in range(4)]
        near = scene.without([block])
        for approach in self._approaches(start, point, yaws, near, self._openings(), carrying=True):
            return approach
        x, y, z = (float(value) for value in target.position)
        raise NoMotion(f"no room for the hand to put a block down at x {x:.2f}, y {y:.2f}, z {z:.2f} m")

    def still_free(self, approach: Approach, block: str, scene: Scene, allowance: float = 0.0) -> bool:
        """Whether a way down that was planned earlier is free in another scene, with the block and without it.

        Args:
            approach: The way.
            block: What is put down.
            scene: Where everything is now.
            allowance: How much closer than planned it may come [m].
        """
        near, waypoints = scene.without([block]), approach.line.waypoints
        hands = (self.holding, HandState(approach.opening))
        return all(CollisionChecker(near, hand, CONTACT_MARGIN - allowance).path_free(waypoints) for hand in hands)

    def place(self, start: Vector, block: str, approach: Approach, scene: Scene) -> list[Segment]:
        """From `start` [rad] with the block to above the place, down, open, and up again.

        Raises:
            NoMotion: where the way there is blocked.
        """
        touched: frozenset[BodyName] = frozenset([block])
        return [
            *self.transfer(start, approach.line.start, scene, self.holding, touched),
            self.move(approach.line, self.holding, touched, CONTACT_MARGIN),
            Grip(approach.opening, OPEN_SECONDS),
            self.move(approach.line.reversed(), HandState(approach.opening), touched, CONTACT_MARGIN),
        ]

    def transfer(
        self, start: Vector, goal: Vector, scene: Scene, hand: HandState, ignored: frozenset[BodyName] = frozenset()
    ) -> list[Move]:
        """A free motion between configurations [rad], shape (7,); closer to blocks where it must be.

        Raises:
            NoMotion: where there is none.
        """
        seen = scene.without(ignored)
        try:
            return [self.move(self.motion.plan(start, goal, seen, hand=hand), hand, ignored)]
        except NoMotion as failure:
            wide = CollisionChecker(seen, hand, DEFAULT_MARGIN)
            close = [joints for joints in (start, goal) if not wide.free(joints)]
            if not close:
                raise
            for height in ESCAPES if close[0] is start else ():
                try:
                    up = self.motion.line(start, (0.0, 0.0, height), seen, hand=hand)
                    onward = self.motion.plan(up.end, goal, seen, hand=hand)
                except ExecutionFailure:
                    continue
                return [self.move(up, hand, ignored, CONTACT_MARGIN), self.move(onward, hand, ignored)]
            for margin in TIGHT_MARGINS:
                try:
                    path = self.motion.plan(start, goal, seen, hand=hand, margin=margin)
                except NoMotion:
                    continue
                return [self.move(path, hand, ignored, margin)]
            raise failure

    def _openings(self) -> list[float]:
        return [min(MAX_OPENING, self.side / 2 + room) for room in OPENINGS]

    def _approaches(
        self,
        start: Vector,
        point: Vector,
        yaws: Sequence[float],
        near: Scene,
        openings: Iterable[float],
        carrying: bool,
    ) -> Iterable[Approach]:
        """Ways down to a point, those with most room first; equal ones by how near they are to `start`.

        Raises:
            NoIk: where the arm cannot reach the point from above.
        """
        poses = [top_down(point, yaw) for yaw in yaws]
        solutions = [joints for pose in poses for joints in inverse(pose, start, count=SOLUTIONS)]
        if not solutions:
            raise NoIk(f"the hand cannot reach x {point[0]:.3f}, y {point[1]:.3f}, z {point[2]:.3f} m from above")
        ranked = []
        for opening in openings:
            checker = CollisionChecker(near, HandState(opening), 0.0)
            for joints in solutions:
                clearance = checker.slack(joints)
                if clearance > CONTACT_MARGIN:
                    far = float(np.abs(joints - start).max())
                    ranked.append((-min(clearance, ENOUGH_CLEARANCE), -opening, far, clearance, joints))
            if any(entry[0] <= -ENOUGH_CLEARANCE for entry in ranked):
                break
        ranked.sort(key=lambda entry: entry[:3])
        # A block that leans on the one to be picked is shaken off in the last resort alone.
        for loaded in (True,) if carrying else (True, False):
            for height in HOVERS:
                for _, negative, _, clearance, joints in ranked:
                    line = self._line_down(joints, height, near, HandState(-negative), loaded)
                    if line is not None:
                        yield Approach(line, -negative, clearance)

    def _line_down(self, joints: Vector, height: float, near: Scene, empty: HandState, loaded: bool) -> Path | None:
        """The straight way down that the open hand can take, and with a block too where it is `loaded`; or None."""
        try:
            back = self.holding if loaded else None
            return self.motion.line(joints, (0.0, 0.0, height), near, hand=empty, back=back).reversed()
        except ExecutionFailure:
            return None

    def move(
        self,
        path: Path,
        hand: HandState,
        ignored: frozenset[BodyName] = frozenset(),
        margin: float = DEFAULT_MARGIN,
        pace: Pace | None = None,
    ) -> Move:
        """A timed motion along `path`, at the usual pace where none is given."""
        return Move(path, time_path(path, pace or self.pace), hand, ignored, margin)
