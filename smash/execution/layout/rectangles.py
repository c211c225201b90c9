"""Rectangles on the table, many at once: which points they hold, which of them meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Rectangles:
    """N rectangles.

    Attributes:
        centres: [m], shape (N, 2).
        axes: Directions of their first sides, unit vectors, shape (N, 2).
        half: Half side lengths [m], along that direction and across, shape (2,): the same for all.
    """

    centres: Floats
    axes: Floats
    half: Floats

    def __getitem__(self, which: Mask | NDArray[np.int64] | slice) -> Rectangles:
        """Some of them."""
        return Rectangles(self.centres[which], self.axes[which], self.half)

    def hold(self, points: Floats, margin: float) -> Mask:
        """Which rectangles have a point in them or nearer than `margin` [m], seen along their sides.

        Args:
            points: [m], shape (2,) for all rectangles, or (N, 2): each has its own, or all are asked of the only one.
            margin: [m].

        Returns:
            Shape (N,).
        """
        offset = points - self.centres
        along = np.abs(np.sum(offset * self.axes, axis=-1))
        across = np.abs(offset[..., 0] * self.axes[:, 1] - offset[..., 1] * self.axes[:, 0])
        return np.asarray((along < self.half[0] + margin) & (across < self.half[1] + margin))

    def meet(self, other: Rectangles) -> Mask:
        """Which rectangles overlap the only one of `other`, shape (N,): no side of either separates them."""
        offset = other.centres[0] - self.centres
        separated = np.zeros(len(self.centres), dtype=bool)
        for axes in (self.axes, _turned(self.axes), other.axes, _turned(other.axes)):
            reach = _shadow(self, axes) + _shadow(other, axes)
            separated |= np.abs(np.sum(offset * axes, axis=-1)) >= reach
        return ~separated


def _turned(axes: Floats) -> Floats:
    return np.stack([-axes[:, 1], axes[:, 0]], axis=1)


def _shadow(rectangles: Rectangles, axes: Floats) -> Floats:
    """Half of the length of each rectangle seen along an axis [m], shape (N,)."""
    along = np.abs(np.sum(rectangles.axes * axes, axis=-1))
    across = np.abs(np.sum(_turned(rectangles.axes) * axes, axis=-1))
    return np.asarray(rectangles.half[0] * along + rectangles.half[1] * across)
