"""Nothing moves unseen: which blocks an action has moved that it is not about."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from smash.execution.actions.arm_motions import ArmMotions
from smash.execution.grounding import Task
from smash.execution.scene.block_pose import BlockPose
from smash.motion.move import Move
from smash.motion.poses import Vector
from smash.problem.actions.registry import kind_of
from smash.problem.model import Action, Aggregating, Pick, Place, State

DISTURBED = 0.02
"""A block that has moved further than this is named [m]."""


class Watch:
    """Compares where blocks are with where they were when something was last meant to move them, or seen to.

    So a block that creeps is named too, with the action in which it comes too far.

    Args:
        poses: Of all blocks at the start.
        least: A block that has moved further is named [m].
    """

    def __init__(self, poses: Mapping[str, BlockPose], least: float = DISTURBED) -> None:
        self._least = least
        self._places = {block: pose.position for block, pose in poses.items()}

    def disturbed(self, poses: Mapping[str, BlockPose], part: Collection[str]) -> dict[str, float]:
        """The blocks that were moved, and how far [m], but for those that the action is about.

        Args:
            poses: Of all blocks after an action.
            part: What the action is about.
        """
        away = {block: _distance(pose.position, self._places[block]) for block, pose in poses.items()}
        found = {block: far for block, far in away.items() if far > self._least and block not in part}
        self._places |= {block: poses[block].position for block in (*found, *part)}
        return found


def _distance(here: Vector, there: Vector) -> float:
    return float(np.linalg.norm(here - there))


def part_of(action: Action, state: State) -> Collection[str]:
    """The blocks that an action moves by the law, from the state before it."""
    match action:
        case Pick(block, _) | Place(block, _):
            return {block}
        case Aggregating():
            return kind_of(action).gathered(state, action)


def spoilt(later: Sequence[Task], block: str, pose: BlockPose, arm: ArmMotions) -> Task | None:
    """The first motion planned earlier that a block which now lies elsewhere spoils; None where there is none.

    It takes hold of the block where it was, or runs into it where it is.

    Args:
        later: What comes yet.
        block: Its name.
        pose: Where it is now.
        arm: Knows how large it is.
    """
    scene = arm.scene({block: pose})
    for task in later:
        if isinstance(task.action, Pick) and task.action.block == block:
            return task if task.segments else None
        moves = [segment for segment in task.segments or () if isinstance(segment, Move)]
        if not all(block in move.ignored or move.free(scene, max(move.margin, 0.0)) for move in moves):
            return task
    return None
