"""From settled poses back to the law's state: which blocks stand on which location, which lie in the table region."""

from __future__ import annotations

from collections.abc import Mapping

from smash.execution.block_pose import BlockPose
from smash.execution.tabletop import Slot
from smash.problem.model import State

PLACED_WITHIN = 1 / 3
"""A block stands at a location if its centre is within this share of its side of the slot's middle, ..."""
LEVEL_WITHIN = 0.2
"""... within this share of its level's height, ..."""
LARGEST_TILT = 0.1
"""... and leans no further than this [rad]."""


def read_state(
    poses: Mapping[str, BlockPose], slots: Mapping[str, Slot], side: float, hand: str | None = None
) -> State:
    """The law's state in the observed scene.

    A location holds the unbroken column of upright blocks over its middle; everything else lies in the table region.

    Args:
        poses: Settled poses of all blocks.
        slots: The slot of every location.
        side: Side of a block [m].
        hand: The block between the fingers, which stands nowhere.
    """
    loose = {name: pose for name, pose in poses.items() if name != hand}
    piles: dict[str, list[str]] = {}
    for location, slot in slots.items():
        column = sorted(
            (float(pose.position[2]), name) for name, pose in loose.items() if _over(pose, slot, PLACED_WITHIN * side)
        )
        pile: list[str] = []
        for height, name in column:
            if abs(height / side - (len(pile) + 0.5)) > LEVEL_WITHIN:
                break
            pile.append(name)
        for name in pile:
            del loose[name]
        piles[location] = pile
    return State(piles, set(loose), hand)


def _over(pose: BlockPose, slot: Slot, tolerance: float) -> bool:
    return pose.tilt < LARGEST_TILT and pose.distance(slot.x, slot.y) < tolerance
