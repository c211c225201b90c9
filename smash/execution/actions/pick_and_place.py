"""How the arm carries out one pick or place, given where the blocks are: grasps, ways down and the motions to them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product

import numpy as np

from smash.execution.actions.arm_motions import (
    CLOSE_SECONDS,
    ENOUGH_CLEARANCE,
    OPEN_SECONDS,
    ArmMotions,
    Grip,
    Segment,
)
from smash.execution.actions.grasps import CENTRED, GRASPS, Grasp
from smash.execution.scene.block_pose import QUARTER, BlockPose
from smash.motion.collision import CONTACT_MARGIN, CollisionChecker
from smash.motion.errors import NoIk, NoMotion
from smash.motion.kinematics import inverse
from smash.motion.obstacles import BodyName, HandState, Scene
from smash.motion.paths import Path
from smash.motion.poses import Vector
from smash.problem.errors import ExecutionFailure

HOVERS = (0.10, 0.06, 0.03)
"""Lengths of the straight descent to a block [m], the long one first."""
SOLUTIONS = 3
ROOM = 0.002
"""Between the open hand and all else, where there is a grasp with so much [m]: a finger comes down on nothing."""
RESORTS = ((ROOM, True), (CONTACT_MARGIN, True), (CONTACT_MARGIN, False))
"""Room, and whether nothing that leans on the block is shaken off: a finger grazes a neighbour rather than that."""


@dataclass(frozen=True, eq=False)
class Approach:
    """The straight way down to a block or a place, and how much room the hand has there.

    Attributes:
        line: From above down to the contact.
        opening: Of the fingers when they are open there [m].
        clearance: Room between hand or fingers and everything else [m].
        grasp: Where the hand is on the block there.
    """

    line: Path
    opening: float
    clearance: float
    grasp: Grasp = CENTRED


class PickAndPlace:
    """Plans picks and places.

    Args:
        arm: Plans their motions.
    """

    def __init__(self, arm: ArmMotions) -> None:
        self._arm = arm

    def pick(self, start: Vector, block: str, pose: BlockPose, scene: Scene) -> tuple[list[Segment], Grasp]:
        """From `start` [rad] to above the block, down, close, and up again; and how the hand holds it then.

        The hand takes the block by its middle where it can, else a little beside it or leaning: a pile that stands
        near is then no hindrance.

        Raises:
            NoIk, NoMotion: where no grasp can be reached; the message is about the centred one with most room.
        """
        problem: ExecutionFailure | None = None
        for (room, alone), grasp in product(RESORTS, GRASPS):
            try:
                return self._pick(start, block, pose, scene, grasp, room, alone), grasp
            except ExecutionFailure as failure:
                problem = problem or failure
        assert problem is not None
        raise problem

    def _pick(
        self, start: Vector, block: str, pose: BlockPose, scene: Scene, grasp: Grasp, room: float, alone: bool
    ) -> list[Segment]:
        """With one grasp and so much room for the hand; `alone`: without shaking off what leans on the block.

        Raises:
            NoIk, NoMotion: where there is no motion for it.
        """
        near = scene.without([block])
        problem: ExecutionFailure | None = None
        for approach in self._approaches(start, pose.position, pose.yaw, near, grasp, room, alone):
            open_hand = HandState(approach.opening)
            try:
                transfer = self._arm.transfer(start, approach.line.start, scene, open_hand)
            except NoMotion as failure:
                problem = problem or failure
                continue
            touched: frozenset[BodyName] = frozenset([block])
            return [
                *transfer,
                self._arm.move(approach.line, open_hand, touched, CONTACT_MARGIN),
                Grip(0.0, CLOSE_SECONDS),
                self._arm.move(approach.line.reversed(), grasp.hand(self._arm.side), touched, CONTACT_MARGIN),
            ]
        raise problem or NoMotion(f"no room for the hand around block {block!r}")

    def landing(self, start: Vector, block: str, target: BlockPose, scene: Scene, grasp: Grasp = CENTRED) -> Approach:
        """The way down to where a block, which is in the hand, shall stand.

        Args:
            start: Where the arm is [rad], shape (n,).
            block: What is in the hand.
            target: Where it shall stand.
            scene: Everything.
            grasp: How the hand holds it.

        Raises:
            NoIk, NoMotion: where there is none.
        """
        point = target.position + np.array([0.0, 0.0, self._arm.release_height])
        near = scene.without([block])
        for room in (ROOM, CONTACT_MARGIN):
            for approach in self._approaches(start, point, target.yaw, near, grasp, room, True):
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
        hands = (approach.grasp.hand(self._arm.side), HandState(approach.opening))
        robot, margin = self._arm.robot, CONTACT_MARGIN - allowance
        return all(CollisionChecker(robot, near, hand, margin).path_free(waypoints) for hand in hands)

    def place(self, start: Vector, block: str, approach: Approach, scene: Scene) -> list[Segment]:
        """From `start` [rad] with the block to above the place, down, open, and up again.

        Raises:
            NoMotion: where the way there is blocked.
        """
        touched: frozenset[BodyName] = frozenset([block])
        holding = approach.grasp.hand(self._arm.side)
        return [
            *self._arm.transfer(start, approach.line.start, scene, holding, touched),
            self._arm.move(approach.line, holding, touched, CONTACT_MARGIN),
            Grip(approach.opening, OPEN_SECONDS),
            self._arm.move(approach.line.reversed(), HandState(approach.opening), touched, CONTACT_MARGIN),
        ]

    def _approaches(
        self,
        start: Vector,
        point: Vector,
        yaw: float,
        near: Scene,
        grasp: Grasp,
        room: float,
        loaded: bool,
    ) -> Iterable[Approach]:
        """Ways down to a block whose middle is at a point, those with most room first; then those near to `start`.

        Args:
            start: Where the arm is [rad], shape (n,).
            point: [m], shape (3,).
            yaw: Of a side of the block [rad].
            near: All else.
            grasp: Where the hand is on the block.
            room: The least between the open hand and all else [m].
            loaded: Whether the way must be free with the block in the hand too.

        Raises:
            NoIk: where the arm cannot reach the point from above.
        """
        poses = [grasp.tool(point, yaw + turn * QUARTER) for turn in range(4)]
        robot = self._arm.robot
        solutions = [joints for pose in poses for joints in inverse(robot, pose, start, count=SOLUTIONS)]
        if not solutions:
            raise NoIk(f"the hand cannot reach x {point[0]:.3f}, y {point[1]:.3f}, z {point[2]:.3f} m from above")
        ranked = []
        for opening in self._arm.openings:
            checker = CollisionChecker(robot, near, HandState(opening), 0.0)
            for joints in solutions:
                clearance = checker.slack(joints)
                if clearance > room:
                    far = float(np.abs(joints - start).max())
                    ranked.append((-min(clearance, ENOUGH_CLEARANCE), -opening, far, clearance, joints))
            if any(entry[0] <= -ENOUGH_CLEARANCE for entry in ranked):
                break
        ranked.sort(key=lambda entry: entry[:3])
        back = grasp.hand(self._arm.side) if loaded else None
        for height in HOVERS:
            for _, negative, _, clearance, joints in ranked:
                line = self._line_down(joints, height, near, HandState(-negative), back)
                if line is not None:
                    yield Approach(line, -negative, clearance, grasp)

    def _line_down(
        self, joints: Vector, height: float, near: Scene, empty: HandState, back: HandState | None
    ) -> Path | None:
        """The straight way down that the open hand can take, and `back`, with a block in it; or None."""
        try:
            return self._arm.planner.line(joints, (0.0, 0.0, height), near, hand=empty, back=back).reversed()
        except ExecutionFailure:
            return None
