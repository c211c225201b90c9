"""From settled poses back to the law's state: which blocks stand on which location, which lie in the table region."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi

from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.block_size import BlockSize, levels
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.tabletop import Noise, Slot, Tabletop
from smash.execution.scene.tray import heading
from smash.problem.model import State

PLACED_WITHIN = 1 / 3
"""A block stands at a location if its centre is within this share of its width of the slot's middle, ..."""
MOST_WITHIN = 1 / 2
"""... (this one at most, where it is not seen exactly)"""
LEVEL_WITHIN = 0.2
"""... within this share of its height of where that would be on the blocks below, ..."""
LARGEST_TILT = 0.1
"""... and leans no further than this [rad]."""
TRAY_WITHIN = 0.02
"""A carrier stands at a station if its middle is this near to it [m] ..."""
LARGEST_TURN = 0.15
"""... and it is turned from it by no more than this [rad]."""
EXACT = Noise()
NOWHERE = "\uffff"
"""Where a carrier is that stands at no station: not a character, hence nobody's name."""


def read_state(where: Geometry, tabletop: Tabletop, hand: str | None = None, noise: Noise = EXACT) -> State:
    """The law's state in the observed scene.

    A location holds the unbroken column of upright blocks over its middle, a carrier the blocks that stand in its
    cells; everything else lies in the table region. A carrier that stands at no station is at `NOWHERE`.

    Args:
        where: Settled poses of all blocks and carriers.
        tabletop: The scene.
        hand: The block between the fingers, which stands nowhere.
        noise: How wrong the poses may be: a block may be seen further off a location that it stands on.
    """
    loose = {name: pose for name, pose in where.blocks.items() if name != hand}
    piles: dict[str, list[str]] = {}
    for location, slot in where.slots.items():
        column = sorted(
            (float(pose.position[2]), name)
            for name, pose in loose.items()
            if _over(pose, slot, _tolerance(tabletop.size(name), pose, noise))
        )
        pile: list[str] = []
        below: list[float] = []
        for middle, name in column:
            height = tabletop.size(name).upright(loose[name])
            if abs(middle / height - (levels(below, height) + 0.5)) > LEVEL_WITHIN:
                break
            pile.append(name)
            below.append(height)
        for name in pile:
            del loose[name]
        piles[location] = pile
    carried: dict[str, set[str]] = {}
    for carrier, pose in where.carriers.items():
        assert tabletop.tray is not None
        carried[carrier] = {
            name
            for name, block in loose.items()
            if tabletop.tray.cell_of(pose, block, tabletop.size(name).upright(block)) is not None
        }
        for name in carried[carrier]:
            del loose[name]
    stations = {carrier: _station(pose, where.stations, tabletop) for carrier, pose in where.carriers.items()}
    return State(piles, set(loose), hand, carried, stations)


def fallen_off(blocks: Mapping[str, BlockPose]) -> list[str]:
    """The blocks that are no longer on the table: no part of the law's state."""
    return [name for name, pose in blocks.items() if pose.position[2] < 0.0]


def _station(pose: BlockPose, stations: Mapping[str, Slot], tabletop: Tabletop) -> str:
    """The station that a tray stands at, flat on the table and along it."""
    if pose.tilt > LARGEST_TILT or abs(pose.position[2]) > tabletop.side / 2:
        return NOWHERE
    for station, slot in stations.items():
        # Its length lies across the bearing; which of its ends is which does not matter.
        turned = abs((heading(pose) - slot.angle) % pi - pi / 2)
        if pose.distance(slot.x, slot.y) < TRAY_WITHIN and turned < LARGEST_TURN:
            return station
    return NOWHERE


def _tolerance(size: BlockSize, pose: BlockPose, noise: Noise) -> float:
    """How far off a slot's middle a block stands at it [m]."""
    side = min(size.extents(pose)[:2])
    return min(PLACED_WITHIN * side + 2 * noise.pose + 2 * noise.camera, MOST_WITHIN * side)


def _over(pose: BlockPose, slot: Slot, tolerance: float) -> bool:
    return pose.tilt < LARGEST_TILT and pose.distance(slot.x, slot.y) < tolerance
