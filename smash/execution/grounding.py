"""Partial grounding: before the episode, everything is planned that does not depend on a pose nobody knows yet.

A topple leaves the poses of its blocks unknown (the empty entries of the paper's symbolic state). A later pick of such
a block becomes a *gap task*: it has no motion yet. The place that follows it is planned as far as it can be: the way
down to the target, and with it the terminal arm state that the rest of the plan starts from. At execution time the gap
is bridged: to the revealed pick, from there to the stored place, and back to the promised state.

A block that is no cube may come to lie on any face, and piles are as high as their blocks lie: what is done with such a
block after its fall, or on a pile that holds one, is a gap task without a promise.
What happens in or beside a landing strip is a gap task too as long as blocks lie there: they may be in the hand's way.
So is a task that begins where such a one ends, which nobody knows yet. All other motions pass over the strips.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from smash.execution.actions.arm_motions import ArmMotions, Segment
from smash.execution.actions.grasps import CENTRED, Grasp
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
from smash.problem.model import TABLE, Action, Aggregating, Pick, Place, State
from smash.problem.rules import Law

HAND_ROOM = 0.08
"""What is this near to a landing strip, blocks in it may be in the hand's way there [m]."""


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
        grasp: Of a pick: how the hand holds the block afterwards.
    """

    action: Action
    segments: list[Segment] | None
    approach: Approach | None = None
    seconds: float = 0.0
    cpu_seconds: float = 0.0
    problem: ExecutionFailure | None = None
    anchor: Vector | None = None
    grasp: Grasp = CENTRED

    @property
    def end(self) -> Vector | None:
        """Where the arm will be afterwards [rad], shape (n,), as far as that is known."""
        if self.segments:
            last = [segment for segment in self.segments if isinstance(segment, Move)][-1]
            return last.path.end
        return None if self.approach is None else self.approach.line.start


class Grounder:
    """Plans tasks for a sequence of actions: what they do to the law's state is the law's to say, poses are its own.

    Args:
        arm: Plans the motions of one action.
        astray: How far beside its target the hand puts a block down, drawn for each way down: shape (2,) [m].
    """

    def __init__(self, arm: ArmMotions, astray: Callable[[], Vector] | None = None) -> None:
        self.arm = arm
        self._astray = astray
        self.pick_and_place = PickAndPlace(arm)

    def ground(self, actions: Sequence[Action], law: Law, where: Geometry, joints: Vector) -> list[Task]:
        """Plan all that the poses known at the start determine.

        Args:
            actions: A plan.
            law: Of the instance that the plan begins in.
            where: The poses of all its blocks and carriers.
            joints: Where the arm is [rad], shape (n,).

        Raises:
            IllegalAction: at the first action that the law refuses.
        """
        where, tasks = where.seen(where.blocks, where.carriers), []
        begins: Vector | None = joints
        last, grasp = joints, CENTRED
        for state, action in zip(law.states(actions), actions, strict=False):
            where.areas = tuple(area for area in where.areas if not area.blocks.isdisjoint(state.table))
            with Stopwatch() as watch:
                task = self._foreseen(action, state, where, begins, last, grasp)
            tasks.append(replace(task, seconds=watch.wall, cpu_seconds=watch.cpu))
            self._foresee(action, state, where)
            begins, grasp = task.end, task.grasp
            last = last if begins is None else begins
        return tasks

    def _foreseen(
        self, action: Action, state: State, where: Geometry, begins: Vector | None, last: Vector, grasp: Grasp
    ) -> Task:
        """What can be planned of an action before the episode.

        Args:
            action: The action.
            state: The law's state before it.
            where: The poses that are known then, and where there may be more blocks.
            begins: Where the arm is then [rad], shape (n,), where that is known.
            last: Where it was last when that was known [rad], shape (n,).
            grasp: How it holds the block in the hand.
        """
        if self._among_landed(action, where) or self._height_unknown(action, state, where):
            return Task(action, None)
        try:
            if begins is not None:
                return self.task(action, state, where, begins, grasp=grasp)
            return self._promise(action, state, where, last, grasp)
        except ExecutionFailure as failure:
            return Task(action, None, problem=failure)

    def _promise(self, action: Action, state: State, where: Geometry, last: Vector, grasp: Grasp) -> Task:
        """Of an action that begins nobody knows where: of a place the way down, of others nothing."""
        if not isinstance(action, Place):
            return Task(action, None)
        return Task(action, None, self._landing(action, state, where, self.arm.around(where), last, grasp))

    def _landing(
        self, action: Place, state: State, where: Geometry, scene: Scene, last: Vector, grasp: Grasp
    ) -> Approach:
        """The way down to a place, which may lead beside it without the executor's knowing.

        Args:
            action: The action.
            state: The law's state before it.
            where: The poses that are known then.
            scene: The same as obstacles.
            last: Where the arm is, or was last when that was known [rad], shape (n,).
            grasp: How it holds the block.

        Raises:
            NoIk, NoMotion: where there is none.
        """
        stand = self.stand(action.block, action.target, state, where)
        if self._astray is not None:
            stand = BlockPose(stand.position + np.append(self._astray(), 0.0), stand.rotation)
        return self.pick_and_place.landing(last, action.block, stand, scene, grasp)

    def _height_unknown(self, action: Action, state: State, where: Geometry) -> bool:
        """Whether it is about a block of which nobody knows on which face it lies, or what stands on such a one."""
        match action:
            case Pick(_, place):
                places: tuple[str, ...] = () if place == TABLE else (place,)
            case Place(block, place):
                places = (place,)
                if block not in where.blocks and not self.arm.size(block).is_cube:
                    return True
            case Aggregating() if type(action) in MOTIONS:
                places = MOTIONS[type(action)].places(action)
            case _:
                places = ()
        piles = {block for place in places for block in state.piles.get(place, ())}
        touched = {action.block} if isinstance(action, Pick | Place) else set()
        return not where.unsure.isdisjoint(piles | touched)

    @staticmethod
    def _among_landed(action: Action, where: Geometry) -> bool:
        """Whether it happens in or beside an area where toppled blocks may be."""
        match action:
            case Pick(_, place) | Place(_, place):
                places: tuple[str, ...] = () if place == TABLE else (place,)
            case Aggregating() if type(action) in MOTIONS:
                places = MOTIONS[type(action)].places(action)
            case _:
                places = ()
        points = [where.point(place) for place in places]
        return any(area.near(x, y, HAND_ROOM) for area in where.areas for x, y in points)

    def task(
        self,
        action: Action,
        state: State,
        where: Geometry,
        joints: Vector,
        approach: Approach | None = None,
        grasp: Grasp = CENTRED,
    ) -> Task:
        """Plan one action as far as the known poses allow.

        Args:
            action: The action.
            state: The law's state before it.
            where: The poses that are known.
            joints: Where the arm is [rad], shape (n,).
            approach: The way down that a place has promised.
            grasp: How the hand holds the block that is placed.

        Raises:
            ExecutionFailure: where there is no motion for it.
        """
        match action:
            case Pick(block, _):
                if block not in where.blocks:
                    return Task(action, None)
                pose, scene = where.blocks[block], self.arm.around(where)
                segments, grasp = self.pick_and_place.pick(joints, block, pose, scene)
                return Task(action, segments, anchor=pose.position, grasp=grasp)
            case Place(block, _):
                scene = self.arm.around(where)
                way = approach or self._landing(action, state, where, scene, joints, grasp)
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

    def stand(self, block: str, target: str, state: State, where: Geometry) -> BlockPose:
        """Where a block stands, on the face that it lies on now, when it is placed on a location or a carrier.

        Raises:
            NoMotion: where a block lies across all cells of a carrier.
        """
        height = self.arm.height(block, where)
        if target in where.carriers:
            tray, pose = self.arm.tray, where.carriers[target]
            free = tray.free_cells(pose, where.blocks, {name: self.arm.height(name, where) for name in where.blocks})
            if not free:
                raise NoMotion(f"no cell of carrier {target!r} is free")
            return tray.cell(pose, free[0], height)
        slot = where.slots[target]
        return standing(slot.x, slot.y, self.arm.on_top(state.piles[target], height, where), slot.angle)

    def _foresee(self, action: Action, state: State, where: Geometry) -> None:
        """Move the known poses on from `state`; a block in the hand keeps its entry: it is known to be held."""
        match action:
            case Place(block, target):
                size, lay = self.arm.size(block), where.blocks.get(block)
                if not size.is_cube and (lay is None or not size.stands(lay)):
                    where.unsure.add(block)
                where.blocks[block] = self.stand(block, target, state, where)
            case Aggregating() if type(action) in MOTIONS:
                motion = MOTIONS[type(action)]
                where.areas += motion.areas(self.arm, action, state, where)
                motion.foresee(self.arm, action, state, where)
