"""Carry: the hand takes a tray by its post and moves it to another station, level, with all that stands on it."""

from __future__ import annotations

from math import pi

import numpy as np

from smash.execution.actions.kind import AggregateMotion, Geometry
from smash.execution.actions.level import Gentleness, level_way
from smash.execution.actions.pick_and_place import (
    CLOSE_SECONDS,
    OPEN_SECONDS,
    OPENINGS,
    RELEASE_HEIGHT,
    Grip,
    Segment,
    Steps,
)
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.tray import heading
from smash.motion.collision import CONTACT_MARGIN
from smash.motion.errors import ExecutionFailure, NoIk, NoMotion
from smash.motion.kinematics import inverse
from smash.motion.obstacles import Attached, BodyName, CarrierBody, HandState
from smash.motion.poses import ToolPose, Vector, top_down
from smash.motion.robot import panda
from smash.problem.actions.carry import Carry
from smash.problem.model import State

DESCENT = 0.08
"""Length of the straight way down to the post [m]."""
SOLUTIONS = 4


class CarryMotion(AggregateMotion[Carry]):
    """The post is grasped from above, the hand's thin side along the tray; poses afterwards are known."""

    action = Carry

    def plan(self, steps: Steps, start: Vector, action: Carry, state: State, where: Geometry) -> list[Segment]:
        """Plan the way to the tray, the level way with it, and the way off.

        Raises:
            NoIk, NoMotion: where there is none; the message is about the first grasp that can be reached.
        """
        from_pose, to_pose = where.carriers[action.carrier], self._target(steps, action, where)
        lift = np.array([0.0, 0.0, RELEASE_HEIGHT])
        problem: ExecutionFailure | None = None
        reached = False
        for turn in (0.0, pi):
            grasp = top_down(steps.tray.grip(from_pose), heading(from_pose) + turn)
            goal = top_down(steps.tray.grip(to_pose) + lift, heading(to_pose) + turn)
            for joints in inverse(grasp, start, count=SOLUTIONS):
                reached = True
                try:
                    return self._with_grasp(steps, start, joints, goal, action.carrier, state, where)
                except ExecutionFailure as failure:
                    problem = problem or failure
        if not reached:
            raise NoIk(f"the hand cannot reach the post of carrier {action.carrier!r}")
        raise problem or NoMotion(f"no level way for carrier {action.carrier!r}")

    def foresee(self, steps: Steps, action: Carry, state: State, where: Geometry) -> None:
        """Move the tray to its station and what stands on it along."""
        before, after = where.carriers[action.carrier], self._target(steps, action, where)
        where.carriers[action.carrier] = after
        turn = after.rotation @ before.rotation.T
        for block in state.carried[action.carrier]:
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
    def _target(steps: Steps, action: Carry, where: Geometry) -> BlockPose:
        return steps.tabletop.tray_at(where.stations[action.station])

    @staticmethod
    def _with_grasp(
        steps: Steps, start: Vector, joints: Vector, goal: ToolPose, carrier: str, state: State, where: Geometry
    ) -> list[Segment]:
        """The motions with the hand closing at `joints` [rad].

        Raises:
            NoIk, NoMotion: where there are none.
        """
        tray, aboard = steps.tray, state.carried[carrier]
        moved: frozenset[BodyName] = frozenset([CarrierBody(carrier), *aboard])
        scene = steps.scene(where.blocks, where.carriers)
        rest = scene.without(moved)
        opened = HandState(tray.post / 2 + OPENINGS[0])
        down = steps.motion.line(joints, (0.0, 0.0, DESCENT), scene, hand=opened).reversed()
        load = Attached.of_scene(scene.only_of(moved), panda().forward(joints))
        closed = HandState(tray.post / 2, load)
        manner = Gentleness.of_friction(tray.friction, steps.tabletop.friction.block)
        way = level_way(steps, joints, goal, rest, closed, moved, manner)
        there = way[-1].path.end
        off = steps.motion.line(there, (0.0, 0.0, DESCENT), rest, hand=opened)
        return [
            *steps.transfer(start, down.start, scene, opened),
            steps.move(down, opened, moved, CONTACT_MARGIN),
            Grip(0.0, CLOSE_SECONDS),
            *way,
            Grip(opened.opening, OPEN_SECONDS),
            steps.move(off, opened, moved, CONTACT_MARGIN),
        ]
