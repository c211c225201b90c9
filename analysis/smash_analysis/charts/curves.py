"""Curves over time: coverage, and the quality of the best plan so far; every problem counts at every time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from smash.records.runs import RunRecord
from smash_analysis.charts.panels import Chart, Curve, Panel, curves

if TYPE_CHECKING:
    from matplotlib.axes import Axes

EARLIEST = 0.01
"""Where the time axis begins [s]."""
WIDEST_GAP = 100.0
"""Where the axis of gaps ends [%]."""

Runs = list[RunRecord]


def coverage_curve(records: Runs, times: np.ndarray) -> np.ndarray:
    """Return the share of runs with a plan by each time; times (n,) in seconds, result (n,)."""
    firsts = [trace[0][0] if (trace := record.trace) else np.inf for record in records]
    reached: np.ndarray = np.array(firsts)[:, None] <= times[None, :]
    return reached.mean(axis=0) if len(records) else np.zeros(len(times))


def quality_curve(records: Runs, best: dict[tuple[str, str], int], times: np.ndarray) -> np.ndarray:
    """Return the mean over all runs of best known cost / cost by each time, 0 where there is no plan yet.

    It is the planning competition's satisficing score: defined on the same set of problems at every time, where a
    mean cost would change its subset as more are solved.
    """
    total = np.zeros(len(times))
    for record in records:
        known = best.get((record.instance_hash, record.variant), 0)
        quality = np.zeros(len(times))
        for seconds, cost in record.trace:
            quality[times >= seconds] = known / cost if cost else 1.0
        total += quality
    return total / max(1, len(records))


def best_known(records: Runs) -> dict[tuple[str, str], int]:
    """Return the cost of the best legal plan of any run for each problem (instance hash, variant)."""
    best: dict[tuple[str, str], int] = {}
    for record in records:
        for _, cost in record.trace:
            problem = (record.instance_hash, record.variant)
            best[problem] = min(best.get(problem, cost), cost)
    return best


def coverage_chart(records: Runs) -> Chart:
    """Return coverage over time, a panel per suite and variant, a curve per planner."""
    return _over_time(records, coverage_curve, "problems with a plan [%]")


def anytime_chart(records: Runs) -> Chart:
    """Return the quality of the best plan so far over time, a panel per suite and variant, a curve per planner."""
    best = best_known(records)
    words = "best known cost / cost, mean [%]"
    return _over_time(records, lambda mine, times: quality_curve(mine, best, times), words)


def gap_chart(records: Runs, optima: Mapping[tuple[str, str], int]) -> Chart:
    """Return the share of problems within a gap to the proven optimum, a panel per suite and variant.

    Every problem counts that the planner tried and whose optimum some planner has proven; one without a plan is within
    no gap, so that all planners stand on the same problems.

    Args:
        records: one run a planner and problem.
        optima: proven costs by (instance hash, variant).
    """
    known = [r for r in records if optima.get((r.instance_hash, r.variant), 0) > 0]
    gaps = np.linspace(0.0, WIDEST_GAP, 201)

    def draw(axis: Axes, mine: Runs, curve: Curve) -> None:
        axis.plot(gaps, 100 * gap_curve(mine, optima, gaps / 100), lw=1.7, **curve.style())
        axis.set_xlim(-1, WIDEST_GAP)
        axis.set_ylim(-2, 103)

    return _chart(known, draw, "cost above the proven optimum [%], at most", "problems [%]")


def gap_curve(records: Runs, optima: Mapping[tuple[str, str], int], gaps: np.ndarray) -> np.ndarray:
    """Return the share of runs whose best plan costs at most (1 + gap) times the optimum; gaps (n,), result (n,)."""
    over = []
    for record in records:
        trace = record.trace
        over.append(trace[-1][1] / optima[record.instance_hash, record.variant] - 1 if trace else np.inf)
    within: np.ndarray = np.array(over)[:, None] <= gaps[None, :] + 1e-9
    return within.mean(axis=0) if len(records) else np.zeros(len(gaps))


def _over_time(records: Runs, measure: Callable[[Runs, np.ndarray], np.ndarray], words: str) -> Chart:
    longest: dict[tuple[str, str], float] = {}
    for record in records:
        panel = record.suite, record.variant
        longest[panel] = max(longest.get(panel, 0.0), record.budget)

    def draw(axis: Axes, mine: Runs, curve: Curve) -> None:
        times = np.geomspace(EARLIEST, max(longest[mine[0].suite, mine[0].variant], 2 * EARLIEST), 400)
        axis.step(times, 100 * measure(mine, times), where="post", lw=1.7, **curve.style())
        axis.set_xscale("log")
        axis.set_xlim(EARLIEST, times[-1])
        axis.set_ylim(-2, 103)
        axis.xaxis.set_major_formatter("{x:g}")

    return _chart(records, draw, "time since the call [s]", words)


def _chart(records: Runs, draw: Callable[[Axes, Runs, Curve], None], across: str, upward: str) -> Chart:
    legend = curves(_distinct(records, "label"))

    def panel(suite: str, variant: str) -> Panel:
        part = [r for r in records if r.suite == suite and r.variant == variant]
        sides = [(curve, mine) for curve in legend if (mine := [r for r in part if r.label == curve.name])]

        def fill(axis: Axes) -> None:
            for curve, mine in sides:
                draw(axis, mine, curve)

        words = ", ".join(f"{curve.name}: {sum(bool(run.trace) for run in mine)}/{len(mine)}" for curve, mine in sides)
        return Panel(f"{suite}, {variant}", fill, f"{upward} over {across}; with a plan at the end: {words}")

    variants = _distinct(records, "variant")
    return Chart([[panel(suite, v) for v in variants] for suite in _distinct(records, "suite")], across, upward, legend)


def _distinct(records: Runs, field: str) -> list[str]:
    return list(dict.fromkeys(getattr(record, field) for record in records))
