"""The gadget figure, after the paper's (pink: what takes part in a topple), for any number of locations."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from smash.gadget.drawing.layout import DECK, Layout, arc_height, lay_out
from smash.gadget.drawing.style import (
    BLUE,
    GREEN,
    GREY,
    INK,
    PALE,
    PALE_BLUE,
    PALE_PINK,
    PINK,
    RADIUS,
    check_suffix,
    new_figure,
    save,
    short,
)
from smash.gadget.elements import EdgeKind, Node, NodeKind
from smash.gadget.graph import Gadget

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FILLS = {"node": PALE, "pink": PALE_PINK, "blue": PALE_BLUE}
"""Fill colours of the legend's node marks."""
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
    return low, layout.top


def frame(axes: Axes, gadget: Gadget, layout: Layout) -> None:
    """Fit the axes to the drawing, one unit as long as the other, without spines."""
    low, high = vertical_extent(gadget, layout)
    wide = DECK if gadget.tokens else 0.0
    right = max(layout.right + 1.2 + wide, layout.bar[1] + 0.2 if layout.bar else 0.0)
    left = min(layout.left - 0.7 - wide, layout.bar[0] - 0.2 if layout.bar else 0.0)
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
        _paint_staged(axes, gadget, layout, alpha)
        _paint_table(axes, gadget, layout, alpha)
    _paint_in_place(axes, gadget, layout, alpha)
    if layout.deck is not None:
        paint_decks(axes, gadget, layout, layout.deck, alpha)
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


def _paint_staged(axes: Axes, gadget: Gadget, layout: Layout, alpha: float) -> None:
    """Draw the ways into the gathering nodes and from there to the table (topples)."""
    assert layout.bar is not None
    for aggregate in gadget.aggregates:
        if aggregate.locks is None or aggregate.gather is None:
            continue
        x, y = layout.nodes[aggregate.gather]
        _arrow(
            axes, (layout.columns[aggregate.locks] - RADIUS, 0.0), (x + RADIUS, y),
            arrowstyle="-|>", color=PINK, alpha=alpha,
        )  # fmt: skip
        _arrow(
            axes, (x, y - RADIUS), (x, layout.bar[2] + RADIUS),
            arrowstyle="-|>", color=PINK, linewidth=2.2, mutation_scale=11, alpha=alpha,
        )  # fmt: skip


def _paint_in_place(axes: Axes, gadget: Gadget, layout: Layout, alpha: float) -> None:
    """Draw the rungs between neighbouring columns (lifts); those between others look alike."""
    names = list(layout.columns)
    neighbours = set(pairwise(names))
    for aggregate in gadget.aggregates:
        if not aggregate.in_place or aggregate.touches not in neighbours:
            continue
        for number in aggregate.edges:
            (x, y), (u, v) = (layout.nodes[node] for node in (gadget.edges[number].tail, gadget.edges[number].head))
            _arrow(
                axes, (x + 0.86 * RADIUS, y - 0.16), (u - 0.86 * RADIUS, v - 0.16), connectionstyle="arc3,rad=0.3",
                arrowstyle="<|-|>", color=GREEN, linewidth=1.8, zorder=1.5, alpha=alpha,
            )  # fmt: skip


def paint_decks(axes: Axes, gadget: Gadget, layout: Layout, line: float, alpha: float) -> None:
    """Draw the ways of the carriers, and those of blocks between them and the tops."""
    thin: dict[str, Any] = {"color": BLUE, "alpha": alpha, "linewidth": 1.0}
    shift, loaded = 0.13, _is_loaded(gadget)
    xs = [x + shift for x in layout.columns.values()] if gadget.height else []
    for x in xs:
        _arrow(axes, (x, line), (x, RADIUS * 0.9), arrowstyle="-|>", **thin)
    for token in gadget.tokens:
        places = [layout.nodes[node] for node in token.nodes.values()]
        xs += [x for x, _ in places]
        for x, y in places:
            _arrow(axes, (x, line), (x, y - RADIUS), arrowstyle="-|>" if loaded else "-", **thin)
        for (x, y), (u, v) in pairwise(places):
            _arrow(
                axes, (x + DECK, y), (u - DECK, v),
                arrowstyle="<|-|>", color=BLUE, linewidth=2.2, mutation_scale=11, alpha=alpha,
            )  # fmt: skip
    axes.plot([min(xs), max(xs)], [line, line], zorder=0, **thin)
    if loaded and layout.interface is not None:
        x = min(layout.columns.values()) + 0.5
        _arrow(axes, (x, layout.bus), (x, line), arrowstyle="-|>", **(thin | {"color": PINK}))


def _is_loaded(gadget: Gadget) -> bool:
    """Whether blocks are placed on carriers at all."""
    return any(edge.kind.picks and gadget.nodes[edge.head].token is not None for edge in gadget.edges)


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
        elif node.kind is NodeKind.CARRIER:
            look |= {"facecolor": PALE_BLUE, "edgecolor": BLUE}
            shape = "round,pad=0,rounding_size=0.1"
            box = FancyBboxPatch((x - DECK, y - RADIUS), 2 * DECK, 2 * RADIUS, boxstyle=shape, zorder=2, **look)
            axes.add_patch(box)
        else:
            axes.add_patch(Circle((x, y), RADIUS, zorder=2, **look))
        if not label and node.kind is NodeKind.CARRIER:
            axes.text(x, y + 0.42, _label(node), ha="center", fontsize=6.5, color=BLUE, alpha=0.7, parse_math=False)
        elif label:
            axes.text(
                x, y, _label(node), ha="center", va="center_baseline", fontsize=7.5, color=look["edgecolor"], zorder=3,
                parse_math=False,
            )  # fmt: skip


def _label(node: Node) -> str:
    match node.kind:
        case NodeKind.TOPPLE:
            return "T"
        case NodeKind.TABLE:
            return "TABLE"
        case NodeKind.CARRIER:
            return f"{short(node.location or '', 7)} at {short(node.spot or '', 7)}"
        case _:
            return str(node.key.index)


def _legend(gadget: Gadget) -> list[tuple[str, str, str]]:
    """Return the legend's rows that apply: (sort of mark, colour, text)."""
    nodes, edges = gadget.counts()
    rows = [("node", INK, f"{nodes[NodeKind.STACK]} nodes $v_s^i$: height $i$ of location $s$, capacity 1")]
    if edges[EdgeKind.CHAIN]:
        rows.append(("line", INK, f"{edges[EdgeKind.CHAIN]} chain edges: shifts within a location, cost 0"))
    between = [
        edge.cost
        for edge in gadget.edges
        if edge.kind is EdgeKind.TRANSFER and all(gadget.nodes[end].token is None for end in (edge.tail, edge.head))
    ]
    if between:
        rows.append(("line", GREY, f"{len(between)} edges between tops: pick and place, {_cost(between)}"))
    staged = [aggregate for aggregate in gadget.aggregates if aggregate.locks is not None]
    if staged:
        most, cost = staged[0].capacity, _cost([aggregate.cost for aggregate in staged])
        name = staged[0].part
        rows.append(
            ("pink", PINK, f"{len(staged)} nodes $v_{{T_s}}$ (T): staging for a {name} of $s$, capacity {most}")
        )
        rows.append(("thick", PINK, f"{len(staged)} {name} edges: all that is staged at once, {cost}"))
    if nodes[NodeKind.INTERFACE]:
        costs = [edge.cost for edge in gadget.edges if edge.kind is EdgeKind.RETURN]
        where = "top and carrier" if gadget.tokens else "top"
        rows.append(("pink", PINK, f"{gadget.height} nodes $v_T^i$ (right): a block of the TABLE to pick, capacity 1"))
        rows.append(
            ("line", PINK, f"{len(costs)} edges from every $v_T^i$ to every {where}: pick and place, {_cost(costs)}")
        )
    return rows + _further_rows(gadget)


def _further_rows(gadget: Gadget) -> list[tuple[str, str, str]]:
    """Return the legend's rows of carriers and of what is moved in place."""
    rows = []
    decks = [node for node in gadget.nodes if node.token is not None]
    if decks:
        costs = [
            edge.cost
            for edge in gadget.edges
            if edge.kind.picks and any(gadget.nodes[end].token is not None for end in (edge.tail, edge.head))
        ]
        most = max(node.capacity for node in decks)
        rows.append(("blue", BLUE, f"{len(decks)} nodes $(C, p)$: what lies on carrier $C$ at $p$, capacity {most}"))
        rows.append(("line", BLUE, f"{len(costs)} edges to and from them: pick and place, {_cost(costs)}"))
    moved = [aggregate for aggregate in gadget.aggregates if aggregate.token is not None]
    if moved:
        text = f"{len(moved)} {moved[0].part} edges: the carrier with all on it, {_cost([a.cost for a in moved])}"
        rows.append(("thick", BLUE, text))
    emptied = [
        each for each in gadget.aggregates if each.gather is not None and each.locks is None and each.token is None
    ]
    if emptied:
        text = f"{len(emptied)} {emptied[0].part} edges (not drawn): all that lies in $(C, p)$, without $C$, "
        rows.append(("thick", PINK, text + _cost([each.cost for each in emptied])))
    lifted = [aggregate for aggregate in gadget.aggregates if aggregate.in_place]
    if lifted:
        text = (
            f"{len(lifted)} {lifted[0].part}s between any two locations (neighbours drawn), "
            f"of {lifted[0].capacity} rungs, {_cost([a.cost for a in lifted])}"
        )
        rows.append(("thick", GREEN, text))
    return rows


def _cost(costs: Sequence[int]) -> str:
    low, high = min(costs, default=0), max(costs, default=0)
    return f"cost {low}" if low == high else f"cost {low} to {high}"


def _paint_legend(axes: Axes, rows: list[tuple[str, str, str]]) -> None:
    from matplotlib.lines import Line2D

    handles = []
    for sort, colour, _ in rows:
        if sort in FILLS:
            fill = FILLS[sort]
            handles.append(Line2D([], [], marker="o", ls="", mfc=fill, mec=colour, ms=8))
        else:
            handles.append(Line2D([], [], color=colour, lw=2.4 if sort == "thick" else 1.1))
    axes.axis("off")
    axes.legend(handles, [text for _, _, text in rows], loc="upper center", frameon=False, fontsize=8, labelcolor=INK)
