"""Positions for costs of travel: where places are along the arc that the arm's first joint moves the hand on.

The hand goes from place to place by turning about the base, and not through the back. So a place is at (R b, r):
its bearing b from -pi to pi times the arc's radius R, and its distance r from the base; the straight distance between
two places is then the hand's way, not the way through the robot.
"""

from __future__ import annotations

from math import atan2, hypot

from smash.execution.actions.topple import strip
from smash.execution.scene.tabletop import Tabletop
from smash.problem.model import TABLE, Instance

ARC = 0.45
"""Radius at which the way around is measured [m]."""
TOPPLED = 3
"""The table region is taken to be the middles of the strips of topples of so many blocks."""


def unrolled_positions(tabletop: Tabletop, instance: Instance) -> dict[str, tuple[float, float]]:
    """Return where locations, stations and the table region of an instance are on the unrolled table [m].

    Raises:
        DoesNotFit: where the scene has no room for the instance.
    """
    slots = tabletop.bind(instance)
    points = {name: (slot.x, slot.y) for name, slot in (slots | tabletop.bind_stations(instance)).items()}
    places = {name: _unrolled(*point) for name, point in points.items()}
    toppled = [name for name in instance.stacks if slots[name].directions]
    filled = [name for name in toppled if instance.start[name]] or toppled
    middle = strip(TOPPLED).length / 2
    fallen = [_unrolled(*slots[name].point(middle, 0.0, slots[name].directions[0])) for name in filled]
    if fallen:
        places[TABLE] = (sum(x for x, _ in fallen) / len(fallen), sum(y for _, y in fallen) / len(fallen))
    return {name: (round(x, 3), round(y, 3)) for name, (x, y) in places.items()}


def _unrolled(x: float, y: float) -> tuple[float, float]:
    return ARC * atan2(y, x), hypot(x, y)
