"""How long a pick or a place takes: a quadratic model of where the hand comes from and where it goes.

The arm turns about its base, so that a point is a distance from it, a bearing and a height, and a way is above all a
swing, the difference of bearings. What is left depends on how the redundant arm holds its elbow, which the motion
planner chooses from where it is: it averages out over a plan.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import NamedTuple

import numpy as np

from smash.forecast.model import FEATURES, MoveTimes


class Point(NamedTuple):
    """A point of the hand's way: distance from the base [m], bearing [rad], height [m]."""

    radius: float
    bearing: float
    height: float


@dataclass(frozen=True, slots=True)
class TimedMove:
    """A pick or a place that was planned: which, between which points, what it took [s].

    `lying` says whether the block is picked from the table region, `first` whether the arm began at its ready pose.
    """

    kind: str
    origin: Point
    target: Point
    lying: bool
    first: bool
    seconds: float


def features(kind: str, origin: Point, target: Point, lying: bool, first: bool) -> tuple[float, ...]:
    """Return a value for each of `FEATURES`."""
    bases = (*origin, *target, abs(target.bearing - origin.bearing))
    picked, placed = float(kind == "pick"), float(kind == "place")
    return (
        *(picked, placed, float(lying), float(first)),
        *(picked * value for value in bases),
        *(placed * value for value in bases),
        *(one * other for one, other in combinations_with_replacement(bases, 2)),
    )


def seconds(weights: Sequence[float], move: Sequence[float]) -> float:
    """Return the time of a move with these features [s]; never less than none."""
    return max(0.0, sum(weight * value for weight, value in zip(weights, move, strict=True)))


def in_order(weights: Mapping[str, float]) -> tuple[float, ...]:
    """Return weights in the order of `FEATURES`; 0 for one that the model does not have."""
    return tuple(weights.get(name, 0.0) for name in FEATURES)


def fit(moves: Iterable[TimedMove]) -> MoveTimes:
    """Fit the weights by least squares, the shortest of equally good ones.

    Raises:
        ValueError: where there is nothing to fit.
    """
    rows = list(moves)
    if not rows:
        raise ValueError("no move was timed")
    design = np.array([features(row.kind, row.origin, row.target, row.lying, row.first) for row in rows])
    taken = np.array([row.seconds for row in rows])
    solution = np.linalg.lstsq(design, taken, rcond=None)[0]
    left = taken - design @ solution
    spread, all_in_all = float(left.std()), float(taken.std())
    return MoveTimes(
        {name: round(float(weight), 5) for name, weight in zip(FEATURES, solution, strict=True)},
        round(spread, 4),
        round(1.0 - (spread / all_in_all) ** 2, 4) if all_in_all else 1.0,
        len(rows),
    )
