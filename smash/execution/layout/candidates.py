"""Where a place may be: slots on a polar grid around the arm, with the strip of each topple direction."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import atan2, hypot, radians

import numpy as np
from numpy.typing import NDArray

from smash.execution.actions.topple import RUN_UP, SWEEP
from smash.execution.layout.conditions import STRIP_SAMPLES
from smash.execution.layout.rectangles import Floats, Mask, Rectangles
from smash.execution.layout.wanted import Place
from smash.execution.scene.tabletop import DIRECTIONS, Slot
from smash.motion.robot import Robot

STEP = 0.02
"""Between distances of slots from the base [m]."""
INSIDE, OUTSIDE = 0.04, 0.08
"""Slots keep so far from the inner and the outer edge of the ring in which the arm works at ease [m]."""
ANGLES = tuple(range(-165, 166, 3))
"""Bearings of slots [degrees]: the first joint does not turn through the back."""
MOST_BEARING = radians(172.0)
"""Blocks in a strip are picked no farther around [rad]."""


@dataclass(frozen=True, slots=True)
class Spacing:
    """How far things are apart.

    Attributes:
        apart: Middles of two slots, in sides of a block.
        beside: A slot's middle from a strip, and from the hand's way along a push [m].
        pushes: Whether a push also keeps clear of where other blocks may lie.
    """

    apart: float
    beside: float
    pushes: bool


SPACINGS = (Spacing(3.3, 0.085, True), Spacing(2.2, 0.042, True), Spacing(2.2, 0.042, False))
"""The roomy one first: the hand passes between all piles, and what happens at a slot is none of a strip's business.

The others leave the hand, half open, room between two piles, and half of a block's diagonal and 1 cm beside a strip.
In the last one blocks may lie in a push's way: the executor shoves or clears them.
"""


@dataclass(frozen=True, eq=False)
class Candidates:
    """N ways to place one kind of place.

    Attributes:
        slots: The slots, length N.
        middles: Of the slots [m], shape (N, 2).
        strips: What toppled blocks may lie in; None where none are toppled.
        ways: What the hand passes in a push, from the run-up to its end; None likewise.
    """

    slots: tuple[Slot, ...]
    middles: Floats
    strips: Rectangles | None
    ways: Rectangles | None

    def some(self, which: NDArray[np.int64]) -> Candidates:
        """Those of these numbers, shape (K,)."""
        strips = None if self.strips is None else self.strips[which]
        ways = None if self.ways is None else self.ways[which]
        return Candidates(tuple(self.slots[index] for index in which), self.middles[which], strips, ways)

    def only(self, which: int) -> Candidates:
        """One of them."""
        return self.some(np.array([which]))

    def beside(self, other: Candidates, side: float, spacing: Spacing) -> Mask:
        """Which of them can stand together with the only one of `other`, shape (N,).

        Args:
            other: What stands already.
            side: Of a block [m].
            spacing: How far apart.
        """
        there = other.middles[0]
        bad = np.linalg.norm(self.middles - there, axis=1) < spacing.apart * side
        for own in filter(None, (self.strips, self.ways)):
            bad |= own.hold(there, spacing.beside)
        for its in filter(None, (other.strips, other.ways)):
            bad |= its.hold(self.middles, spacing.beside)
        if self.strips is not None and other.strips is not None:
            bad |= self.strips.meet(other.strips)
            if spacing.pushes and self.ways is not None and other.ways is not None:
                bad |= self.strips.meet(other.ways) | self.ways.meet(other.strips)
        return np.asarray(~bad)


def candidates(place: Place, side: float, robot: Robot) -> Candidates:
    """All candidates of a place: those whose pile, and whose strip, the arm reaches.

    Args:
        place: What is asked for; its name does not matter.
        side: Of a block [m].
        robot: Who has to reach it.
    """
    return _of(list(_slots(place, side, robot)), place, side, robot)


def ring(robot: Robot) -> tuple[float, float]:
    """Between which distances from the base the arm works at ease [m]: where it reaches half of its greatest height."""
    return robot.reach(robot.tallest / 2)


def _slots(place: Place, side: float, robot: Robot) -> Iterator[Slot]:
    near, far = ring(robot)
    for radius in map(float, np.arange(near + INSIDE, far - OUTSIDE + 1e-9, STEP).round(3)):
        if robot.highest(radius) < place.height * side - 1e-9:
            continue
        ahead = {way: Slot(radius, 0.0, (way,), falling=place.falling) for way in DIRECTIONS}
        reached = {way: _bearings(place, slot, side, near, far) for way, slot in ahead.items()}
        for angle in map(radians, ANGLES):
            if not place.falling:
                yield Slot(radius, angle, highest=place.height)
                continue
            for direction, bearings in reached.items():
                if bearings and max(abs(angle + bearings[0]), abs(angle + bearings[1])) <= MOST_BEARING:
                    yield Slot(radius, angle, (direction,), place.height, place.falling)


def _bearings(place: Place, slot: Slot, side: float, near: float, far: float) -> tuple[float, float] | None:
    """Least and greatest bearing in the strip of a slot straight ahead [rad], as far as strips are judged.

    None where there is no strip, or where not all of it is between two distances from the base [m].
    """
    if not place.falling:
        return None
    aside = place.strip.half_width - side / 2
    places = [
        slot.point(float(along), sign * aside, slot.directions[0])
        for along in np.linspace(side, place.judged.length, STRIP_SAMPLES)
        for sign in (-1.0, 0.0, 1.0)
    ]
    if not all(near <= hypot(x, y) <= far for x, y in places):
        return None
    bearings = [atan2(y, x) for x, y in places]
    return min(bearings), max(bearings)


def _of(slots: list[Slot], place: Place, side: float, robot: Robot) -> Candidates:
    middles = np.array([(slot.x, slot.y) for slot in slots]).reshape(-1, 2)
    if not place.falling:
        return Candidates(tuple(slots), middles, None, None)
    heading = np.array([slot.heading(slot.directions[0]) for slot in slots])
    axes = np.stack([np.cos(heading), np.sin(heading)], axis=1).reshape(-1, 2)
    room, palm = place.strip, np.abs(robot.hand.palm).max(axis=0)
    begin = -(RUN_UP + side / 2 + 2 * robot.hand.palm_thickness)
    end = (SWEEP.follow_through - 0.5) * side
    strips = _along(middles, axes, side / 2, room.length, room.half_width)
    return Candidates(tuple(slots), middles, strips, _along(middles, axes, begin, end, palm[1]))


def _along(middles: Floats, axes: Floats, begin: float, end: float, half_width: float) -> Rectangles:
    return Rectangles(middles + (begin + end) / 2 * axes, axes, np.array([(end - begin) / 2, half_width]))
