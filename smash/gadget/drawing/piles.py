"""An instance's start and goal, as piles of blocks on a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from smash.gadget.drawing.style import new_figure
from smash.problem.model import Instance, idle_remark, shown_goal, shown_locations
from smash.problem.pictures import GREY, INK, PALE_PINK, PINK, block_colours, ink_on, short

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PITCH = 1.35
"""Distance between neighbouring locations, in blocks."""
SCALE = 0.36
"""Inches per block."""


def instance_figure(instance: Instance) -> Figure:
    """Return a figure of start and goal side by side.

    Raises:
        MissingExtra: where matplotlib is not installed.
    """
    goal, locations, note = shown_goal(instance)
    tall = max([1, *map(len, instance.start.values()), *map(len, goal.values())])
    start = dict(instance.start)
    shown = shown_locations(instance)
    if instance.hand is not None:
        shown += ("hand",)
        start["hand"] = (*instance.start.get("hand", ()), instance.hand)
    widths = [PITCH * max(5, len(shown)), PITCH * max(5, len(locations))]
    table_rows = -(-len(instance.table) // int((widths[0] - 0.2) / 1.15))
    low = -1.1 - (1.3 + 1.15 * table_rows if instance.table else 0.0)
    high = tall + 1.3
    gap = 1.2
    figure = new_figure(SCALE * (sum(widths) + gap), SCALE * (high - low))
    axes = figure.add_axes((0, 0, 1, 1))
    colours = block_colours(instance.blocks)
    paint_piles(axes, shown, start, colours, 0.0)
    paint_piles(axes, locations, goal, colours, widths[0] + gap)
    if instance.table:
        _paint_table(axes, instance.table, colours, widths[0], low)
    for x, title in ((0.0, f"start{idle_remark(instance)}"), (widths[0] + gap, f"goal{note}")):
        axes.text(x, high - 0.1, title, fontsize=9, color=INK, va="top", ha="left")
    axes.set_xlim(-0.1, sum(widths) + gap + 0.1)
    axes.set_ylim(low, high)
    axes.set_aspect("equal")
    axes.axis("off")
    return figure


def paint_piles(
    axes: Axes, locations: Sequence[str], piles: Mapping[str, Sequence[str]], colours: Mapping[str, str], left: float
) -> None:
    """Draw piles over their locations' names, the first one at x = `left`."""
    for number, location in enumerate(locations):
        x = left + PITCH * number
        axes.plot([x, x + 1.05], [0, 0], color=GREY, linewidth=2.0, solid_capstyle="round")
        axes.text(x + 0.525, -0.25, short(location, 7), ha="center", va="top", fontsize=8, color=INK, parse_math=False)
        for height, block in enumerate(piles.get(location, ())):
            paint_block(axes, block, colours[block], x + 0.525, height + 0.52)


def paint_block(axes: Axes, block: str, colour: str, x: float, y: float) -> None:
    """Draw one block with its name, centred at (x, y)."""
    from matplotlib.patches import FancyBboxPatch

    shape = "round,pad=0,rounding_size=0.12"
    axes.add_patch(
        FancyBboxPatch((x - 0.47, y - 0.47), 0.94, 0.94, boxstyle=shape, facecolor=colour, edgecolor="white")
    )
    axes.text(x, y, short(block), ha="center", va="center", fontsize=8, color=ink_on(colour), parse_math=False)


def _paint_table(axes: Axes, table: Sequence[str], colours: Mapping[str, str], width: float, low: float) -> None:
    from matplotlib.patches import FancyBboxPatch

    top = -1.35
    shape = "round,pad=0,rounding_size=0.2"
    box = FancyBboxPatch((0, low + 0.05), width, top - low, boxstyle=shape, facecolor=PALE_PINK, edgecolor=PINK)
    axes.add_patch(box)
    axes.text(0.25, top - 0.1, "table region", fontsize=8, color=PINK, va="top", ha="left")
    a_row = max(1, int((width - 0.2) / 1.15))
    for number, block in enumerate(table):
        row, column = divmod(number, a_row)
        paint_block(axes, block, colours[block], 0.7 + 1.15 * column, top - 1.15 - 1.15 * row)
