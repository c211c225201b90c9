"""Which parts of a robot come near which things along a motion: spheres around everything, in numba.

What stays apart by these cannot touch, so that the hulls (`hulls`) need not be asked about it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from smash.motion.kernel import Array, IntArray, compiled, link_frames

ALLOWANCE = 0.001
"""What is further apart than this is left out [m]."""


class Around(NamedTuple):
    """Spheres around parts of a robot, one each.

    Attributes:
        owners: Number of the frame, as of `link_frames`, that each is fixed in, shape (P,).
        centres: In these frames [m], shape (P, 3).
        radii: [m], shape (P,).
    """

    owners: IntArray
    centres: Array
    radii: Array


@compiled
def places_along(chain: Array, motion: Array, owners: IntArray, centres: Array) -> Array:
    """Where points of the links are along configurations [rad], (T, n), in the world [m]: (T, P, 3)."""
    places = np.empty((motion.shape[0], owners.shape[0], 3))
    for step in range(motion.shape[0]):
        frames = link_frames(chain, motion[step])
        for part in range(owners.shape[0]):
            frame = frames[owners[part]]
            for row in range(3):
                places[step, part, row] = frame[row, 3]
                for column in range(3):
                    places[step, part, row] += frame[row, column] * centres[part, column]
    return places


@compiled
def parts_near(places: Array, radii: Array, pairs: IntArray) -> NDArray[np.bool_]:
    """Which pairs of parts, (K, 2), come near each other anywhere along `places`, as of `places_along`."""
    near = np.zeros(pairs.shape[0], dtype=np.bool_)
    for number in range(pairs.shape[0]):
        one, other = pairs[number]
        limit = radii[one] + radii[other] + ALLOWANCE
        for step in range(places.shape[0]):
            square = 0.0
            for axis in range(3):
                square += (places[step, one, axis] - places[step, other, axis]) ** 2
            if square < limit * limit:
                near[number] = True
                break
    return near


@compiled
def boxes_near(
    places: Array, radii: Array, parts: IntArray, centres: Array, half: Array, axes: Array
) -> NDArray[np.bool_]:
    """Which parts, (M,), come near which boxes anywhere along `places`: shape (N, M).

    Args:
        places: Of all parts, as of `places_along`, (T, P, 3).
        radii: Of all parts [m], (P,).
        parts: Those that are asked about, (M,).
        centres: Of the boxes in the world [m], (N, 3).
        half: Their half extents [m], (N, 3).
        axes: Their axes as columns, (N, 3, 3).
    """
    near = np.zeros((centres.shape[0], parts.shape[0]), dtype=np.bool_)
    for box in range(centres.shape[0]):
        for number in range(parts.shape[0]):
            part = parts[number]
            limit = radii[part] + ALLOWANCE
            for step in range(places.shape[0]):
                square = 0.0
                for axis in range(3):
                    along = 0.0
                    for row in range(3):
                        along += (places[step, part, row] - centres[box, row]) * axes[box, row, axis]
                    square += max(0.0, math.fabs(along) - half[box, axis]) ** 2
                if square < limit * limit:
                    near[box, number] = True
                    break
    return near
