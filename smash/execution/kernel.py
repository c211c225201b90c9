"""Numba kernels of the collision checker: arrays in, distances out.

The robot is spheres on its links and boxes on its hand (hand, fingers, carried block), the scene is boxes. Distances
are lower bounds: exact from sphere to box, the widest separating axis between two boxes (negative: penetration).

Shapes used throughout:
    chain: fixed transforms of the arm, (8, 3, 4), as of `Panda.chain`.
    spheres: centre and radius in the link's frame [m], (S, 4); link `i` owns rows `first[i]` to `first[i + 1]`.
    bounds: one sphere around everything of a link, (8, 4).
    hand_*: boxes in the tool frame: centres (B, 3), half extents (B, 3), rotations (B, 3, 3).
    link_pairs, hand_pairs: links, or hand box and link, that can meet each other, (P, 2).
    box_*: boxes of the scene in the world: centres (N, 3), half extents (N, 3), rotations (N, 3, 3).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")


def compiled(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Numba's `njit` with its file cache, with the function's own type."""
    return cast("Callable[_Parameters, _Result]", njit(cache=True)(function))


FAR = 0.1
"""Distances above this are all reported as this [m]: far enough for any step."""


@compiled
def link_frames(chain: Array, joints: Array) -> Array:
    """Frames of links 0 to 7 and of the tool in the world, shape (9, 3, 4)."""
    frames = np.zeros((9, 3, 4))
    for row in range(3):
        frames[0, row, row] = 1.0
    for index in range(8):
        cosine, sine = 1.0, 0.0
        if index < 7:
            cosine, sine = math.cos(joints[index]), math.sin(joints[index])
        for row in range(3):
            a, b, c, d = frames[index, row]
            local = chain[index]
            x = a * local[0, 0] + b * local[1, 0] + c * local[2, 0]
            y = a * local[0, 1] + b * local[1, 1] + c * local[2, 1]
            frames[index + 1, row, 0] = x * cosine + y * sine
            frames[index + 1, row, 1] = y * cosine - x * sine
            frames[index + 1, row, 2] = a * local[0, 2] + b * local[1, 2] + c * local[2, 2]
            frames[index + 1, row, 3] = a * local[0, 3] + b * local[1, 3] + c * local[2, 3] + d
    return frames


@compiled
def moved_point(frame: Array, x: float, y: float, z: float) -> tuple[float, float, float]:
    """A point of a frame in the world."""
    return (
        frame[0, 0] * x + frame[0, 1] * y + frame[0, 2] * z + frame[0, 3],
        frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * z + frame[1, 3],
        frame[2, 0] * x + frame[2, 1] * y + frame[2, 2] * z + frame[2, 3],
    )


@compiled
def point_to_box(x: float, y: float, z: float, centre: Array, half: Array, axes: Array) -> float:
    """Distance from a point to a box, 0 inside [m]."""
    dx, dy, dz = x - centre[0], y - centre[1], z - centre[2]
    total = 0.0
    for axis in range(3):
        beyond = abs(dx * axes[0, axis] + dy * axes[1, axis] + dz * axes[2, axis]) - half[axis]
        if beyond > 0.0:
            total += beyond * beyond
    return math.sqrt(total)


@compiled
def box_to_box(centre_a: Array, half_a: Array, axes_a: Array, centre_b: Array, half_b: Array, axes_b: Array) -> float:
    """Widest separation of two boxes over the 15 axes that decide (faces, edge pairs) [m]; negative: they overlap."""
    offset = np.empty(3)
    turn = np.empty((3, 3))
    spread = np.empty((3, 3))
    dx, dy, dz = centre_b[0] - centre_a[0], centre_b[1] - centre_a[1], centre_b[2] - centre_a[2]
    for i in range(3):
        offset[i] = dx * axes_a[0, i] + dy * axes_a[1, i] + dz * axes_a[2, i]
        for j in range(3):
            turn[i, j] = axes_a[0, i] * axes_b[0, j] + axes_a[1, i] * axes_b[1, j] + axes_a[2, i] * axes_b[2, j]
            spread[i, j] = abs(turn[i, j])
    widest = -1e9
    for i in range(3):
        reach = half_a[i] + half_b[0] * spread[i, 0] + half_b[1] * spread[i, 1] + half_b[2] * spread[i, 2]
        widest = max(widest, abs(offset[i]) - reach)
    for j in range(3):
        along = offset[0] * turn[0, j] + offset[1] * turn[1, j] + offset[2] * turn[2, j]
        reach = half_b[j] + half_a[0] * spread[0, j] + half_a[1] * spread[1, j] + half_a[2] * spread[2, j]
        widest = max(widest, abs(along) - reach)
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            length = math.sqrt(max(0.0, 1.0 - turn[i, j] * turn[i, j]))
            if length < 1e-4:
                continue
            j1, j2 = (j + 1) % 3, (j + 2) % 3
            reach = half_a[i1] * spread[i2, j] + half_a[i2] * spread[i1, j]
            reach += half_b[j1] * spread[i, j2] + half_b[j2] * spread[i, j1]
            along = offset[i2] * turn[i1, j] - offset[i1] * turn[i2, j]
            widest = max(widest, (abs(along) - reach) / length)
    return widest


@compiled
def place_boxes(frame: Array, centres: Array, rotations: Array) -> tuple[Array, Array]:
    """Boxes of a frame in the world: centres (B, 3) and rotations (B, 3, 3)."""
    count = centres.shape[0]
    placed, turned = np.empty((count, 3)), np.empty((count, 3, 3))
    for box in range(count):
        for row in range(3):
            placed[box, row] = frame[row, 3]
            for inner in range(3):
                placed[box, row] += frame[row, inner] * centres[box, inner]
            for column in range(3):
                value = 0.0
                for inner in range(3):
                    value += frame[row, inner] * rotations[box, inner, column]
                turned[box, row, column] = value
    return placed, turned


@compiled
def radius_of(half: Array) -> float:
    """Half diagonal of a box [m]."""
    return math.sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2])


@compiled
def link_to_box(
    frame: Array, spheres: Array, start: int, stop: int, centre: Array, half: Array, axes: Array, known: float
) -> float:
    """Least distance of a link's spheres to a box, or `known` where that is less [m]."""
    least = known
    for index in range(start, stop):
        x, y, z = moved_point(frame, spheres[index, 0], spheres[index, 1], spheres[index, 2])
        least = min(least, point_to_box(x, y, z, centre, half, axes) - spheres[index, 3])
    return least


@compiled
def scene_distance(
    frames: Array,
    spheres: Array,
    first: IntArray,
    bounds: Array,
    placed: Array,
    hand_half: Array,
    turned: Array,
    box_centre: Array,
    box_half: Array,
    box_axes: Array,
    from_link: int,
    known: float,
) -> float:
    """Least distance of the robot to the scene's boxes, or `known` where that is less [m].

    Links before `from_link` (bolted or hardly moving) are left out.
    """
    least = known
    for box in range(box_centre.shape[0]):
        centre, half, axes = box_centre[box], box_half[box], box_axes[box]
        around = radius_of(half)
        for held in range(placed.shape[0]):
            dx = placed[held, 0] - centre[0]
            dy = placed[held, 1] - centre[1]
            dz = placed[held, 2] - centre[2]
            limit = least + around + radius_of(hand_half[held])
            if limit <= 0.0 or dx * dx + dy * dy + dz * dz >= limit * limit:
                continue
            least = min(least, box_to_box(placed[held], hand_half[held], turned[held], centre, half, axes))
        for link in range(from_link, 8):
            x, y, z = moved_point(frames[link], bounds[link, 0], bounds[link, 1], bounds[link, 2])
            if point_to_box(x, y, z, centre, half, axes) - bounds[link, 3] < least:
                least = link_to_box(frames[link], spheres, first[link], first[link + 1], centre, half, axes, least)
    return least


@compiled
def links_distance(
    frames: Array, spheres: Array, first: IntArray, bounds: Array, link_a: int, link_b: int, known: float
) -> float:
    """Least distance between the spheres of two links, or `known` where that is less [m]."""
    ax, ay, az = moved_point(frames[link_a], bounds[link_a, 0], bounds[link_a, 1], bounds[link_a, 2])
    bx, by, bz = moved_point(frames[link_b], bounds[link_b, 0], bounds[link_b, 1], bounds[link_b, 2])
    apart = math.sqrt((ax - bx) ** 2 + (ay - by) ** 2 + (az - bz) ** 2)
    if apart - bounds[link_a, 3] - bounds[link_b, 3] >= known:
        return known
    least = known
    for i in range(first[link_a], first[link_a + 1]):
        px, py, pz = moved_point(frames[link_a], spheres[i, 0], spheres[i, 1], spheres[i, 2])
        near = math.sqrt((px - bx) ** 2 + (py - by) ** 2 + (pz - bz) ** 2) - spheres[i, 3] - bounds[link_b, 3]
        if near >= least:
            continue
        for j in range(first[link_b], first[link_b + 1]):
            x, y, z = moved_point(frames[link_b], spheres[j, 0], spheres[j, 1], spheres[j, 2])
            gap = math.sqrt((px - x) ** 2 + (py - y) ** 2 + (pz - z) ** 2)
            least = min(least, gap - spheres[i, 3] - spheres[j, 3])
    return least


@compiled
def self_distance(
    frames: Array,
    spheres: Array,
    first: IntArray,
    bounds: Array,
    placed: Array,
    hand_half: Array,
    turned: Array,
    link_pairs: IntArray,
    hand_pairs: IntArray,
    known: float,
) -> float:
    """Least distance between parts of the robot that can meet, or `known` where that is less [m]."""
    least = known
    for pair in range(link_pairs.shape[0]):
        least = links_distance(frames, spheres, first, bounds, link_pairs[pair, 0], link_pairs[pair, 1], least)
    for pair in range(hand_pairs.shape[0]):
        box, link = hand_pairs[pair, 0], hand_pairs[pair, 1]
        x, y, z = moved_point(frames[link], bounds[link, 0], bounds[link, 1], bounds[link, 2])
        if point_to_box(x, y, z, placed[box], hand_half[box], turned[box]) - bounds[link, 3] < least:
            least = link_to_box(
                frames[link],
                spheres,
                first[link],
                first[link + 1],
                placed[box],
                hand_half[box],
                turned[box],
                least,
            )
    return least


@compiled
def state_slacks(
    joints: Array,
    chain: Array,
    spheres: Array,
    first: IntArray,
    bounds: Array,
    link_pairs: IntArray,
    hand_pairs: IntArray,
    wrist_links: IntArray,
    wrist_hand: IntArray,
    hand_centre: Array,
    hand_half: Array,
    hand_axes: Array,
    box_centre: Array,
    box_half: Array,
    box_axes: Array,
    margin: float,
    allowance: float,
) -> tuple[float, float]:
    """How much nearer anything may come before the state is refused [m]: free where both are above 0.

    The scene must stay `margin` away; parts of the robot must not touch each other. The wrist's parts, which the
    spheres make too thick, may overlap by `allowance`.

    Returns:
        The slack to the scene and to the arm's base, which all joints change, and that between the forearm and the
        hand, which joints 6 and 7 change alone.
    """
    frames = link_frames(chain, joints)
    placed, turned = place_boxes(frames[8], hand_centre, hand_axes)
    wrist = allowance + self_distance(
        frames, spheres, first, bounds, placed, hand_half, turned, wrist_links, wrist_hand, FAR
    )
    if wrist <= 0.0:
        return wrist, wrist
    base = self_distance(frames, spheres, first, bounds, placed, hand_half, turned, link_pairs, hand_pairs, FAR)
    if base <= 0.0:
        return base, wrist
    outside = scene_distance(
        frames,
        spheres,
        first,
        bounds,
        placed,
        hand_half,
        turned,
        box_centre,
        box_half,
        box_axes,
        2,
        base + margin,
    )
    return outside - margin, wrist


@compiled
def motion_free(
    begin: Array,
    end: Array,
    reach: Array,
    smallest: float,
    chain: Array,
    spheres: Array,
    first: IntArray,
    bounds: Array,
    link_pairs: IntArray,
    hand_pairs: IntArray,
    wrist_links: IntArray,
    wrist_hand: IntArray,
    hand_centre: Array,
    hand_half: Array,
    hand_axes: Array,
    box_centre: Array,
    box_half: Array,
    box_axes: Array,
    margin: float,
    allowance: float,
) -> float:
    """How far along the straight joint segment the robot gets before something is in the way: 1 is all of it.

    Steps are as long as the slack allows: no point of the robot moves further than sum |dq_j| reach_j [m] in a step, so
    a step of that size within the slack cannot reach an obstacle. Where the slack is less, steps of `smallest` [m].
    """
    travel = 1e-12
    for joint in range(7):
        travel += abs(end[joint] - begin[joint]) * reach[joint]
    wrist_travel = 1e-12
    for joint in range(5, 7):
        wrist_travel += abs(end[joint] - begin[joint]) * reach[joint]
    here = np.empty(7)
    done = 0.0
    while True:
        for joint in range(7):
            here[joint] = begin[joint] + done * (end[joint] - begin[joint])
        slack, wrist = state_slacks(
            here,
            chain,
            spheres,
            first,
            bounds,
            link_pairs,
            hand_pairs,
            wrist_links,
            wrist_hand,
            hand_centre,
            hand_half,
            hand_axes,
            box_centre,
            box_half,
            box_axes,
            margin,
            allowance,
        )
        if slack <= 0.0 or wrist <= 0.0:
            return done
        if done >= 1.0:
            return 1.0
        step = min(max(slack, smallest) / travel, max(wrist, smallest) / wrist_travel)
        done = min(1.0, done + step)
