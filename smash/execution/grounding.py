"""Partial grounding: before the episode, everything is planned that does not depend on a pose nobody knows yet.

A topple leaves the poses of its blocks unknown (the empty entries of the paper's symbolic state). A later pick of such
a block becomes a *gap task*: it has no motion yet. The place that follows it is planned as far as it can be: the way
down to the target, and with it the terminal arm state that the rest of the plan starts from. At execution time the gap
is bridged: to the revealed pick, from there to the stored place, and back to the promised state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from smash.execution.actions.arm_motions import ArmMotions, Segment
from smash.execution.actions.pick_and_place import Approach, PickAndPlace
from smash.execution.actions.registry import MOTIONS
from smash.execution.scene.block_pose import BlockPose, standing
from smash.execution.scene.geometry import Geometry
from smash.execution.stopwatch import Stopwatch
from smash.motion.errors import NoMotion
from smash.motion.move import Move
from smash.motion.obstacles import Scene
from smash.motion.poses import Vector
from smash.problem.errors import ExecutionFailure, Unsupported
from smash.problem.model import Action, Aggregating, Pick, Place, State
from smash.problem.rules import Law


@dataclass(frozen=True, eq=False)
class Task:
    """One action and what is planned of it.

    Attributes:
        action: The action.
        segments: Its motions, or None for a gap task.
        approach: Of a place: the way down to its target, whose upper end is the promised arm state.
        seconds: Wall time of its planning.
        cpu_seconds: The planning thread's time.
        problem: Why planning it failed, if it did; it is then tried again when its turn comes.
        anchor: Where it takes what is taken hold of to be [m], shape (3,); None where that is of no account.
    """

    action: Action
    segments: list[Segment] | None
    approach: Approach | None = None
    seconds: float = 0.0
    cpu_seconds: float = 0.0
    problem: ExecutionFailure | None = None
    anchor: Vector | None = None

    @property
    def end(self) -> Vector | None:
        """Where the arm will be afterwards [rad], shape (7,), as far as that is known."""
        if self.segments:
            last = [segment for segment in self.segments if isinstance(segment, Move)][-1]
            return last.path.end
        return None if self.approach is None else self.approach.line.start


class Grounder:
    """Plans tasks for a sequence of actions: what they do to the law's state is the law's to say, poses are its own.

    Args:
        arm: Plans the motions of one action.
    """

    def __init__(self, arm: ArmMotions) -> None:
        self.arm = arm
        self.pick_and_place = PickAndPlace(arm)

    def ground(self, actions: Sequence[Action], law: Law, where: Geometry, joints: Vector) -> list[Task]:
        """Plan all that the poses known at the start determine.

        Args:
            actions: A plan.
            law: Of the instance that the plan begins in.
            where: The poses of all its blocks and carriers.
            joints: Where the arm is [rad], shape (7,).

        Raises:
            IllegalAction: at the first action that the law refuses.
        """
        where, tasks = where.seen(where.blocks, where.carriers), []
        for state, action in zip(law.states(actions), actions, strict=False):
            with Stopwatch() as watch:
                try:
                    task = self.task(action, state, where, joints)
                except ExecutionFailure as failure:
                    task = Task(action, None, problem=failure)
            tasks.append(replace(task, seconds=watch.wall, cpu_seconds=watch.cpu))
            self._foresee(action, state, where)
            joints = joints if task.end is None else task.end
        return tasks

    def task(
        self, action: Action, state: State, where: Geometry, joints: Vector, approach: Approach | None = None
    ) -> Task:
        """Plan one action as far as the known poses allow; `approach` is the way down that a place has promised.

        Raises:
            ExecutionFailure: where there is no motion for it.
        """
        match action:
            case Pick(block, _):
                if block not in where.blocks:
                    return Task(action, None)
                pose, scene = where.blocks[block], self._scene(where)
                return Task(action, self.pick_and_place.pick(joints, block, pose, scene), anchor=pose.position)
            case Place(block, target):
                scene = self._scene(where)
                way = approach or self.pick_and_place.landing(joints, block, self.stand(target, state, where), scene)
                if block not in where.blocks:
                    return Task(action, None, way)
                return Task(action, self.pick_and_place.place(joints, block, way, scene), way)
            case Aggregating():
                motion = MOTIONS.get(type(action))
                if motion is None:
                    raise Unsupported(f"{action}: the arm has no motion for it")
                segments = motion.plan(self.arm, joints, action, state, where)
                return Task(action, segments, anchor=self.anchor(action, state, where))

    def anchor(self, action: Action, state: State, where: Geometry) -> Vector | None:
        """The position of what the hand takes hold of in an action [m], shape (3,), where that is known."""
        match action:
            case Pick(block, _):
                return where.blocks[block].position if block in where.blocks else None
            case Aggregating():
                return MOTIONS[type(action)].anchor(action, state, where)
        return None

    def stand(self, target: str, state: State, where: Geometry) -> BlockPose:
        """Where the next block stands that is placed on a location or a carrier.

        Raises:
            NoMotion: where a block lies across all cells of a carrier.
        """
        if target in where.carriers:
            tray, pose = self.arm.tray, where.carriers[target]
            free = tray.free_cells(pose, where.blocks)
            if not free:
                raise NoMotion(f"no cell of carrier {target!r} is free")
            return tray.cell(pose, free[0])
        slot = where.slots[target]
        return standing(slot.x, slot.y, (len(state.piles[target]) + 0.5) * self.arm.side, slot.angle)

    def _scene(self, where: Geometry) -> Scene:
        return self.arm.scene(where.blocks, where.carriers)

    def _foresee(self, action: Action, state: State, where: Geometry) -> None:
        """Move the known poses on from `state`; a block in the hand keeps its entry: it is known to be held."""
        match action:
            case Place(block, target):
                where.blocks[block] = self.stand(target, state, where)
            case Aggregating() if type(action) in MOTIONS:
                MOTIONS[type(action)].foresee(self.arm, action, state, where)
