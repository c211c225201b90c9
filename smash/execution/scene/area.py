"""Parts of the table that toppled blocks may lie in before anybody has seen where they do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from smash.execution.scene.tabletop import Slot
from smash.motion.obstacles import FIXTURE, Scene
from smash.motion.poses import yaw_rotation


@dataclass(frozen=True, slots=True)
class Area:
    """A rectangle along a topple direction of a pile, and who may lie in it.

    Attributes:
        slot: The pile's place.
        direction: Name of the topple direction.
        length: How far it goes from the pile's middle [m].
        half_width: How far to both sides of the push [m].
        height: How high blocks may lie there [m].
        blocks: Who was toppled.
    """

    slot: Slot
    direction: str
    length: float
    half_width: float
    height: float
    blocks: frozenset[str]

    def near(self, x: float, y: float, margin: float) -> bool:
        """Whether a point [m] lies in it, in the pile's own place or nearer than `margin` [m] to them."""
        along, aside = self.slot.coordinates(x, y, self.direction)
        return -margin < along < self.length + margin and abs(aside) < self.half_width + margin

    def box(self) -> Scene:
        """It as an obstacle: solid up to its height, so that nothing of the arm passes where blocks may be."""
        x, y = self.slot.point(self.length / 2, 0.0, self.direction)
        turned = yaw_rotation(self.slot.heading(self.direction))
        half = [self.length / 2, self.half_width, self.height / 2]
        return Scene.of_boxes([FIXTURE], [[x, y, self.height / 2]], [half], np.array([turned]))
