"""The gadget figure, after the paper's (pink: what takes part in a topple), for any number of locations."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from smash.gadget.drawing.layout import Layout, arc_height, lay_out
from smash.gadget.drawing.style import (
    GREY,
    INK,
    PALE,
    PALE_PINK,
    PINK,
    RADIUS,
    check_suffix,
    new_figure,
    save,
    short,
)
from smash.gadget.graph import EdgeKind, Gadget, NodeKind

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SCALE = 0.42
"""Inches per height."""


def draw_gadget(gadget: Gadget, path: Path) -> None:
    """Draw a gadget with its legend to a PNG, PDF or SVG file.

    Raises:
        SmashError: where the suffix is none of these or the file cannot be written.
    """
    check_suffix(path)
    layout = lay_out(gadget)
    low, high = vertical_extent(gadget, layout)
    legend = _legend(gadget)
    width = layout.right - layout.left + 3.0
    figure = new_figure(max(SCALE * width, 5.6), SCALE * (high - low) + 0.2 * len(legend) + 0.1)
    share = SCALE * (high - low) / (SCALE * (high - low) + 0.2 * len(legend) + 0.1)
    axes = figure.add_axes((0.0, 1 - share, 1.0, share))
    paint_gadget(axes, gadget, layout)
    frame(axes, gadget, layout)
    _paint_legend(figure.add_axes((0.0, 0.0, 1.0, 1 - share)), legend)
    save(figure, path)


def vertical_extent(gadget: Gadget, layout: Layout) -> tuple[float, float]:
    """Return the lowest and the highest y that the drawing uses."""
    low = layout.bar[2] - 0.65 if layout.bar else 1.0 - max(1, gadget.height) - 1.15
    return low, layout.bus + 0.3 if layout.interface is not None else layout.crest + 0.2


def frame(axes: Axes, gadget: Gadget, layout: Layout) -> None:
    """Fit the axes to the drawing, one unit as long as the other, without spines."""
    low, high = vertical_extent(gadget, layout)
    right = max(layout.right + 1.2, layout.bar[1] + 0.2 if layout.bar else 0.0)
    left = min(layout.left - 0.7, layout.bar[0] - 0.2 if layout.bar else 0.0)
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    axes.set_aspect("equal")
    axes.axis("off")


def paint_gadget(axes: Axes, gadget: Gadget, layout: Layout, *, faint: bool = False) -> None:
    """Draw edges, then nodes, then the locations' names; `faint` draws it as the ground of a motion."""
    edges, alpha = (0.45, 0.45) if faint else (1.0, 1.0)
    _paint_transfers(axes, gadget, layout, 0.8 * edges, alpha)
    _paint_chains(axes, gadget, layout, alpha)
    if layout.bar is not None:
        _paint_topples(axes, gadget, layout, alpha)
        _paint_table(axes, gadget, layout, alpha)
    _paint_nodes(axes, gadget, layout, label=not faint)
    bottom = 1.0 - max(gadget.height, 1)
    for location, x in layout.columns.items():
        axes.text(x, bottom - 0.5, short(location, 9), ha="center", va="top", fontsize=9, color=INK, parse_math=False)


def _arrow(axes: Axes, tail: tuple[float, float], head: tuple[float, float], **look: Any) -> None:
    from matplotlib.patches import FancyArrowPatch

    defaults: dict[str, Any] = {"mutation_scale": 7, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0, "zorder": 1}
    axes.add_patch(FancyArrowPatch(tail, head, **(defaults | look)))


def _paint_transfers(axes: Axes, gadget: Gadget, layout: Layout, width: float, alpha: float) -> None:
    xs = sorted(layout.columns.values()) if gadget.height else []
    extent = xs[-1] - xs[0] if xs else 0.0
    style = "<|-|>" if len(xs) <= 6 else "-"
    width *= 1.0 if len(xs) <= 6 else 0.6
    for index, x in enumerate(xs):
        for other in xs[index + 1 :]:
            peak = arc_height(other - x, extent)
            lean = max(0.06, 0.26 - 0.05 * (other - x))
            _arrow(
                axes,
                (x + lean, RADIUS * 0.86),
                (other - lean, RADIUS * 0.86),
                connectionstyle=f"arc3,rad={-2 * (peak - RADIUS) / (other - x - 2 * lean)}",
                arrowstyle=style,
                color=GREY,
                linewidth=width,
                alpha=alpha,
            )


def _paint_chains(axes: Axes, gadget: Gadget, layout: Layout, alpha: float) -> None:
    for edge in gadget.edges:
        if edge.kind is not EdgeKind.CHAIN:
            continue
        (x, low), (_, high) = layout.nodes[edge.tail], layout.nodes[edge.head]
        upward = high > low
        gap = RADIUS if upward else -RADIUS
        _arrow(axes, (x, low + gap), (x, high - gap), arrowstyle="-|>", color=INK, alpha=alpha)


def _paint_topples(axes: Axes, gadget: Gadget, layout: Layout, alpha: float) -> None:
    assert layout.bar is not None
    for aggregate in gadget.aggregates:
        assert aggregate.locks is not None
        x, y = layout.nodes[aggregate.gather]
        _arrow(
            axes, (layout.columns[aggregate.locks] - RADIUS, 0.0), (x + RADIUS, y),
            arrowstyle="-|>", color=PINK, alpha=alpha,
        )  # fmt: skip
        _arrow(
            axes, (x, y - RADIUS), (x, layout.bar[2] + RADIUS),
            arrowstyle="-|>", color=PINK, linewidth=2.2, mutation_scale=11, alpha=alpha,
        )  # fmt: skip


def _paint_table(axes: Axes, gadget: Gadget, layout: Layout, alpha: float) -> None:
    """Draw the way from the table to the tops: up the interface column's left, down from the line above."""
    assert layout.bar is not None
    assert layout.interface is not None
    heights = [layout.nodes[number][1] for number, node in enumerate(gadget.nodes) if node.kind is NodeKind.INTERFACE]
    if not heights:
        return
    left, right = layout.interface - 0.62, layout.interface + 0.62
    thin: dict[str, Any] = {"color": PINK, "alpha": alpha, "linewidth": 1.0}
    axes.plot([left, left], [layout.bar[2] + RADIUS, max(heights)], zorder=0, **thin)
    first = min(layout.columns.values())
    path = ([right, right, first], [min(heights), layout.bus, layout.bus])
    axes.plot(*path, zorder=0, solid_joinstyle="round", **thin)
    for y in heights:
        _arrow(axes, (left, y), (layout.interface - RADIUS, y), arrowstyle="-|>", **thin)
        axes.plot([layout.interface + RADIUS, right], [y, y], zorder=0, **thin)
    for x in layout.columns.values():
        _arrow(axes, (x, layout.bus), (x, RADIUS), arrowstyle="-|>", **thin)


def _paint_nodes(axes: Axes, gadget: Gadget, layout: Layout, *, label: bool) -> None:
    from matplotlib.patches import Circle, FancyBboxPatch

    for number, node in enumerate(gadget.nodes):
        x, y = layout.nodes[number]
        pink = node.kind is not NodeKind.STACK
        look: dict[str, Any] = {
            "facecolor": PALE_PINK if pink else PALE,
            "edgecolor": PINK if pink else INK,
            "linewidth": 1.0,
        }
        if node.kind is NodeKind.TABLE:
            assert layout.bar is not None
            left, right, _ = layout.bar
            shape = f"round,pad=0,rounding_size={RADIUS}"
            bar = FancyBboxPatch((left, y - RADIUS), right - left, 2 * RADIUS, boxstyle=shape, zorder=2, **look)
            axes.add_patch(bar)
        else:
            axes.add_patch(Circle((x, y), RADIUS, zorder=2, **look))
        if label:
            text = {NodeKind.TOPPLE: "T", NodeKind.TABLE: "TABLE"}.get(node.kind, str(node.key.index))
            axes.text(
                x, y, text, ha="center", va="center_baseline", fontsize=7.5, color=PINK if pink else INK, zorder=3
            )


def _legend(gadget: Gadget) -> list[tuple[str, str, str]]:
    """Return the legend's rows that apply: (sort of mark, colour, text)."""
    nodes, edges = gadget.counts()
    cost = {edge.kind: edge.cost for edge in gadget.edges}
    rows = [("node", INK, f"{nodes[NodeKind.STACK]} nodes $v_s^i$: height $i$ of location $s$, capacity 1")]
    if edges[EdgeKind.CHAIN]:
        rows.append(("line", INK, f"{edges[EdgeKind.CHAIN]} chain edges: shifts within a location, cost 0"))
    if edges[EdgeKind.TRANSFER]:
        price = cost[EdgeKind.TRANSFER]
        rows.append(("line", GREY, f"{edges[EdgeKind.TRANSFER]} edges between tops: pick and place, cost {price}"))
    if gadget.aggregates:
        number, most = nodes[NodeKind.TOPPLE], gadget.aggregates[0].capacity
        rows.append(("pink", PINK, f"{number} nodes $v_{{T_s}}$ (T): staging for a topple of $s$, capacity {most}"))
        rows.append(("thick", PINK, f"{number} topple edges: all that is staged at once, cost 1"))
    if nodes[NodeKind.INTERFACE]:
        number, price = edges[EdgeKind.RETURN], cost[EdgeKind.RETURN]
        rows.append(("pink", PINK, f"{gadget.height} nodes $v_T^i$ (right): a block of the TABLE to pick, capacity 1"))
        rows.append(("line", PINK, f"{number} edges from every $v_T^i$ to every top: pick and place, cost {price}"))
    return rows


def _paint_legend(axes: Axes, rows: list[tuple[str, str, str]]) -> None:
    from matplotlib.lines import Line2D

    handles = []
    for sort, colour, _ in rows:
        if sort in ("node", "pink"):
            fill = PALE if sort == "node" else PALE_PINK
            handles.append(Line2D([], [], marker="o", ls="", mfc=fill, mec=colour, ms=8))
        else:
            handles.append(Line2D([], [], color=colour, lw=2.4 if sort == "thick" else 1.1))
    axes.axis("off")
    axes.legend(handles, [text for _, _, text in rows], loc="upper center", frameon=False, fontsize=8, labelcolor=INK)
