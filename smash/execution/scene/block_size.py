"""How large a block is: a box with a square footprint, which may lie on any of its faces after a topple."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import atan2

import numpy as np
from numpy.typing import NDArray

from smash.execution.scene.block_pose import QUARTER, BlockPose
from smash.motion.robot import Hand

FOOTPRINTS = (0.03, 0.07)
"""The least and the most of a footprint that the format of scenes allows [m]; the Panda's hand holds them all, whether
another one does is asked where it is used (`unfit`)."""
HEIGHTS = (0.025, 0.07)
"""The same of a height [m]: a block is held by its middle, the Panda's fingertips 7 mm below it, its palm 39 mm
above."""
BESIDE = 0.005
"""The least room between an open finger and the block that it comes down beside [m]."""

Extents = tuple[float, float, float]
"""Of a block that lies or is held level [m]: along one horizontal direction, across it, and upright."""


@dataclass(frozen=True, slots=True)
class BlockSize:
    """A box; its frame has the height along z.

    Attributes:
        footprint: Length of the sides of the square that it stands on in a pile [m].
        height: [m].
        mass: [kg].
    """

    footprint: float
    height: float
    mass: float

    @property
    def edges(self) -> Extents:
        """Along the axes of its frame [m]."""
        return self.footprint, self.footprint, self.height

    @property
    def half(self) -> NDArray[np.float64]:
        """Half of the edges [m], shape (3,)."""
        return np.array(self.edges) / 2

    @property
    def longest(self) -> float:
        """The longest edge [m]."""
        return max(self.footprint, self.height)

    @property
    def is_cube(self) -> bool:
        """Whether it does not matter which face it lies on."""
        return self.footprint == self.height

    def stands(self, pose: BlockPose) -> bool:
        """Whether it stands on its footprint, and does not lie on one of its sides."""
        return self.is_cube or pose.upright_axis == 2

    def upright(self, pose: BlockPose) -> float:
        """Its extent along the axis that is nearest to the vertical [m]."""
        return self.edges[pose.upright_axis]

    def extents(self, pose: BlockPose) -> Extents:
        """Its extents along `pose.yaw`, across that, and upright [m]."""
        axis = pose.upright_axis
        first, second, edges = (axis + 1) % 3, (axis + 2) % 3, self.edges
        heading = atan2(float(pose.rotation[1, first]), float(pose.rotation[0, first]))
        if round((heading - pose.yaw) / QUARTER) % 2:
            first, second = second, first
        return edges[first], edges[second], edges[axis]


def unfit(size: BlockSize, hand: Hand) -> str | None:
    """Return why a hand cannot hold a block from above, on whichever face it lies; None where it can."""
    wide, high = 2 * (hand.opening - BESIDE), 2 * hand.palm_depth
    if size.footprint > wide + 1e-9:
        return f"it is {size.footprint:g} m wide, and {max(wide, 0.0):.3g} m fit between the open fingers"
    if size.longest >= high:
        return f"it is {size.longest:g} m high, and the palm is {max(high / 2, 0.0):.3g} m above its middle"
    if min(size.edges) / 2 <= hand.tip:
        return f"it is {min(size.edges):g} m high, and the fingertips are {hand.tip:g} m below its middle"
    return None


def levels(heights: Iterable[float], unit: float) -> float:
    """How high a pile is, in units of one of its blocks: of equal blocks the very number of them.

    Args:
        heights: Of the pile's blocks [m].
        unit: Height of the block that is counted by [m].
    """
    return sum(height / unit for height in heights)
