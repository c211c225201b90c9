"""Numba kernels of the collision checker: arrays in, distances out.

The robot is spheres on its links and boxes on its hand (hand, fingers, carried block), the scene is boxes. Distances
are lower bounds: exact from sphere to box, the widest separating axis between two boxes (negative: penetration).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple, ParamSpec, TypeVar, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]

_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")


def compiled(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Numba's `njit` with its file cache, with the function's own type."""
    return cast("Callable[_Parameters, _Result]", njit(cache=True, error_model="numpy")(function))


FAR = 0.1
"""Distances to the scene and the base above this are all reported as this [m]: far enough for any step."""
WRIST_FAR = 0.03
"""The same for the distance of hand and forearm, which the wrist's joints change alone [m]."""


class Arm(NamedTuple):
    """The base, link 0, and the links that n joints move.

    Attributes:
        chain: Fixed transforms, (n + 1, 3, 4), as of `Robot.chain`.
        spheres: Centre and radius in the link's frame [m], (S, 4).
        first: Link i owns the spheres first[i] to first[i + 1], (n + 2,).
        bounds: One sphere around everything of a link [m], (n + 1, 4).
        rows: 0 to n + 1: link i owns the bound i.
        base_pairs: Links that can meet, of which one lies before the forearm, (P, 2).
        wrist_pairs: Links that can meet, none of them before the forearm, (P, 2).
        forearm: The last link before the wrist.
        lowest: The first link that is checked against the scene: those before it stand over their place on the table.
    """

    chain: Array
    spheres: Array
    first: IntArray
    bounds: Array
    rows: IntArray
    base_pairs: IntArray
    wrist_pairs: IntArray
    forearm: int
    lowest: int


class Boxes(NamedTuple):
    """Oriented boxes: of the scene in the world, or of the hand in the tool frame.

    Attributes:
        centres: [m], (N, 3).
        half: Half extents [m], (N, 3).
        axes: Box axes as columns, (N, 3, 3).
    """

    centres: Array
    half: Array
    axes: Array


class Body(NamedTuple):
    """The robot at one configuration, in the world.

    Attributes:
        frames: Of links 0 to n and of the tool, (n + 2, 3, 4).
        spheres: Centre and radius [m], (S, 4).
        bounds: One sphere around each link [m], (n + 1, 4).
        hand: Boxes of hand, fingers and carried block.
    """

    frames: Array
    spheres: Array
    bounds: Array
    hand: Boxes


class Demands(NamedTuple):
    """What a free state keeps.

    Attributes:
        margin: Distance from the scene [m].
        allowance: Overlap that is allowed to the covers of forearm and wrist, which are too thick [m].
        hand_base_pairs: Hand box and link of the base that can meet, (P, 2).
        hand_wrist_pairs: Hand box and link of the wrist that can meet, (P, 2).
    """

    margin: float
    allowance: float
    hand_base_pairs: IntArray
    hand_wrist_pairs: IntArray


@compiled
def link_frames(chain: Array, joints: Array) -> Array:
    """Frames of links 0 to n and of the tool in the world, shape (n + 2, 3, 4)."""
    count = joints.shape[0]
    frames = np.zeros((count + 2, 3, 4))
    for row in range(3):
        frames[0, row, row] = 1.0
    for index in range(count + 1):
        cosine, sine = 1.0, 0.0
        if index < count:
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
def moved_spheres(frames: Array, spheres: Array, first: IntArray) -> Array:
    """Spheres in the world, (S, 4), from the frames of the links; link i owns first[i] to first[i + 1]."""
    world = np.empty((spheres.shape[0], 4))
    for link in range(first.shape[0] - 1):
        a, b, c, d = frames[link, 0, 0], frames[link, 0, 1], frames[link, 0, 2], frames[link, 0, 3]
        e, f, g, h = frames[link, 1, 0], frames[link, 1, 1], frames[link, 1, 2], frames[link, 1, 3]
        i, j, k, m = frames[link, 2, 0], frames[link, 2, 1], frames[link, 2, 2], frames[link, 2, 3]
        for index in range(first[link], first[link + 1]):
            x, y, z = spheres[index, 0], spheres[index, 1], spheres[index, 2]
            world[index, 0] = a * x + b * y + c * z + d
            world[index, 1] = e * x + f * y + g * z + h
            world[index, 2] = i * x + j * y + k * z + m
            world[index, 3] = spheres[index, 3]
    return world


# The inner functions take bare arrays: passing a tuple of arrays costs more than their whole work.


@compiled
def sphere_to_box(world: Array, index: int, centres: Array, half: Array, axes: Array, box: int) -> float:
    """Distance from a sphere to a box [m]; minus the radius where the sphere's centre is inside."""
    dx = world[index, 0] - centres[box, 0]
    dy = world[index, 1] - centres[box, 1]
    dz = world[index, 2] - centres[box, 2]
    total = 0.0
    for axis in range(3):
        beyond = abs(dx * axes[box, 0, axis] + dy * axes[box, 1, axis] + dz * axes[box, 2, axis]) - half[box, axis]
        if beyond > 0.0:
            total += beyond * beyond
    distance: float = math.sqrt(total) - world[index, 3]
    return distance


@compiled
def box_to_box(
    centres_a: Array,
    half_a: Array,
    axes_a: Array,
    a: int,
    centres_b: Array,
    half_b: Array,
    axes_b: Array,
    b: int,
    known: float,
    turn: Array,
) -> float:
    """Widest separation of two boxes [m], negative where they overlap; or any value not below `known`.

    Looks along the 15 axes that decide: the face normals of both and the products of their edges. `turn` is room to
    work in, (3, 3).
    """
    dx = centres_b[b, 0] - centres_a[a, 0]
    dy = centres_b[b, 1] - centres_a[a, 1]
    dz = centres_b[b, 2] - centres_a[a, 2]
    widest = -1e9
    for i in range(3):
        along = dx * axes_a[a, 0, i] + dy * axes_a[a, 1, i] + dz * axes_a[a, 2, i]
        reach = half_a[a, i]
        for j in range(3):
            turn[i, j] = (
                axes_a[a, 0, i] * axes_b[b, 0, j]
                + axes_a[a, 1, i] * axes_b[b, 1, j]
                + axes_a[a, 2, i] * axes_b[b, 2, j]
            )
            reach += half_b[b, j] * abs(turn[i, j])
        widest = max(widest, abs(along) - reach)
    for j in range(3):
        along = dx * axes_b[b, 0, j] + dy * axes_b[b, 1, j] + dz * axes_b[b, 2, j]
        reach = half_a[a, 0] * abs(turn[0, j]) + half_a[a, 1] * abs(turn[1, j]) + half_a[a, 2] * abs(turn[2, j])
        widest = max(widest, abs(along) - reach - half_b[b, j])
    if widest >= known:
        return widest
    offset_0 = dx * axes_a[a, 0, 0] + dy * axes_a[a, 1, 0] + dz * axes_a[a, 2, 0]
    offset_1 = dx * axes_a[a, 0, 1] + dy * axes_a[a, 1, 1] + dz * axes_a[a, 2, 1]
    offset_2 = dx * axes_a[a, 0, 2] + dy * axes_a[a, 1, 2] + dz * axes_a[a, 2, 2]
    offset = (offset_0, offset_1, offset_2)
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            length = math.sqrt(max(0.0, 1.0 - turn[i, j] * turn[i, j]))
            if length < 1e-4:
                continue
            j1, j2 = (j + 1) % 3, (j + 2) % 3
            reach = half_a[a, i1] * abs(turn[i2, j]) + half_a[a, i2] * abs(turn[i1, j])
            reach += half_b[b, j1] * abs(turn[i, j2]) + half_b[b, j2] * abs(turn[i, j1])
            along = offset[i2] * turn[i1, j] - offset[i1] * turn[i2, j]
            widest = max(widest, (abs(along) - reach) / length)
    return widest


@compiled
def place_boxes(frame: Array, boxes: Boxes) -> Boxes:
    """Boxes of a frame, in the world."""
    count = boxes.centres.shape[0]
    placed, turned = np.empty((count, 3)), np.empty((count, 3, 3))
    for box in range(count):
        for row in range(3):
            placed[box, row] = frame[row, 3]
            for inner in range(3):
                placed[box, row] += frame[row, inner] * boxes.centres[box, inner]
            for column in range(3):
                value = 0.0
                for inner in range(3):
                    value += frame[row, inner] * boxes.axes[box, inner, column]
                turned[box, row, column] = value
    return Boxes(placed, boxes.half, turned)


@compiled
def radius_of(half: Array, box: int) -> float:
    """Half diagonal of a box [m]."""
    return math.sqrt(half[box, 0] ** 2 + half[box, 1] ** 2 + half[box, 2] ** 2)


@compiled
def posture(arm: Arm, hand: Boxes, joints: Array) -> Body:
    """The robot at a configuration [rad], (n,), with the hand's boxes given in the tool frame."""
    frames = link_frames(arm.chain, joints)
    spheres = moved_spheres(frames, arm.spheres, arm.first)
    return Body(frames, spheres, moved_spheres(frames, arm.bounds, arm.rows), place_boxes(frames[-1], hand))


@compiled
def link_to_box(
    spheres: Array,
    bounds: Array,
    first: IntArray,
    link: int,
    centres: Array,
    half: Array,
    axes: Array,
    box: int,
    known: float,
) -> float:
    """Least distance of a link's spheres to a box, or `known` where that is less [m]."""
    if sphere_to_box(bounds, link, centres, half, axes, box) >= known:
        return known
    least = known
    around = radius_of(half, box)
    for index in range(first[link], first[link + 1]):
        dx = spheres[index, 0] - centres[box, 0]
        dy = spheres[index, 1] - centres[box, 1]
        dz = spheres[index, 2] - centres[box, 2]
        limit = least + around + spheres[index, 3]
        if dx * dx + dy * dy + dz * dz < limit * limit or limit < 0.0:
            least = min(least, sphere_to_box(spheres, index, centres, half, axes, box))
    return least


@compiled
def scene_distance(arm: Arm, body: Body, scene: Boxes, known: float) -> float:
    """Least distance of the robot to the scene's boxes, or `known` where that is less [m]."""
    least = known
    held_centres, held_half, held_axes = body.hand.centres, body.hand.half, body.hand.axes
    centres, half, axes = scene.centres, scene.half, scene.axes
    spheres, bounds, first = body.spheres, body.bounds, arm.first
    turn = np.empty((3, 3))
    for box in range(centres.shape[0]):
        around = radius_of(half, box)
        for held in range(held_centres.shape[0]):
            dx = held_centres[held, 0] - centres[box, 0]
            dy = held_centres[held, 1] - centres[box, 1]
            dz = held_centres[held, 2] - centres[box, 2]
            limit = least + around + radius_of(held_half, held)
            if limit > 0.0 and dx * dx + dy * dy + dz * dz < limit * limit:
                apart = box_to_box(held_centres, held_half, held_axes, held, centres, half, axes, box, least, turn)
                least = min(least, apart)
    # The hand first: it is mostly the nearest, and a small distance known early spares the links' spheres.
    for box in range(centres.shape[0]):
        for link in range(arm.lowest, bounds.shape[0]):
            least = link_to_box(spheres, bounds, first, link, centres, half, axes, box, least)
    return least


@compiled
def spheres_apart(one: Array, i: int, other: Array, j: int) -> float:
    """Distance between two spheres [m]."""
    dx, dy, dz = one[i, 0] - other[j, 0], one[i, 1] - other[j, 1], one[i, 2] - other[j, 2]
    distance: float = math.sqrt(dx * dx + dy * dy + dz * dz) - one[i, 3] - other[j, 3]
    return distance


@compiled
def links_distance(spheres: Array, bounds: Array, first: IntArray, link_a: int, link_b: int, known: float) -> float:
    """Least distance between the spheres of two links, or `known` where that is less [m]."""
    if spheres_apart(bounds, link_a, bounds, link_b) >= known:
        return known
    least = known
    for i in range(first[link_a], first[link_a + 1]):
        if spheres_apart(spheres, i, bounds, link_b) >= least:
            continue
        for j in range(first[link_b], first[link_b + 1]):
            least = min(least, spheres_apart(spheres, i, spheres, j))
    return least


@compiled
def self_distance(arm: Arm, body: Body, link_pairs: IntArray, hand_pairs: IntArray, known: float) -> float:
    """Least distance between those pairs of the robot's parts, or `known` where that is less [m]."""
    least = known
    spheres, bounds, first = body.spheres, body.bounds, arm.first
    centres, half, axes = body.hand.centres, body.hand.half, body.hand.axes
    for pair in range(link_pairs.shape[0]):
        least = links_distance(spheres, bounds, first, link_pairs[pair, 0], link_pairs[pair, 1], least)
    for pair in range(hand_pairs.shape[0]):
        box, link = hand_pairs[pair, 0], hand_pairs[pair, 1]
        least = link_to_box(spheres, bounds, first, link, centres, half, axes, box, least)
    return least


@compiled
def slacks(arm: Arm, body: Body, scene: Boxes, demands: Demands) -> tuple[float, float]:
    """How much nearer anything may come before the state is refused [m]: free where both are above 0.

    Args:
        arm: The arm.
        body: Of `posture`.
        scene: What to keep away from.
        demands: How far.

    Returns:
        The slack to the scene and to the arm's base, which all joints change, and that between the forearm and the
        hand, which the wrist's joints change alone. Once one is 0 or less the other may be left unknown.
    """
    wrist = demands.allowance + self_distance(arm, body, arm.wrist_pairs, demands.hand_wrist_pairs, WRIST_FAR)
    if wrist <= 0.0:
        return wrist, wrist
    base = self_distance(arm, body, arm.base_pairs, demands.hand_base_pairs, FAR)
    if base <= 0.0:
        return base, wrist
    margin = demands.margin
    return scene_distance(arm, body, scene, base + margin) - margin, wrist


@compiled
def state_slack(joints: Array, arm: Arm, hand: Boxes, scene: Boxes, demands: Demands) -> float:
    """The lesser of the `slacks` of a configuration [rad], (n,): free above 0 [m]."""
    outside, wrist = slacks(arm, posture(arm, hand, joints), scene, demands)
    return min(outside, wrist)


@compiled
def radii(body: Body) -> Array:
    """How far the outermost point that a joint moves is from the joint's axis now, at most [m], shape (n,)."""
    links = body.bounds.shape[0]
    reach = np.zeros(links - 1)
    hand = body.hand
    for joint in range(links - 1):
        axis = body.frames[joint + 1]
        for index in range(joint + 1, links + hand.centres.shape[0]):
            if index < links:
                x, y, z, size = body.bounds[index]
            else:
                x, y, z = hand.centres[index - links]
                size = radius_of(hand.half, index - links)
            dx, dy, dz = x - axis[0, 3], y - axis[1, 3], z - axis[2, 3]
            along = dx * axis[0, 2] + dy * axis[1, 2] + dz * axis[2, 2]
            across = math.sqrt(max(0.0, dx * dx + dy * dy + dz * dz - along * along))
            reach[joint] = max(reach[joint], across + size)
    return reach


@compiled
def step_free(
    begin: Array, end: Array, body: Body, outside: float, wrist: float, smallest: float, forearm: int
) -> float:
    """The share of the straight joint segment that the robot may move by before it is looked at again.

    While the robot moves by sum |dq_j| (r_j + d), no point of it moves further, where r_j are the `radii` at the step's
    beginning and d is the step itself, so a step within the slack cannot reach an obstacle. Where the slack is less,
    steps of `smallest` [m] are taken.

    Args:
        begin: Where the segment begins [rad], (n,).
        end: Where it ends [rad], (n,).
        body: The robot where the step begins.
        outside: The first of its `slacks` [m].
        wrist: The second one [m].
        smallest: [m].
        forearm: The last link before the wrist.
    """
    change = np.abs(end - begin)
    total = max(np.sum(change), 1e-9)
    reach = radii(body)
    travel = np.sum(change * reach)
    wrist_travel = np.sum(change[forearm:] * reach[forearm:])
    outside, wrist = max(outside, smallest), max(wrist, smallest)
    share: float = min(outside / (travel + outside * total), wrist / (wrist_travel + wrist * total))
    return share


@compiled
def free_from(
    done: float, begin: Array, end: Array, smallest: float, arm: Arm, hand: Boxes, scene: Boxes, demands: Demands
) -> float:
    """How far along the straight joint segment the robot gets from the share `done` on before something is in the way.

    1 is all of it; the segment's end itself is not looked at.
    """
    while done < 1.0:
        body = posture(arm, hand, begin + done * (end - begin))
        outside, wrist = slacks(arm, body, scene, demands)
        if outside <= 0.0 or wrist <= 0.0:
            return done
        done += step_free(begin, end, body, outside, wrist, smallest, arm.forearm)
    return 1.0


@compiled
def motion_free(
    begin: Array, end: Array, smallest: float, arm: Arm, hand: Boxes, scene: Boxes, demands: Demands
) -> float:
    """`free_from` the beginning."""
    return free_from(0.0, begin, end, smallest, arm, hand, scene, demands)


@compiled
def blocked_at_a_glance(begin: Array, end: Array, arm: Arm, hand: Boxes, scene: Boxes, demands: Demands) -> bool:
    """Whether a few states within the segment show that it is blocked, where it is long: most blocked ones end here."""
    if np.sum(np.abs(end - begin)) > 0.4:
        for part in range(1, 4):
            if state_slack(begin + part / 4 * (end - begin), arm, hand, scene, demands) <= 0.0:
                return True
    return False


@compiled
def polyline_free(waypoints: Array, smallest: float, arm: Arm, hand: Boxes, scene: Boxes, demands: Demands) -> bool:
    """Whether all segments between consecutive waypoints [rad], (W, 7), are free; no state is looked at twice."""
    body = posture(arm, hand, waypoints[0])
    outside, wrist = slacks(arm, body, scene, demands)
    if outside <= 0.0 or wrist <= 0.0:
        return False
    for row in range(waypoints.shape[0] - 1):
        begin, end = waypoints[row], waypoints[row + 1]
        ahead = posture(arm, hand, end)
        outside_ahead, wrist_ahead = slacks(arm, ahead, scene, demands)
        if outside_ahead <= 0.0 or wrist_ahead <= 0.0:
            return False
        if blocked_at_a_glance(begin, end, arm, hand, scene, demands):
            return False
        done = step_free(begin, end, body, outside, wrist, smallest, arm.forearm)
        if free_from(done, begin, end, smallest, arm, hand, scene, demands) < 1.0:
            return False
        body, outside, wrist = ahead, outside_ahead, wrist_ahead
    return True
