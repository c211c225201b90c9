"""How the arm carries out one pick or place, given where the blocks are: grasps, ways down and the motions to them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from smash.execution.actions.arm_motions import (
    CLOSE_SECONDS,
    ENOUGH_CLEARANCE,
    OPEN_SECONDS,
    RELEASE_HEIGHT,
    ArmMotions,
    Grip,
    Segment,
)
from smash.execution.scene.block_pose import QUARTER, BlockPose
from smash.motion.collision import CONTACT_MARGIN, CollisionChecker
from smash.motion.errors import NoIk, NoMotion
from smash.motion.kinematics import inverse
from smash.motion.obstacles import BodyName, HandState, Scene
from smash.motion.paths import Path
from smash.motion.poses import Vector, top_down
from smash.problem.errors import ExecutionFailure

HOVERS = (0.10, 0.06, 0.03)
"""Lengths of the straight descent to a block [m], the long one first."""
SOLUTIONS = 3


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


class PickAndPlace:
    """Plans picks and places.

    Args:
        arm: Plans their motions.
    """

    def __init__(self, arm: ArmMotions) -> None:
        self._arm = arm

    def pick(self, start: Vector, block: str, pose: BlockPose, scene: Scene) -> list[Segment]:
        """From `start` [rad] to above the block, down, close, and up again.

        Raises:
            NoIk, NoMotion: where no grasp can be reached; the message is about the one with most room.
        """
        yaws = [pose.yaw + turn * QUARTER for turn in range(4)]
        near = scene.without([block])
        approaches = self._approaches(start, pose.position, yaws, near, self._arm.openings, carrying=False)
        problem: ExecutionFailure | None = None
        for approach in approaches:
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
                self._arm.move(approach.line.reversed(), self._arm.holding, touched, CONTACT_MARGIN),
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
        for approach in self._approaches(start, point, yaws, near, self._arm.openings, carrying=True):
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
        hands = (self._arm.holding, HandState(approach.opening))
        return all(CollisionChecker(near, hand, CONTACT_MARGIN - allowance).path_free(waypoints) for hand in hands)

    def place(self, start: Vector, block: str, approach: Approach, scene: Scene) -> list[Segment]:
        """From `start` [rad] with the block to above the place, down, open, and up again.

        Raises:
            NoMotion: where the way there is blocked.
        """
        touched: frozenset[BodyName] = frozenset([block])
        return [
            *self._arm.transfer(start, approach.line.start, scene, self._arm.holding, touched),
            self._arm.move(approach.line, self._arm.holding, touched, CONTACT_MARGIN),
            Grip(approach.opening, OPEN_SECONDS),
            self._arm.move(approach.line.reversed(), HandState(approach.opening), touched, CONTACT_MARGIN),
        ]

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
            back = self._arm.holding if loaded else None
            return self._arm.planner.line(joints, (0.0, 0.0, height), near, hand=empty, back=back).reversed()
        except ExecutionFailure:
            return None
