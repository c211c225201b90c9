"""Where the blocks are when an episode begins: the instance's piles on their slots, with a little seeded disorder."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import hypot

import numpy as np

from smash.execution.scene.block_pose import BlockPose, standing
from smash.execution.scene.block_size import levels
from smash.execution.scene.region import REGION_APART, REGION_HALF_WIDTH, REGION_LENGTH
from smash.execution.scene.tabletop import DoesNotFit, Slot, Tabletop
from smash.problem.model import Instance

JITTER = 0.0005
"""Standard deviation of a block's place on what carries it [m]."""
TURN = 0.01
"""Standard deviation of its yaw [rad]."""
LARGEST = 2.0
"""Jitter is cut off at so many standard deviations."""


def starting_carriers(instance: Instance, stations: Mapping[str, Slot], tabletop: Tabletop) -> dict[str, BlockPose]:
    """Poses of the carriers: each stands exactly at its station."""
    return {carrier.name: tabletop.tray_at(stations[carrier.at]) for carrier in instance.carriers}


def starting_poses(
    instance: Instance,
    slots: Mapping[str, Slot],
    tabletop: Tabletop,
    generator: np.random.Generator,
    carriers: Mapping[str, BlockPose] | None = None,
) -> dict[str, BlockPose]:
    """Poses of all blocks, in the order of `instance.blocks`.

    Raises:
        DoesNotFit: where the table region is too small for the blocks that start in it.
    """
    poses: dict[str, BlockPose] = {}
    for location, slot in slots.items():
        heights: list[float] = []
        for block in instance.start.get(location, ()):
            height = tabletop.size(block).height
            dx, dy, turn = np.clip(generator.normal(size=3), -LARGEST, LARGEST) * (JITTER, JITTER, TURN)
            middle = (levels(heights, height) + 0.5) * height
            poses[block] = standing(slot.x + dx, slot.y + dy, middle, slot.angle + turn)
            heights.append(height)
    for carrier in instance.carriers:
        assert tabletop.tray is not None
        for cell, block in enumerate(carrier.holds):
            poses[block] = tabletop.tray.cell((carriers or {})[carrier.name], cell, tabletop.size(block).height)
    taken = [*poses.values(), *(carriers or {}).values()]
    for block in instance.table:
        poses[block] = _in_region(tabletop, block, slots, taken, generator)
        taken.append(poses[block])
    return {block: poses[block] for block in instance.blocks}


def _in_region(
    tabletop: Tabletop,
    block: str,
    slots: Mapping[str, Slot],
    poses: Iterable[BlockPose],
    generator: np.random.Generator,
) -> BlockPose:
    """A free place for a block in the landing strips of the scene's stacks, where it stands upright."""
    apart, middle = REGION_APART * tabletop.widest, tabletop.size(block).height / 2
    taken = [(float(pose.position[0]), float(pose.position[1])) for pose in poses]
    taken += [(slot.x, slot.y) for slot in slots.values()]
    strips = [slot for slot in tabletop.stacks if slot.directions]
    for _ in range(2000 if strips else 0):
        slot = strips[int(generator.integers(len(strips)))]
        along = float(generator.uniform(*REGION_LENGTH))
        aside = float(generator.uniform(-REGION_HALF_WIDTH, REGION_HALF_WIDTH))
        x, y = slot.point(along, aside, slot.directions[0])
        if all(hypot(x - other_x, y - other_y) > apart for other_x, other_y in taken):
            return standing(x, y, middle, float(generator.uniform(-np.pi, np.pi)))
    raise DoesNotFit(f"the table region of scene {tabletop.name!r} has no room for so many blocks")
