"""Budget x buffer heatmaps like the paper's ablation figure: no-topple beside topple on the same scale."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from smash_analysis.charts.panels import as_it_stands
from smash_analysis.tables.cells import grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

SUCCESS_COLOURS = "cividis"
ACTION_COLOURS = "viridis_r"
RATIO_COLOURS = "YlOrBr"
GAIN_COLOURS = "PuOr"
"""The first three grow evenly in lightness, the last from its middle, so that all kinds of colour vision read them."""


def planner_figure(label: str, suite: str, cells: pd.DataFrame, matched: pd.DataFrame) -> Figure:
    """Draw one planner on one suite: success (top) and mean actions (bottom), each without and with topple.

    Success of 90 % and more is bold. The right column compares the two: percentage points of success gained, and
    the ratio of mean actions over the instances that both variants solved in that cell.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    mpl.rcParams.update({"font.size": 8, "axes.titlesize": 9, "pdf.fonttype": 42, "hatch.linewidth": 0.6})
    without, with_ = (cells[cells["variant"] == variant] for variant in ("no-topple", "topple"))
    rows, columns = sorted(cells["buffers"].unique()), sorted(cells["budget"].unique())

    def whole(part: pd.DataFrame, column: str) -> pd.DataFrame:
        return grid(part, column).reindex(index=rows, columns=columns)

    width, height = max(3.0, 1.9 + 0.40 * len(columns)), 0.95 + 0.24 * len(rows)
    figure = Figure(figsize=(3 * width + 0.3, 2 * height + 0.75))
    figure.set_layout_engine("constrained", w_pad=0.06, h_pad=0.08)
    axes = figure.subplots(2, 3)
    figure.suptitle(as_it_stands(f"{label} on {suite} ({_runs(cells)} a cell)"), fontsize=11, fontweight="bold")

    names = ("without topple", "with topple")
    percent = mpl.colors.Normalize(0, 100)
    for axis, part, name in zip(axes[0], (without, with_), names, strict=False):
        _heatmap(axis, whole(part, "success") * 100, percent, SUCCESS_COLOURS, _percent, empty="not run")
        axis.set_title(as_it_stands(f"Success [%], {name}"))
    gain = (whole(with_, "success") - whole(without, "success")) * 100
    reach = max(10.0, float(np.nanmax(np.abs(gain.to_numpy()), initial=0.0)))
    _heatmap(axes[0][2], gain, mpl.colors.Normalize(-reach, reach), GAIN_COLOURS, _gain, empty="not run")
    axes[0][2].set_title("Success gained by topple [points]")

    costs = cells["mean_cost"].dropna()
    scale = mpl.colors.Normalize(*((costs.min(), max(costs.max(), costs.min() + 1)) if len(costs) else (0, 1)))
    for axis, part, name in zip(axes[1], (without, with_), names, strict=False):
        _heatmap(axis, whole(part, "mean_cost"), scale, ACTION_COLOURS, lambda v: f"{v:.1f}", empty="no plan")
        axis.set_title(as_it_stands(f"Mean actions where solved, {name}"))
    ratios = matched["ratio_common"].dropna()
    scale = mpl.colors.Normalize(min(1.0, ratios.min()), max(2.0, ratios.max())) if len(ratios) else percent
    _heatmap(axes[1][2], whole(matched, "ratio_common"), scale, RATIO_COLOURS, lambda v: f"{v:.2f}", empty="no pair")
    axes[1][2].set_title("Actions without / with topple\n(instances that both solved)")
    for axis in axes.flat:
        axis.set_xlabel("task-planning budget [s]")
    for axis in axes[:, 0]:
        axis.set_ylabel("auxiliary buffers B")
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
    axis: Axes, values: pd.DataFrame, scale: Normalize, colours: str, words: Callable[[float], str], empty: str
) -> None:
    """Draw one annotated heatmap; cells without a value are hatched and say why."""
    import matplotlib as mpl
    from matplotlib.patches import Rectangle

    colormap = mpl.colormaps[colours]
    numbers = np.ma.masked_invalid(values.to_numpy(dtype=float))
    image = axis.imshow(numbers, cmap=colormap, norm=scale, aspect="auto", origin="lower")
    axis.set_xticks(range(values.shape[1]), [f"{budget:g}" for budget in values.columns])
    axis.set_yticks(range(values.shape[0]), [f"{count:g}" for count in values.index])
    axis.set_xticks(np.arange(-0.5, values.shape[1]), minor=True)
    axis.set_yticks(np.arange(-0.5, values.shape[0]), minor=True)
    axis.grid(which="minor", color="white", linewidth=0.8)
    axis.tick_params(which="both", length=0)
    for spine in axis.spines.values():
        spine.set_visible(False)
    for (row, column), value in np.ndenumerate(values.to_numpy(dtype=float)):
        if np.isnan(value):
            box = Rectangle(
                (column - 0.5, row - 0.5), 1, 1, facecolor="#f4f4f4", edgecolor="#b8b8b8", hatch="////", lw=0
            )
            axis.add_patch(box)
            axis.text(column, row, empty, ha="center", va="center", fontsize=5, color="#555555", bbox=_PAPER)
        else:
            colour = ink(*colormap(scale(value))[:3])
            axis.text(column, row, words(value), ha="center", va="center", fontsize=7, color=colour)
    axis.figure.colorbar(image, ax=axis, fraction=0.05, pad=0.02).outline.set_visible(False)


_PAPER = {"facecolor": "#f4f4f4", "edgecolor": "none", "pad": 0.6}


def ink(red: float, green: float, blue: float) -> str:
    """Return black or white, whichever has more contrast (WCAG 2) on a colour of parts from 0 to 1: at least 4.58."""
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in (red, green, blue)]
    luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    return "black" if (luminance + 0.05) ** 2 > 1.05 * 0.05 else "white"
