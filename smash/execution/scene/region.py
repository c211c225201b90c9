"""The table region: where a block may lie that stands at no location."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from itertools import product
from math import hypot

import numpy as np

from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.geometry import Geometry
from smash.execution.scene.tabletop import Tabletop

REGION_LENGTH = (0.09, 0.30)
"""Blocks are put into the table region so far along a stack's topple direction [m], ..."""
REGION_HALF_WIDTH = 0.05
"""... so far aside of it, ..."""
REGION_APART = 2.0
"""... and so many sides of the widest block apart from each other, and from locations."""
STEPS = 8
"""Places that are looked at along a strip; three aside."""
COVERS = 0.5
"""A block lies on another where its middle is higher by this share of the other's height, or more, ..."""
NEAR = 1.2
"""... and no further away, seen from above, than so many times half the sum of their sides."""


def free_places(tabletop: Tabletop, where: Geometry, block: str) -> list[tuple[float, float]]:
    """Places in the landing strips that are apart from all locations and from other blocks, the nearest first [m].

    Args:
        tabletop: The scene.
        where: All that is known of where things are.
        block: What is to lie there.
    """
    pose = where.blocks[block]
    taken = [
        (float(other.position[0]), float(other.position[1])) for name, other in where.blocks.items() if name != block
    ]
    taken += [(slot.x, slot.y) for slot in tabletop.slots]
    taken += [(float(carrier.position[0]), float(carrier.position[1])) for carrier in where.carriers.values()]
    along = np.linspace(*REGION_LENGTH, STEPS)
    aside = (0.0, -REGION_HALF_WIDTH, REGION_HALF_WIDTH)
    places = [
        slot.point(float(a), b, direction)
        for slot in tabletop.stacks
        for direction in slot.directions[:1]
        for a, b in product(along, aside)
    ]
    apart = REGION_APART * tabletop.widest
    free = [(x, y) for x, y in places if all(hypot(x - ox, y - oy) > apart for ox, oy in taken)]
    return sorted(free, key=lambda place: pose.distance(*place))


def covering(block: str, loose: Collection[str], poses: Mapping[str, BlockPose], tabletop: Tabletop) -> list[str]:
    """Loose blocks that lie on a block, or on one that does, the highest first.

    Args:
        block: Its name.
        loose: Blocks that stand at no location.
        poses: Of all blocks.
        tabletop: The scene, which has their sizes.
    """
    found: list[str] = []
    under = [block]
    while under:
        below = under.pop()
        low, size = poses[below], tabletop.size(below)
        for name in loose:
            pose = poses[name]
            higher = float(pose.position[2] - low.position[2])
            near = NEAR * (max(size.extents(low)[:2]) + max(tabletop.size(name).extents(pose)[:2])) / 2
            over = pose.distance(float(low.position[0]), float(low.position[1])) < near
            if name not in found and name != block and higher > COVERS * size.upright(low) and over:
                found.append(name)
                under.append(name)
    return sorted(found, key=lambda name: -float(poses[name].position[2]))
