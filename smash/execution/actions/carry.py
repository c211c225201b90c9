"""Carry: the hand takes a tray by its post and moves it to another station, level, with all that stands on it."""

from __future__ import annotations

from collections.abc import Iterable
from math import pi

import numpy as np

from smash.execution.actions.arm_motions import (
    CLOSE_SECONDS,
    OPEN_SECONDS,
    OPENINGS,
    RELEASE_HEIGHT,
    ArmMotions,
    Grip,
    Segment,
)
from smash.execution.actions.kind import AggregateMotion
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.tray import heading
from smash.motion.collision import CONTACT_MARGIN
from smash.motion.errors import NoIk, NoMotion
from smash.motion.kinematics import inverse
from smash.motion.level import Gentleness, level_way
from smash.motion.obstacles import Attached, BodyName, CarrierBody, HandState
from smash.motion.poses import ToolPose, Vector, top_down
from smash.problem.actions.carry import Carry
from smash.problem.actions.registry import kind_of
from smash.problem.errors import ExecutionFailure
from smash.problem.model import State

DESCENT = 0.08
"""Length of the straight way down to the post [m]."""
SOLUTIONS = 4


class CarryMotion(AggregateMotion[Carry]):
    """The post is grasped from above, the hand's thin side along the tray; poses afterwards are known."""

    action = Carry
    level = True

    def plan(self, arm: ArmMotions, start: Vector, action: Carry, state: State, where: Geometry) -> list[Segment]:
        """Plan the way to the tray, the level way with it, and the way off.

        Raises:
            NoIk, NoMotion: where there is none; the message is about the first grasp that can be reached.
        """
        from_pose, to_pose = where.carriers[action.carrier], self._target(arm, action, where)
        lift = np.array([0.0, 0.0, RELEASE_HEIGHT])
        aboard = kind_of(action).gathered(state, action)
        problem: ExecutionFailure | None = None
        reached = False
        for turn in (0.0, pi):
            grasp = top_down(arm.tray.grip(from_pose), heading(from_pose) + turn)
            goal = top_down(arm.tray.grip(to_pose) + lift, heading(to_pose) + turn)
            for joints in inverse(arm.robot, grasp, start, count=SOLUTIONS):
                reached = True
                try:
                    return self._with_grasp(arm, start, joints, goal, action.carrier, aboard, where)
                except ExecutionFailure as failure:
                    problem = problem or failure
        if not reached:
            raise NoIk(f"the hand cannot reach the post of carrier {action.carrier!r}")
        raise problem or NoMotion(f"no level way for carrier {action.carrier!r}")

    def foresee(self, arm: ArmMotions, action: Carry, state: State, where: Geometry) -> None:
        """Move the tray to its station and what stands on it along."""
        before, after = where.carriers[action.carrier], self._target(arm, action, where)
        where.carriers[action.carrier] = after
        turn = after.rotation @ before.rotation.T
        for block in kind_of(action).gathered(state, action):
            pose = where.blocks[block]
            moved = after.position + turn @ (pose.position - before.position)
            where.blocks[block] = BlockPose(moved, turn @ pose.rotation)

    def places(self, action: Carry) -> tuple[str, ...]:
        """Return the tray and the station."""
        return action.carrier, action.station

    def anchor(self, action: Carry, state: State, where: Geometry) -> Vector:
        """The tray's middle."""
        return where.carriers[action.carrier].position

    @staticmethod
    def _target(arm: ArmMotions, action: Carry, where: Geometry) -> BlockPose:
        return arm.tabletop.tray_at(where.stations[action.station])

    @staticmethod
    def _with_grasp(
        arm: ArmMotions,
        start: Vector,
        joints: Vector,
        goal: ToolPose,
        carrier: str,
        aboard: Iterable[str],
        where: Geometry,
    ) -> list[Segment]:
        """The motions with the hand closing at `joints` [rad].

        Raises:
            NoIk, NoMotion: where there are none.
        """
        tray = arm.tray
        moved: frozenset[BodyName] = frozenset([CarrierBody(carrier), *aboard])
        scene = arm.around(where)
        rest = scene.without(moved)
        opened = HandState(tray.post / 2 + OPENINGS[0])
        down = arm.planner.line(joints, (0.0, 0.0, DESCENT), scene, hand=opened).reversed()
        load = Attached.of_scene(scene.only_of(moved), arm.robot.forward(joints))
        closed = HandState(tray.post / 2, load)
        manner = Gentleness.of_friction(tray.friction, arm.tabletop.friction.block)
        way = level_way(arm.planner, joints, goal, rest, closed, moved, manner)
        there = way[-1].path.end
        off = arm.planner.line(there, (0.0, 0.0, DESCENT), rest, hand=opened)
        return [
            *arm.transfer(start, down.start, scene, opened),
            arm.move(down, opened, moved, CONTACT_MARGIN),
            Grip(0.0, CLOSE_SECONDS),
            *way,
            Grip(opened.opening, OPEN_SECONDS),
            arm.move(off, opened, moved, CONTACT_MARGIN),
        ]
