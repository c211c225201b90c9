"""Partial grounding: before the episode, everything is planned that does not depend on a pose nobody knows yet.

A topple leaves the poses of its blocks unknown (the empty entries of the paper's symbolic state). A later pick of such
a block becomes a *gap task*: it has no motion yet. The place that follows it is planned as far as it can be: the way
down to the target, and with it the terminal arm state that the rest of the plan starts from. At execution time the gap
is bridged: to the revealed pick, from there to the stored place, and back to the promised state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from smash.execution.actions.kind import Geometry
from smash.execution.actions.pick_and_place import Approach, Move, Segment, Steps
from smash.execution.actions.registry import MOTIONS
from smash.execution.scene.block_pose import BlockPose, standing
from smash.execution.stopwatch import Stopwatch
from smash.motion.errors import ExecutionFailure, NoMotion
from smash.motion.obstacles import Scene
from smash.motion.poses import Vector
from smash.problem.actions.registry import kind_of
from smash.problem.errors import Unsupported
from smash.problem.model import Action, Aggregating, Pick, Place, State


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
    """Plans tasks for a sequence of actions from a given geometric state.

    Args:
        steps: Plans the motions of one action.
    """

    def __init__(self, steps: Steps) -> None:
        self.steps = steps

    def ground(self, actions: Sequence[Action], state: State, where: Geometry, joints: Vector) -> list[Task]:
        """Plan all that the poses known at the start determine.

        Args:
            actions: A plan that is legal from `state`.
            state: Where the blocks are, by the law.
            where: The poses of all of them, and of the carriers.
            joints: Where the arm is [rad], shape (7,).
        """
        state, where, tasks = state.copy(), where.seen(where.blocks, where.carriers), []
        for action in actions:
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
                return Task(action, self.steps.pick(joints, block, pose, scene), anchor=pose.position)
            case Place(block, target):
                scene = self._scene(where)
                way = approach or self.steps.landing(joints, block, self.stand(target, state, where), scene)
                if block not in where.blocks:
                    return Task(action, None, way)
                return Task(action, self.steps.place(joints, block, way, scene), way)
            case Aggregating():
                motion = MOTIONS.get(type(action))
                if motion is None:
                    raise Unsupported(f"{action}: the arm has no motion for it")
                segments = motion.plan(self.steps, joints, action, state, where)
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
            tray, pose = self.steps.tray, where.carriers[target]
            free = tray.free_cells(pose, where.blocks)
            if not free:
                raise NoMotion(f"no cell of carrier {target!r} is free")
            return tray.cell(pose, free[0])
        slot = where.slots[target]
        return standing(slot.x, slot.y, (len(state.piles[target]) + 0.5) * self.steps.side, slot.angle)

    def _scene(self, where: Geometry) -> Scene:
        return self.steps.scene(where.blocks, where.carriers)

    def _foresee(self, action: Action, state: State, where: Geometry) -> None:
        """Move state and known poses on; a block in the hand keeps its entry: it is known to be held."""
        match action:
            case Pick(block, source):
                if source in state.piles:
                    state.piles[source].remove(block)
                else:
                    state.carried.get(source, state.table).discard(block)
            case Place(block, target):
                where.blocks[block] = self.stand(target, state, where)
                if target in state.piles:
                    state.piles[target].append(block)
                else:
                    state.carried[target].add(block)
            case Aggregating():
                if type(action) in MOTIONS:
                    MOTIONS[type(action)].foresee(self.steps, action, state, where)
                kind_of(action).apply(state, action)
