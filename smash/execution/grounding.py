"""Partial grounding: before the episode, everything is planned that does not depend on a pose nobody knows yet.

A topple leaves the poses of its blocks unknown (the empty entries of the paper's symbolic state). A later pick of such
a block becomes a *gap task*: it has no motion yet. The place that follows it is planned as far as it can be: the way
down to the target, and with it the terminal arm state that the rest of the plan starts from. At execution time the gap
is bridged: to the revealed pick, from there to the stored place, and back to the promised state.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from smash.execution.block_pose import BlockPose, standing
from smash.execution.errors import ExecutionFailure
from smash.execution.poses import Vector
from smash.execution.pushes import topple
from smash.execution.steps import Approach, Move, Segment, Steps
from smash.execution.stopwatch import Stopwatch
from smash.execution.tabletop import Slot
from smash.problem.errors import Unsupported
from smash.problem.model import Action, Pick, Place, State
from smash.problem.topple import Topple


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
    """

    action: Action
    segments: list[Segment] | None
    approach: Approach | None = None
    seconds: float = 0.0
    cpu_seconds: float = 0.0
    problem: ExecutionFailure | None = None

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
        slots: The slot of every location.
    """

    def __init__(self, steps: Steps, slots: Mapping[str, Slot]) -> None:
        self.steps = steps
        self.slots = slots

    def ground(
        self, actions: Sequence[Action], state: State, poses: Mapping[str, BlockPose], joints: Vector
    ) -> list[Task]:
        """Plan all that the poses known at the start determine.

        Args:
            actions: A plan that is legal from `state`.
            state: Where the blocks are, by the law.
            poses: Where they are on the table, all of them.
            joints: Where the arm is [rad], shape (7,).
        """
        piles, known, tasks = {name: list(pile) for name, pile in state.piles.items()}, dict(poses), []
        for action in actions:
            with Stopwatch() as watch:
                try:
                    task = self.task(action, piles, known, joints)
                except ExecutionFailure as failure:
                    task = Task(action, None, problem=failure)
            tasks.append(replace(task, seconds=watch.wall, cpu_seconds=watch.cpu))
            self._foresee(action, piles, known)
            joints = joints if task.end is None else task.end
        return tasks

    def task(
        self,
        action: Action,
        piles: Mapping[str, Sequence[str]],
        poses: Mapping[str, BlockPose],
        joints: Vector,
        approach: Approach | None = None,
    ) -> Task:
        """Plan one action as far as `poses` allow; `approach` is the way down that a place has promised.

        Raises:
            ExecutionFailure: where there is no motion for it.
        """
        match action:
            case Pick(block, _):
                if block not in poses:
                    return Task(action, None)
                return Task(action, self.steps.pick(joints, block, poses[block], self.steps.scene(poses)))
            case Place(block, target):
                scene = self.steps.scene(poses)
                way = approach or self.steps.landing(joints, block, self.slots[target], len(piles[target]) + 1, scene)
                if block not in poses:
                    return Task(action, None, way)
                return Task(action, self.steps.place(joints, block, way, scene), way)
            case Topple(location, height):
                pile = tuple(piles[location])
                return Task(action, topple(self.steps, joints, self.slots[location], pile, height, poses))
            case _:
                raise Unsupported(f"{action}: the arm has no motion for it")

    def _foresee(self, action: Action, piles: dict[str, list[str]], known: dict[str, BlockPose]) -> None:
        """Move piles and known poses on; a block in the hand keeps its entry: it is known to be held."""
        match action:
            case Pick(block, source):
                if source in piles:
                    piles[source].remove(block)
            case Place(block, target):
                slot = self.slots[target]
                level = len(piles[target]) + 0.5
                known[block] = standing(slot.x, slot.y, level * self.steps.side, slot.angle)
                piles[target].append(block)
            case Topple(location, height):
                for block in piles[location][height - 1 :]:
                    known.pop(block, None)
                del piles[location][height - 1 :]
