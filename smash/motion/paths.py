"""Joint paths (where, not when), points close together on them, and the rounding of their corners."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from smash.motion.poses import Vector

Waypoints = NDArray[np.float64]
PathKind = Literal["straight", "tree", "line"]

LONGEST_BLEND = 0.6
"""A corner is rounded over at most this length on either side [rad]."""
SHORTEST_BLEND = 0.02
BLEND_POINTS = 9


@dataclass(frozen=True, eq=False)
class Path:
    """A polyline in joint space, collision-free when it comes from the planner.

    Attributes:
        waypoints: [rad], shape (W, n), W >= 2; corners of tree paths are rounded already.
        kind: How it was found: `straight` joint segment, `tree` (RRTConnect), `line` (the tool on a straight line).
    """

    waypoints: Waypoints
    kind: PathKind

    @property
    def start(self) -> Vector:
        """First configuration [rad], shape (n,)."""
        return np.asarray(self.waypoints[0])

    @property
    def end(self) -> Vector:
        """Last configuration [rad], shape (n,)."""
        return np.asarray(self.waypoints[-1])

    @property
    def length(self) -> float:
        """Euclidean length in joint space [rad]."""
        return float(np.sum(np.linalg.norm(np.diff(self.waypoints, axis=0), axis=1)))

    def reversed(self) -> Path:
        """The same path walked backwards."""
        return Path(np.ascontiguousarray(self.waypoints[::-1]), self.kind)


def densify(waypoints: Waypoints, step: float) -> Waypoints:
    """The same joint polyline with no joint moving more than `step` [rad] between rows: (W, n) to (T, n)."""
    changes = np.diff(waypoints, axis=0)
    counts = np.maximum(1, np.ceil(np.abs(changes).max(axis=1) / step)).astype(np.int64)
    segments = np.repeat(np.arange(len(changes)), counts)
    before = np.cumsum(counts) - counts
    fractions = (np.arange(1, len(segments) + 1) - before[segments]) / counts[segments]
    return np.concatenate([waypoints[:1], waypoints[segments] + fractions[:, None] * changes[segments]])


def round_corners(waypoints: Waypoints, free: Callable[[Waypoints], bool]) -> Waypoints:
    """Replace the corners of a polyline by parabolas, so that the arm need not stop there.

    A parabola touches both segments at the same distance from the corner; the distance is halved until `free` accepts
    it, and the corner stays where none is.

    Args:
        waypoints: [rad], shape (W, n).
        free: Whether a piece of polyline is free of collisions.
    """
    if len(waypoints) < 3:
        return waypoints
    lengths = np.linalg.norm(np.diff(waypoints, axis=0), axis=1)
    pieces = [waypoints[:1]]
    for corner in range(1, len(waypoints) - 1):
        room = min(LONGEST_BLEND, lengths[corner - 1] / 2, lengths[corner] / 2)
        pieces.append(_rounded(waypoints, corner, room, free))
    pieces.append(waypoints[-1:])
    rounded = np.concatenate(pieces)
    # Two arcs that share a segment may meet in its middle.
    apart = np.any(np.abs(np.diff(rounded, axis=0)) > 1e-9, axis=1)
    return np.asarray(rounded[np.concatenate([[True], apart])])


def _rounded(waypoints: Waypoints, corner: int, room: float, free: Callable[[Waypoints], bool]) -> Waypoints:
    before, point, after = waypoints[corner - 1 : corner + 2]
    into = (point - before) / np.linalg.norm(point - before)
    onward = (after - point) / np.linalg.norm(after - point)
    parameter = np.linspace(0.0, 1.0, BLEND_POINTS)[:, None]
    while room > SHORTEST_BLEND:
        enter, leave = point - room * into, point + room * onward
        arc = (1 - parameter) ** 2 * enter + 2 * parameter * (1 - parameter) * point + parameter**2 * leave
        if free(arc):
            return np.asarray(arc)
        room /= 2
    return np.asarray(point[None])
