"""Budget x buffer heatmaps like the paper's ablation figure: no-topple beside topple on the same scale."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from math import log
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from smash_analysis.charts.panels import as_it_stands
from smash_analysis.statistics.intervals import FEWEST_UNITS
from smash_analysis.tables.cells import grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

SUCCESS_COLOURS = "cividis"
ACTION_COLOURS = "viridis_r"
GAIN_COLOURS = "PuOr"
"""The first two grow evenly in lightness, the last from its middle, so that all kinds of colour vision read them.

The last serves what topple gains and what it saves alike: violet where topple is ahead, white where it is even.
"""
FULL, COLUMN = 7.0, 3.4
"""Width of a figure over both columns of a paper, and over one [in]."""
WIDE_CELLS = 7
"""Budgets up to which a cell has room for words of full size."""


def ratio_place(value: float, reach: float) -> float:
    """Return where a ratio stands between 1/`reach` (0) and `reach` (1): 1 is the middle, 2 as far from it as 1/2."""
    return 0.5 + 0.5 * log(value) / log(reach)


def ratio_reach(ratios: Iterable[float]) -> float:
    """Return how far a scale of ratios reaches on both sides of 1: at least to 1.5."""
    return max([1.5, *(max(ratio, 1 / ratio) for ratio in ratios if ratio > 0)])


def planner_figure(
    label: str, suite: str, cells: pd.DataFrame, matched: pd.DataFrame, *, narrow: bool = False
) -> Figure:
    """Draw one planner on one suite: success and mean actions, each without and with topple.

    Success of 90 % and more is bold. Two more heatmaps compare: percentage points of success gained, and the ratio of
    mean actions over the instances that both variants solved in that cell; both are white where topple is even with no
    topple. A cell that stands for fewer than 8 instances is hatched and says how many.

    Args:
        label: the planner.
        suite: the set.
        cells: its `variant_cells`.
        matched: its `matched_cells`.
        narrow: two heatmaps side by side, as wide as a column of a paper; else three, as wide as both.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    mpl.rcParams.update({"font.size": 7, "axes.titlesize": 7.5, "pdf.fonttype": 42, "hatch.linewidth": 0.5})
    without, with_ = (cells[cells["variant"] == variant] for variant in ("no-topple", "topple"))
    rows, columns = sorted(cells["buffers"].unique()), sorted(cells["budget"].unique())

    def whole(part: pd.DataFrame, column: str) -> pd.DataFrame:
        return grid(part, column).reindex(index=rows, columns=columns)

    height = 0.62 + 0.21 * len(rows)
    figure = Figure(figsize=(COLUMN, 3 * height + 0.3) if narrow else (FULL, 2 * height + 0.3))
    figure.set_layout_engine("constrained", w_pad=0.03, h_pad=0.04)
    axes = figure.subplots(*((3, 2) if narrow else (2, 3)), sharey=True)
    success, actions = (axes[0], axes[1]) if narrow else (axes[0][:2], axes[1][:2])
    gained, saved = axes[2] if narrow else (axes[0][2], axes[1][2])
    title = f"{label} on {suite} ({_runs(cells)} a cell)"
    figure.suptitle(as_it_stands(title), fontsize=8, fontweight="bold")

    names = ("without topple", "with topple")
    percent = mpl.colors.Normalize(0, 100)
    for axis, part, name in zip(success, (without, with_), names, strict=True):
        values = whole(part, "success") * 100
        _heatmap(axis, values, percent, SUCCESS_COLOURS, _percent, "not\nrun", whole(part, "runs"))
        axis.set_title(as_it_stands(f"success [%], {name}"))
    gain = (whole(with_, "success") - whole(without, "success")) * 100
    _heatmap(gained, gain, mpl.colors.Normalize(-100, 100), GAIN_COLOURS, _gain, "not\nrun", whole(matched, "runs"))
    gained.set_title("success gained [points]")

    costs = cells["mean_cost"].dropna()
    scale = mpl.colors.Normalize(*((costs.min(), max(costs.max(), costs.min() + 1)) if len(costs) else (0, 1)))
    for axis, part, name in zip(actions, (without, with_), names, strict=True):
        values = whole(part, "mean_cost")
        _heatmap(axis, values, scale, ACTION_COLOURS, lambda v: f"{v:.1f}", "no\nplan", whole(part, "solved"))
        axis.set_title(as_it_stands(f"mean actions, {name}"))
    ratios = whole(matched, "ratio_common")
    reach = ratio_reach(matched["ratio_common"].dropna())
    around = mpl.colors.FuncNorm((np.log, np.exp), 1 / reach, reach)
    _heatmap(saved, ratios, around, GAIN_COLOURS, lambda v: f"{v:.2f}", "no\npair", whole(matched, "common"))
    saved.set_title("actions without / with")
    for axis in axes[-1]:
        axis.set_xlabel("budget [s]")
    for axis in axes[:, 0]:
        axis.set_ylabel("buffers B")
    return figure


def _runs(cells: pd.DataFrame) -> str:
    fewest, most = cells["runs"].min(), cells["runs"].max()
    if most == 1:
        return "1 run"
    return f"{most} runs" if fewest == most else f"{fewest} to {most} runs"


def _percent(value: float) -> str:
    """Return a success rate, marked where it reaches the paper's 90 %."""
    return f"$\\bf{{{value:.0f}}}$" if value >= 90 else f"{value:.0f}"


def _gain(value: float) -> str:
    return f"{value:+.0f}" if round(value) else "0"


def _heatmap(
    axis: Axes,
    values: pd.DataFrame,
    scale: Normalize,
    colours: str,
    words: Callable[[float], str],
    empty: str,
    counts: pd.DataFrame,
) -> None:
    """Draw one annotated heatmap; cells without a value are grey and say why, those of few instances are hatched."""
    import matplotlib as mpl
    from matplotlib.patches import Rectangle

    colormap = mpl.colormaps[colours]
    numbers = np.ma.masked_invalid(values.to_numpy(dtype=float))
    axis.imshow(numbers, cmap=colormap, norm=scale, aspect="auto", origin="lower")
    axis.set_xticks(range(values.shape[1]), [f"{budget:g}" for budget in values.columns])
    axis.set_yticks(range(values.shape[0]), [f"{count:g}" for count in values.index])
    axis.set_xticks(np.arange(-0.5, values.shape[1]), minor=True)
    axis.set_yticks(np.arange(-0.5, values.shape[0]), minor=True)
    axis.grid(which="minor", color="white", linewidth=0.8)
    axis.tick_params(which="both", length=0)
    for spine in axis.spines.values():
        spine.set_visible(False)
    known = counts.to_numpy(dtype=float)
    for (row, column), value in np.ndenumerate(values.to_numpy(dtype=float)):
        count = known[row, column]
        few = not np.isnan(value) and count < FEWEST_UNITS
        if np.isnan(value):
            axis.add_patch(Rectangle((column - 0.5, row - 0.5), 1, 1, facecolor="#ececec", lw=0))
            size = 5.5 if values.shape[1] <= WIDE_CELLS else 4.5
            axis.text(column, row, empty, ha="center", va="center", fontsize=size, color="#444444", linespacing=0.9)
            continue
        paint = colormap(scale(value))
        if few:
            at = (column - 0.5, row - 0.5)
            pale = (1.0, 1.0, 1.0, 0.55)
            axis.add_patch(Rectangle(at, 1, 1, facecolor="none", edgecolor=pale, hatch="//////", linewidth=0))
        text = f"{words(value)}\nn={count:.0f}" if few else words(value)
        box = {"facecolor": paint, "edgecolor": "none", "pad": 0.4} if few else None
        size = (5.5 if few else 6.5) if values.shape[1] <= WIDE_CELLS else 5.0
        colour = ink(*paint[:3])
        axis.text(column, row, text, ha="center", va="center", fontsize=size, color=colour, bbox=box, linespacing=0.95)


def ink(red: float, green: float, blue: float) -> str:
    """Return black or white, whichever has more contrast (WCAG 2) on a colour of parts from 0 to 1: at least 4.58."""
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in (red, green, blue)]
    luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return "black" if (luminance + 0.05) ** 2 > 1.05 * 0.05 else "white"
