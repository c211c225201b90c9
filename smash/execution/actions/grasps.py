"""How the hand may hold a block from above: by its middle, or beside it and leaning where a neighbour leaves no room.

The pads lie along two sides of the block. The hand may stand a little off the block's middle along them, or lean about
the line that joins them; a block that was taken so is put down so, and stands where it shall.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, radians, sin

import numpy as np
from numpy.typing import ArrayLike

from smash.execution.scene.block_size import Extents
from smash.motion.obstacles import Attached, HandState
from smash.motion.poses import Matrix, ToolPose, top_down


@dataclass(frozen=True, slots=True)
class Grasp:
    """Where the hand is on the block that it holds.

    Attributes:
        offset: From the block's middle along the pads, the tool's x axis before it leans [m].
        tilt: How the hand leans about the line between the pads, its fingertips towards that axis [rad].
        extents: Of the block in it: along the pads, across them, and upright [m]; None where that is not known yet.
    """

    offset: float = 0.0
    tilt: float = 0.0
    extents: Extents | None = None

    def of(self, extents: Extents) -> Grasp:
        """The same grasp of a block of these extents [m]."""
        return replace(self, extents=extents)

    @property
    def width(self) -> float:
        """Of what is between the fingers [m]."""
        assert self.extents is not None, "the block is known before the fingers close"
        return self.extents[1]

    def clears(self, palm: float) -> bool:
        """Whether the block's upper edge stays in front of a palm so far back from the tool's point [m]."""
        assert self.extents is not None, "the block is known before the hand comes down"
        along, _, upright = self.extents
        return (upright * cos(self.tilt) + along * sin(abs(self.tilt))) / 2 < palm

    def tool(self, middle: ArrayLike, yaw: float) -> ToolPose:
        """The tool's pose on an upright block.

        Args:
            middle: Of the block [m], shape (3,).
            yaw: Direction of the pads in the world: of one of the block's sides [rad].
        """
        upright = top_down(middle, yaw)
        return ToolPose(upright.position + self.offset * upright.rotation[:, 0], upright.rotation @ self._leaning)

    def hand(self) -> HandState:
        """The hand with the block in it."""
        place = -self.offset * self._leaning.T[:, 0]
        half = np.array([self.extents]) / 2
        return HandState(self.width / 2, Attached(half, place[None], self._leaning.T[None]))

    @property
    def _leaning(self) -> Matrix:
        """Tool axes in the frame of the upright tool, as columns, shape (3, 3)."""
        c, s = cos(self.tilt), sin(self.tilt)
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


CENTRED = Grasp()
GRASPS = (
    CENTRED,
    *(Grasp(offset=offset) for offset in (0.006, 0.010)),
    *(Grasp(tilt=radians(tilt)) for tilt in (10.0, 20.0, 30.0)),
)
"""In the order in which they are tried. Each is tried along all four sides, so both ways along the pads."""
