"""The table from above, to scale: slots, landing strips, the arm's reach."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path
from typing import Any

from smash.execution.actions.topple import strip
from smash.execution.layout.conditions import fallen_cubes, falling
from smash.execution.scene.tabletop import Slot, Tabletop
from smash.motion.robots import load_robot
from smash.problem.files.documents import replacing

EDGE = 0.85
"""The picture ends here [m], or where the farthest strip does."""
ASLANT = 0.4
"""Names stand outside of their slots, to the side where the bearing's cosine is greater."""
STACK, BUFFER, STRIP, TRAY = "#2563a8", "#8a8f98", "#d9822b", "#7a5a34"


def draw(tabletop: Tabletop, path: Path) -> None:
    """Draw a scene into a picture file (PNG, PDF, SVG)."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Annulus, Circle, Patch

    figure = Figure(figsize=(7.0, 6.6), layout="constrained")
    FigureCanvasAgg(figure)
    axis = figure.subplots()
    near, far = load_robot(tabletop.robot).full_reach
    axis.add_patch(Annulus((0, 0), far, far - near, facecolor="#eef3ee", edgecolor="none", zorder=0))
    axis.add_patch(Circle((0, 0), 0.08, facecolor="#3b3f45", zorder=3))
    for index, slot in enumerate(tabletop.stacks, start=1):
        for rank, direction in enumerate(slot.directions):
            _strip(axis, slot, direction, tabletop, preferred=rank == 0)
        _slot(axis, slot, tabletop.widest, STACK, _named(f"s{index}", slot))
    for index, slot in enumerate(tabletop.buffers, start=1):
        _slot(axis, slot, tabletop.widest, BUFFER, _named(f"u{index}", slot))
    for index, slot in enumerate(tabletop.stations, start=1):
        _station(axis, slot, tabletop, f"t{index}")
    axis.set_aspect("equal")
    edge = max([EDGE, *(0.02 + abs(value) for corner in _strip_corners(tabletop) for value in corner)])
    axis.set(xlim=(-edge, edge), ylim=(-edge, edge), xlabel="x [m]", ylabel="y [m]")
    axis.set_title(f"Scene {tabletop.name!r}: {_blocks(tabletop)}, to scale")
    trays = [Patch(facecolor="none", edgecolor=TRAY, label="station of a tray")] if tabletop.stations else []
    has_second = any(len(slot.directions) > 1 for slot in tabletop.stacks)
    fallen = _fallen(tabletop)
    strips = [Patch(color=STRIP, alpha=0.35, label=f"landing strip, {fallen}")] if fallen else []
    second = [Patch(facecolor=STRIP, alpha=0.12, label="the same, second choice")] if has_second else []
    figure.legend(
        handles=[
            *trays,
            Line2D([], [], marker="o", color="#3b3f45", linestyle="none", markersize=10, label="robot's base"),
            Patch(color=STACK, label="stack"),
            Patch(color=BUFFER, label="buffer"),
            *strips,
            *second,
            Patch(color="#eef3ee", label="reached from above at all heights"),
        ],
        loc="outside lower center",
        ncols=3,
        frameon=False,
    )
    with replacing(path) as whole:
        figure.savefig(whole, dpi=150)


def _fallen(tabletop: Tabletop) -> str:
    """How many blocks the strips are drawn for; nothing where there are none."""
    made_for = {falling(slot) for slot in tabletop.stacks if slot.directions}
    if not made_for:
        return ""
    least, most = min(made_for), max(made_for)
    return f"{most} block{'s' if most > 1 else ''}" if least == most else f"{least} to {most} blocks"


def _station(axis: Any, slot: Slot, tabletop: Tabletop, name: str) -> None:
    from matplotlib.patches import Polygon

    assert tabletop.tray is not None
    length, width = tabletop.tray.size
    corners = _corners(slot.x, slot.y, slot.angle, width / 2, length / 2)
    axis.add_patch(Polygon(corners, facecolor="none", edgecolor=TRAY, linewidth=1.5, zorder=2))
    axis.text(slot.x, slot.y, name, ha="center", va="center", fontsize=8, zorder=4)


def _named(name: str, slot: Slot) -> str:
    """What a slot is called, and how high its pile may be where the scene says so."""
    return name if slot.highest is None else f"{name}: {slot.highest}"


def _slot(axis: Any, slot: Slot, side: float, colour: str, name: str) -> None:
    from matplotlib.patches import Polygon

    axis.add_patch(Polygon(_corners(slot.x, slot.y, slot.angle, side / 2, side / 2), color=colour, zorder=2))
    sideways = cos(slot.angle)
    anchor = "left" if sideways > ASLANT else "right" if sideways < -ASLANT else "center"
    far = slot.radius + (1.2 if anchor == "center" else 0.9) * side
    axis.text(far * sideways, far * sin(slot.angle), name, ha=anchor, va="center", fontsize=8, zorder=4)


def _strip_corners(tabletop: Tabletop) -> list[tuple[float, float]]:
    """Corners of all strips [m]."""
    ways = [(slot, direction) for slot in tabletop.stacks for direction in slot.directions]
    return [corner for slot, direction in ways for corner in _outline(slot, direction, tabletop)]


def _outline(slot: Slot, direction: str, tabletop: Tabletop) -> list[tuple[float, float]]:
    area, side = strip(fallen_cubes(tabletop, falling(slot))), tabletop.widest
    half = (area.length - side) / 2
    x, y = slot.point(side + half, 0.0, direction)
    return _corners(x, y, slot.heading(direction), half, area.half_width)


def _blocks(tabletop: Tabletop) -> str:
    """The sizes of its blocks."""
    if tabletop.uniform:
        return f"blocks of {100 * tabletop.side:.1f} cm"
    sizes = [tabletop.block, *tabletop.sizes.values()]
    spans = ([size.footprint for size in sizes], [size.height for size in sizes])
    wide, high = (f"{100 * min(span):.1f} to {100 * max(span):.1f} cm" for span in spans)
    return f"boxes {wide} wide, {high} high"


def _strip(axis: Any, slot: Slot, direction: str, tabletop: Tabletop, preferred: bool) -> None:
    from matplotlib.patches import Polygon

    corners = _outline(slot, direction, tabletop)
    axis.add_patch(Polygon(corners, facecolor=STRIP, alpha=0.35 if preferred else 0.12, edgecolor="none", zorder=1))


def _corners(x: float, y: float, yaw: float, half_x: float, half_y: float) -> list[tuple[float, float]]:
    turn = yaw % (2 * pi)
    return [
        (x + a * half_x * cos(turn) - b * half_y * sin(turn), y + a * half_x * sin(turn) + b * half_y * cos(turn))
        for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
    ]
