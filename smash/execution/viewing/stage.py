"""What pictures of a recorded episode are drawn with: a stage of robot, table and blocks, whatever paints it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from smash.execution.scene.marks import Colour
from smash.execution.scene.tabletop import Tabletop
from smash.execution.viewing.recording import Recording
from smash.problem.pictures import PALETTE

TRAY_COLOUR = (0.62, 0.47, 0.30)
TABLE_COLOUR = (0.90, 0.88, 0.84)
TABLE_HALF = (0.85, 0.85, 0.01)
"""Half of the table that is shown [m]."""
LOOKED_AT = (0.0, -0.02, 0.20)
"""[m]"""
VIEW_ANGLE = 52.0
"""From the lower to the upper edge of a picture [degrees]."""
LIGHT = (0.6, 0.4, 1.4)
"""Where the light comes from."""

Image = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Camera:
    """Where a picture is taken from.

    Attributes:
        yaw: About the vertical, 0 along the world's y axis [degrees].
        pitch: Downwards where it is negative [degrees].
        distance: From what is looked at [m].
    """

    yaw: float = 28.0
    pitch: float = -40.0
    distance: float = 1.45


CAMERA = Camera()


def block_colours(count: int) -> list[Colour]:
    """Red, green, blue in 0..1 for each block, in order: the colours that it has in every other picture."""
    paints = [PALETTE[number % len(PALETTE)] for number in range(count)]
    return [(int(p[1:3], 16) / 255, int(p[3:5], 16) / 255, int(p[5:7], 16) / 255) for p in paints]


class Stage(ABC):
    """Robot, table, slots and blocks to be posed and photographed; use as a context manager.

    Args:
        tabletop: The scene.
        blocks: Their names, in the order of a recording.
        carriers: How many there are.
        coarse: Without shadows: for films.

    Raises:
        Unsupported: where nothing can be drawn here.
    """

    def __init__(self, tabletop: Tabletop, blocks: Sequence[str], carriers: int = 0, *, coarse: bool = False) -> None:
        self._coarse = coarse
        self._open(tabletop, blocks, carriers)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @abstractmethod
    def _open(self, tabletop: Tabletop, blocks: Sequence[str], carriers: int) -> None:
        """Set everything up."""

    @abstractmethod
    def close(self) -> None:
        """Give back what is held."""

    @abstractmethod
    def pose(self, recording: Recording, frame: int) -> None:
        """Move everything to where it was in a frame."""

    @abstractmethod
    def photograph(self, size: tuple[int, int], camera: Camera = CAMERA) -> Image:
        """A picture of the table of this width and height [pixels], shape (height, width, 3)."""
