"""Curves over time: coverage, and the quality of the best plan so far; every problem counts at every time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.records import legal_trace

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8C8C00")
DASHES = ("-", "--", "-.", ":")
"""Okabe and Ito's colours for every kind of colour vision; line styles tell curves apart in grey."""
EARLIEST = 0.01
"""Where the time axis begins [s]."""

Record = dict[str, Any]


def coverage_curve(records: list[Record], times: np.ndarray) -> np.ndarray:
    """Return the share of runs with a plan by each time; times (n,) in seconds, result (n,)."""
    firsts = [trace[0][0] if (trace := legal_trace(record)) else np.inf for record in records]
    reached: np.ndarray = np.array(firsts)[:, None] <= times[None, :]
    return reached.mean(axis=0) if len(records) else np.zeros(len(times))


def quality_curve(records: list[Record], best: dict[tuple[str, str], int], times: np.ndarray) -> np.ndarray:
    """Return the mean over all runs of best known cost / cost by each time, 0 where there is no plan yet.

    It is the planning competition's satisficing score: defined on the same set of problems at every time, where a
    mean cost would change its subset as more are solved.
    """
    total = np.zeros(len(times))
    for record in records:
        known = best.get((record["instance_hash"], record["variant"]), 0)
        quality = np.zeros(len(times))
        for seconds, cost in legal_trace(record):
            quality[times >= seconds] = known / cost if cost else 1.0
        total += quality
    return total / max(1, len(records))


def best_known(records: list[Record]) -> dict[tuple[str, str], int]:
    """Return the cost of the best legal plan of any run for each problem (instance hash, variant)."""
    best: dict[tuple[str, str], int] = {}
    for record in records:
        for _, cost in legal_trace(record):
            problem = (record["instance_hash"], record["variant"])
            best[problem] = min(best.get(problem, cost), cost)
    return best


def coverage_figure(records: list[Record]) -> Figure:
    """Draw coverage over time, a panel per suite and variant, a curve per planner."""

    def draw(axis: Axes, mine: list[Record], times: np.ndarray, style: dict[str, Any]) -> None:
        axis.step(times, 100 * coverage_curve(mine, times), where="post", **style)

    return _panels(records, draw, "problems with a plan [%]")


def anytime_figure(records: list[Record]) -> Figure:
    """Draw the quality of the best plan so far over time, a panel per suite and variant, a curve per planner."""
    best = best_known(records)

    def draw(axis: Axes, mine: list[Record], times: np.ndarray, style: dict[str, Any]) -> None:
        axis.step(times, 100 * quality_curve(mine, best, times), where="post", **style)

    return _panels(records, draw, "quality [%]: best known cost / cost,\n0 without a plan, mean over all problems")


def _panels(records: list[Record], draw: Any, words: str) -> Figure:
    import matplotlib as mpl
    from matplotlib.figure import Figure

    mpl.rcParams.update({"font.size": 8, "axes.titlesize": 9, "pdf.fonttype": 42})
    suites, variants = _distinct(records, "suite"), _distinct(records, "variant")
    labels = _distinct(records, "label")
    styles = {
        label: {
            "color": COLOURS[i % len(COLOURS)],
            "linestyle": DASHES[(i + i // len(COLOURS)) % len(DASHES)],
            "lw": 1.7,
        }
        for i, label in enumerate(labels)
    }
    figure = Figure(figsize=(3.4 * len(variants) + 1.6, 2.5 * len(suites) + 0.5), layout="constrained")
    axes = figure.subplots(len(suites), len(variants), squeeze=False, sharey=True)
    for row, suite in enumerate(suites):
        for column, variant in enumerate(variants):
            axis = axes[row][column]
            part = [r for r in records if r["suite"] == suite and r["variant"] == variant]
            times = np.geomspace(EARLIEST, max([r["budget"] for r in part], default=1.0), 400)
            for label, mine in _by_label(part, labels):
                draw(axis, mine, times, {**styles[label], "label": label})
            axis.set_xscale("log")
            axis.set_xlim(EARLIEST, times[-1])
            axis.set_ylim(-2, 103)
            axis.xaxis.set_major_formatter("{x:g}")
            axis.set_title(f"{suite}, {variant}")
            axis.grid(color="#dddddd", linewidth=0.6)
            axis.spines[["top", "right"]].set_visible(False)
    for axis in axes[-1]:
        axis.set_xlabel("time since the call [s]")
    for row in range(len(suites)):
        axes[row][0].set_ylabel(words)
    lines = {line.get_label(): line for axis in axes.flat for line in axis.get_lines()}
    figure.legend(lines.values(), lines.keys(), loc="outside right upper", frameon=False)
    return figure


def _distinct(records: list[Record], field: str) -> list[str]:
    return list(dict.fromkeys(record[field] for record in records))


def _by_label(records: list[Record], labels: list[str]) -> Iterator[tuple[str, list[Record]]]:
    for label in labels:
        mine = [record for record in records if record["label"] == label]
        if mine:
            yield label, mine
