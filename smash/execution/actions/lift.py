"""Lift: the hand takes a pile by one of its blocks, from the side, and puts it on another with all that stands on it.

From above the palm would meet the block over the one that is grasped: the fingers are shorter than a block is high. So
the hand comes in level with the block, or from a little above where the table is near, the fingers at two of its sides.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import atan2, cos, pi, radians, sin

import numpy as np

from smash.execution.actions.arm_motions import (
    CLOSE_SECONDS,
    ENOUGH_CLEARANCE,
    OPEN_SECONDS,
    OPENINGS,
    RELEASE_HEIGHT,
    ArmMotions,
    Grip,
    Segment,
)
from smash.execution.actions.kind import AggregateMotion
from smash.execution.scene.block_pose import QUARTER, BlockPose, standing
from smash.execution.scene.geometry import Geometry
from smash.motion.collision import CONTACT_MARGIN, CollisionChecker
from smash.motion.errors import NoIk, NoMotion
from smash.motion.kinematics import descend, inverse
from smash.motion.level import Gentleness, level_way
from smash.motion.move import Move
from smash.motion.obstacles import Attached, BodyName, HandState, Scene
from smash.motion.poses import Matrix, ToolPose, Vector, yaw_rotation
from smash.problem.actions.lift import Lift
from smash.problem.actions.registry import kind_of
from smash.problem.errors import ExecutionFailure
from smash.problem.model import State

TILTS = (0.0, radians(20.0), radians(30.0))
"""How far the hand points below the horizontal [rad]."""
BACK = 0.012
"""The block is held this far in front of its middle, for room between the palm and the block above [m]."""
RUN_UP = 0.08
"""Length of the straight way to the block and off it [m]."""
SOLUTIONS = 2
FURTHEST_BESIDE = radians(100.0)
"""The pile may turn against the arm by this much on its way, not face about [rad]."""
MOST_GRASPS = 8
"""Grasps that are tried, those with most room first."""


@dataclass(frozen=True, eq=False)
class _Grasp:
    """One way to hold what is lifted.

    Attributes:
        joints: The arm as the hand closes [rad], shape (n,).
        goal: The tool as it opens.
        room: The hand's, at both [m].
        far: How far the arm goes to it and turns with it [rad].
    """

    joints: Vector
    goal: ToolPose
    room: float
    far: float


class LiftMotion(AggregateMotion[Lift]):
    """A grasp from the side, a level way, and back off; poses afterwards are known."""

    action = Lift
    level = True

    def plan(self, arm: ArmMotions, start: Vector, action: Lift, state: State, where: Geometry) -> list[Segment]:
        """Plan the way to the pile, the level way with its upper part, and the way off.

        Raises:
            NoIk, NoMotion: where there is none; the message is about the grasp with most room.
        """
        lifted = _lifted(action, state)
        scene = arm.around(where)
        target = _target(arm, action, state, where)
        problem: ExecutionFailure | None = None
        for grasp in _grasps(arm, start, lifted, where.blocks[lifted[0]], target, scene)[:MOST_GRASPS]:
            try:
                return _with_grasp(arm, start, grasp, lifted, scene)
            except ExecutionFailure as failure:
                problem = problem or failure
        assert problem is not None
        raise problem

    def foresee(self, arm: ArmMotions, action: Lift, state: State, where: Geometry) -> None:
        """Move the blocks to the other pile."""
        lowest = _target(arm, action, state, where)
        for level, block in enumerate(_lifted(action, state)):
            where.blocks[block] = BlockPose(lowest.position + np.array([0.0, 0.0, level * arm.side]), lowest.rotation)

    def places(self, action: Lift) -> tuple[str, ...]:
        """Return both locations."""
        return action.source, action.target

    def grasped(self, action: Lift, state: State) -> str:
        """Return the lowest of the lifted blocks."""
        return _lifted(action, state)[0]

    def anchor(self, action: Lift, state: State, where: Geometry) -> Vector | None:
        """The block that is grasped, where its pose is known."""
        pose = where.blocks.get(_lifted(action, state)[0])
        return None if pose is None else pose.position


def _lifted(action: Lift, state: State) -> list[str]:
    """What the law lifts, the lowest block first."""
    return list(reversed(kind_of(action).gathered(state, action)))


def _target(arm: ArmMotions, action: Lift, state: State, where: Geometry) -> BlockPose:
    """Where the lowest lifted block shall stand."""
    slot = where.slots[action.target]
    return standing(slot.x, slot.y, (len(state.piles[action.target]) + 0.5) * arm.side, slot.angle)


def _hand_rotation(azimuth: float, tilt: float, side: float) -> Matrix:
    """Tool axes of a hand that points along `azimuth` and `tilt` below the horizontal [rad]; `side` is 1 or -1."""
    z = np.array([cos(tilt) * cos(azimuth), cos(tilt) * sin(azimuth), -sin(tilt)])
    y = side * np.array([-sin(azimuth), cos(azimuth), 0.0])
    return np.stack([np.cross(y, z), y, z], axis=1)


def _grasps(
    arm: ArmMotions, start: Vector, lifted: list[str], pose: BlockPose, target: BlockPose, scene: Scene
) -> list[_Grasp]:
    """Ways to hold the lowest lifted block, those with most room at both ends first, then those near `start`.

    Raises:
        NoIk: where the arm reaches it from no side.
        NoMotion: where the hand has no room at one of the ends.
    """
    opened = HandState(arm.side / 2 + OPENINGS[0])
    here = CollisionChecker(arm.robot, scene.without(lifted[:1]), opened, 0.0)
    there = CollisionChecker(arm.robot, scene.without(lifted), opened, 0.0)
    found: list[_Grasp] = []
    reached = False
    for tool in _holds(pose):
        for joints in inverse(arm.robot, tool, start, count=SOLUTIONS):
            reached = True
            room = here.slack(joints)
            if room <= CONTACT_MARGIN:
                continue
            for goal, turn in _goals(tool, pose, target):
                end = descend(arm.robot, goal, joints + turn * arm.robot.first_joint)
                if end is not None and (room_there := there.slack(end)) > CONTACT_MARGIN:
                    far = float(np.abs(joints - start).max() + abs(end[0] - joints[0]))
                    found.append(_Grasp(joints, goal, min(room, room_there), far))
    if not reached:
        raise NoIk(f"the hand cannot reach block {lifted[0]!r} from the side")
    if not found:
        raise NoMotion(f"no room for the hand beside block {lifted[0]!r}, here or where it is put")
    return sorted(found, key=lambda grasp: (-min(grasp.room, ENOUGH_CLEARANCE), grasp.far))


def _holds(pose: BlockPose) -> Iterator[ToolPose]:
    """Tool poses that hold a block from its four sides."""
    for quarter in range(4):
        for tilt in TILTS:
            for side in (1.0, -1.0):
                rotation = _hand_rotation(pose.yaw + quarter * QUARTER, tilt, side)
                yield ToolPose(pose.position - BACK * rotation[:, 2], rotation)


def _goals(tool: ToolPose, block: BlockPose, target: BlockPose) -> Iterator[tuple[ToolPose, float]]:
    """Tool poses at the target that hold the block as `tool` does, each with the turn that leads there [rad]."""
    bearing, wanted = (atan2(float(pose.position[1]), float(pose.position[0])) for pose in (block, target))
    rise = np.array([0.0, 0.0, RELEASE_HEIGHT])
    for quarter in range(4):
        turn = target.yaw - block.yaw + quarter * QUARTER
        rotation = yaw_rotation(turn)
        beside = (turn - (wanted - bearing) + pi) % (2 * pi) - pi
        if abs(beside) < FURTHEST_BESIDE:
            offset = rotation @ (tool.position - block.position)
            yield ToolPose(target.position + rise + offset, rotation @ tool.rotation), wanted - bearing + beside


def _with_grasp(arm: ArmMotions, start: Vector, grasp: _Grasp, lifted: list[str], scene: Scene) -> list[Segment]:
    """The motions with one grasp.

    Raises:
        NoIk, NoMotion: where there are none.
    """
    moved: frozenset[BodyName] = frozenset(lifted)
    rest, opened = scene.without(moved), HandState(arm.side / 2 + OPENINGS[0])
    joints, goal = grasp.joints, grasp.goal
    tool = arm.robot.forward(joints)
    back = -RUN_UP * tool.rotation[:, 2]
    way_in = arm.planner.line(joints, back, scene.without(lifted[:1]), hand=opened).reversed()
    held = HandState(arm.side / 2, Attached.of_scene(scene.only_of(moved), tool))
    friction = arm.tabletop.friction.block
    way: list[Move] = level_way(
        arm.planner, joints, goal, rest, held, moved, Gentleness.of_friction(friction, friction)
    )
    there = way[-1].path.end
    way_off = arm.planner.line(there, -RUN_UP * goal.rotation[:, 2], rest, hand=opened)
    return [
        *arm.transfer(start, way_in.start, scene, opened),
        arm.move(way_in, opened, moved, CONTACT_MARGIN),
        Grip(0.0, CLOSE_SECONDS),
        *way,
        Grip(opened.opening, OPEN_SECONDS),
        arm.move(way_off, opened, moved, CONTACT_MARGIN),
    ]
