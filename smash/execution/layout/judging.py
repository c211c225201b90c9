"""Judges of a layout, none of which knows how it was found: the paper's conditions, pushes, the plan's own motions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from smash.execution.actions.arm_motions import ArmMotions
from smash.execution.actions.topple import topple
from smash.execution.grounding import Grounder
from smash.execution.layout.conditions import full_piles, violations
from smash.execution.scene.block_pose import BlockPose, standing
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.start import starting_poses
from smash.execution.scene.tabletop import DoesNotFit, Tabletop
from smash.problem.errors import ExecutionFailure
from smash.problem.model import Action
from smash.problem.rules import Law


def problems_of(tabletop: Tabletop) -> Iterator[str]:
    """Yield what is wrong with a layout whatever the plan: broken conditions, then pushes that cannot be made."""
    yield from map(str, violations(tabletop))
    arm = ArmMotions(tabletop)
    full = full_piles(tabletop)
    for index, slot in enumerate(tabletop.stacks):
        if not slot.directions:
            continue
        poses = _filled(tabletop, full)
        pile = tuple(name for name in poses if name.startswith(f"stacks[{index}] "))
        for height in sorted({1, len(pile) - (slot.falling or len(pile)) + 1}):
            try:
                topple(arm, arm.robot.ready, slot, pile, height, Geometry({}, blocks=poses))
            except ExecutionFailure as failure:
                yield f"stacks[{index}]: no push at height {height} among full piles: {failure}"


def problems_of_plan(tabletop: Tabletop, law: Law, actions: Sequence[Action]) -> Iterator[str]:
    """Yield the actions of a legal plan for which no motion is found before the episode, as the executor plans it.

    Before them, that the blocks which start in the table region have no room there.
    """
    slots = tabletop.bind(law.instance)
    try:
        poses = starting_poses(law.instance, slots, tabletop, np.random.default_rng(0))
    except DoesNotFit as problem:
        yield str(problem)
        return
    arm = ArmMotions(tabletop)
    tasks = Grounder(arm).ground(actions, law, Geometry(slots, blocks=poses), arm.robot.ready)
    for step, task in enumerate(tasks, start=1):
        if task.problem is not None:
            yield f"step {step} ({task.action}): {task.problem}"


def _filled(tabletop: Tabletop, full: dict[str, int]) -> dict[str, BlockPose]:
    """Full piles on all slots; a block is called after its slot and level."""
    side = tabletop.side
    return {
        f"{name} {level}": standing(slot.x, slot.y, (level - 0.5) * side, slot.angle)
        for (name, count), slot in zip(full.items(), tabletop.slots, strict=True)
        for level in range(1, count + 1)
    }
