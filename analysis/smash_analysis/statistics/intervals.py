"""Statistics that are fair to subsets: intervals, and comparisons of two sides on what both of them solved.

A mean over the problems that one planner solved and a mean over those that another solved are means over different
problems. Everything that compares two sides here is therefore paired, and carries its coverage with it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import nan, sqrt
from typing import Any

import numpy as np
import pandas as pd

FEWEST_UNITS = 8
"""Below so many units a percentile bootstrap covers far less than 95 %: their range is given instead, and called so."""
RESAMPLES = 5000
"""Draws of a bootstrap: the interval's ends then move by less than the digits that are shown."""

Values = np.ndarray[Any, np.dtype[np.float64]]


def wilson(successes: float, trials: int, z: float = 1.96) -> tuple[float, float]:
    """Return the Wilson score interval of a proportion (95 % for the default z); (0, 1) without a trial.

    Args:
        successes: a sum of shares where a trial may succeed in part (`success_rate`).
        trials: how many there are.
        z: quantile of the normal distribution.
    """
    if trials == 0:
        return 0.0, 1.0
    share = successes / trials
    middle = (share + z * z / (2 * trials)) / (1 + z * z / trials)
    half = z * sqrt(share * (1 - share) / trials + z * z / (4 * trials * trials)) / (1 + z * z / trials)
    return max(0.0, middle - half), min(1.0, middle + half)


@dataclass(frozen=True, slots=True)
class Rate:
    """A share of successes whose trials belong to units (seeds of one instance) and are not independent in them.

    Attributes:
        mean: Mean over the units of each unit's own share of successes; nan without a unit.
        units: How many there are; `trials` likewise.
    """

    mean: float
    units: int
    trials: int

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % Wilson interval with the units as trials: conservative, as more seeds of a unit do not narrow it."""
        return wilson(self.mean * self.units if self.units else 0.0, self.units)


def success_rate(trials: pd.DataFrame, success: str, unit: Sequence[str] = ("instance",)) -> Rate:
    """Return the rate of `trials`, one row a trial.

    Args:
        trials: what was tried, with the columns of `unit`.
        success: column that says what succeeded (bool).
        unit: columns that name what is independent.
    """
    each = trials.groupby(list(unit))[success].mean()
    return Rate(float(each.mean()) if len(each) else nan, len(each), len(trials))


def bootstrap(values: Values, seed: int = 0) -> tuple[float, float]:
    """Return the 95 % percentile bootstrap interval of the mean of `values` (n,); (nan, nan) without a value.

    Below `FEWEST_UNITS` values it is their range.
    """
    return _interval(len(values), lambda drawn: values[drawn].mean(axis=1), seed)


def bootstrap_ratio(above: Values, below: Values, seed: int = 0) -> tuple[float, float]:
    """Return the 95 % interval of sum(above) / sum(below), pairs (n,) and (n,) drawn together.

    Below `FEWEST_UNITS` pairs it is the range of their ratios.
    """
    return _interval(len(above), lambda drawn: above[drawn].sum(axis=1) / below[drawn].sum(axis=1), seed)


def is_range(units: int) -> bool:
    """Return whether what `bootstrap` gives for so many units is their range, not an interval of the mean."""
    return units < FEWEST_UNITS


def _interval(count: int, statistic: Callable[[np.ndarray[Any, Any]], Values], seed: int) -> tuple[float, float]:
    if count == 0:
        return nan, nan
    if is_range(count):
        each = statistic(np.arange(count)[:, None])
        return float(each.min()), float(each.max())
    drawn = np.random.default_rng(seed).integers(0, count, (RESAMPLES, count))
    low, high = np.percentile(statistic(drawn), [2.5, 97.5])
    return float(low), float(high)


@dataclass(frozen=True, slots=True)
class Paired:
    """Two sides, `left` and `right`, on the same problems.

    Attributes:
        left_rate: What the left side solved of the problems that both tried; `right_rate` likewise.
        units: What the figures below count: instances on which both sides solved something in common.
        differences: left - right, one a unit (n,): the mean over the unit's common problems (seeds, say).
        left_mean: Mean of the left side over the units; `right_mean` likewise: the same problems on both sides.
        interval: 95 % bootstrap interval of the mean difference, units drawn; of few units the range (`is_range`).
        ratio: left_mean / right_mean, nan where right_mean is 0.
        ratio_interval: its 95 % bootstrap interval, of few units the range of their ratios; nan where a unit of the
            right side is 0.
    """

    left_rate: Rate
    right_rate: Rate
    differences: Values
    left_mean: float
    right_mean: float
    interval: tuple[float, float]
    ratio: float
    ratio_interval: tuple[float, float]

    @property
    def problems(self) -> int:
        """The number of problems that both sides tried."""
        return self.left_rate.trials

    @property
    def units(self) -> int:
        """The number of differences."""
        return len(self.differences)

    @property
    def mean(self) -> float:
        """Mean difference; nan without a common unit."""
        return float(self.differences.mean()) if self.units else nan

    @property
    def tally(self) -> tuple[int, int, int]:
        """Units in which the left side is greater, equal, smaller."""
        return int((self.differences > 0).sum()), int((self.differences == 0).sum()), int((self.differences < 0).sum())


def paired(left: pd.DataFrame, right: pd.DataFrame, problem: Sequence[str], unit: Sequence[str], value: str) -> Paired:
    """Compare two sides on the problems that both solved.

    Args:
        left: one row a problem, with the columns of `problem`, `solved` (bool) and `value`.
        right: likewise.
        problem: columns that name a problem; only those in both tables count.
        unit: those of them that name what is drawn by the bootstrap (the instance): seeds of one instance are no
            independent evidence.
        value: column that is compared where both are solved.
    """
    pairs = left.merge(right, on=list(problem), suffixes=("_left", "_right"))
    both = pairs[pairs["solved_left"] & pairs["solved_right"]]
    columns = [f"{value}_left", f"{value}_right"]
    each = both.groupby(list(unit))[columns].mean().to_numpy(dtype=float).reshape(-1, 2)
    first, second = each[:, 0], each[:, 1]
    return Paired(
        left_rate=success_rate(pairs, "solved_left", unit),
        right_rate=success_rate(pairs, "solved_right", unit),
        differences=first - second,
        left_mean=float(first.mean()) if len(each) else nan,
        right_mean=float(second.mean()) if len(each) else nan,
        interval=bootstrap(first - second),
        ratio=float(first.sum() / second.sum()) if second.sum() > 0 else nan,
        ratio_interval=bootstrap_ratio(first, second) if (second > 0).all() else (nan, nan),
    )
