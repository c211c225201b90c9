"""Why no layout can exist: bounds that hold whatever is searched, and however.

Heights: no pile is higher than the arm reaches at its best distance. Areas: blocks that stand on different slots, and
strips (as far as they are judged), do not overlap, and all of them lie within reach of the arm or stand out of it by
no more than their own width.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

from smash.execution.layout.wanted import Place
from smash.execution.scene.scene_file import LEAST_APART
from smash.motion.robot import Robot


def impossible(places: Sequence[Place], side: float, robot: Robot) -> str | None:
    """Return why no layout has all these places, or None where the bounds do not say so.

    Args:
        places: What is asked for.
        side: Of a block [m].
        robot: Who has to reach them.
    """
    most = int(robot.tallest / side + 1e-9)
    for place in places:
        if place.height > most:
            piled = f"location {place.location!r} has to take {place.height} blocks"
            return f"{piled}, and the arm reaches no higher than {most} anywhere"
    if not most:
        return "the arm reaches no block anywhere"
    nearest, farthest = robot.reach(side)
    return _too_many(places, side, nearest, farthest) or _too_wide(places, side, farthest)


def _too_many(places: Sequence[Place], side: float, nearest: float, farthest: float) -> str | None:
    """Discs around the slots, as wide as two slots are apart at the least, do not overlap."""
    radius = LEAST_APART * side / 2
    inner, outer = nearest - radius, farthest + radius
    room = int((outer**2 - max(inner, 0.0) ** 2) / radius**2)
    if len(places) <= room:
        return None
    return f"{len(places)} places are asked for, and no more than {room} have room within the arm's reach"


def _too_wide(places: Sequence[Place], side: float, farthest: float) -> str | None:
    """Strips overlap neither each other nor the blocks that stand on slots."""
    strips = [_judged(place, side) for place in places if place.falling]
    if not strips:
        return None
    taken = len(places) * pi * side**2 / 4 + sum(length * width for length, width in strips)
    margin = max(width for _, width in strips) / 2
    room = pi * (farthest + margin) ** 2
    if taken <= room:
        return None
    return (
        f"blocks and landing strips take {taken:.2f} m2 of the table, and there are {room:.2f} m2 in reach of the arm"
    )


def _judged(place: Place, side: float) -> tuple[float, float]:
    """Length, beyond the block that stands on the slot, and width of a strip as far as the arm has to reach it [m]."""
    return place.judged.length - side / 2, 2 * place.judged.half_width
