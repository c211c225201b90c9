"""The table from above, to scale: slots, landing strips, the arm's reach."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path
from typing import Any

from smash.execution.actions.topple import strip
from smash.execution.layout.conditions import FALLING
from smash.execution.scene.tabletop import Slot, Tabletop
from smash.motion.robots import load_robot

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
            _strip(axis, slot, direction, tabletop.side, preferred=rank == 0)
        _slot(axis, slot, tabletop.side, STACK, f"s{index}")
    for index, slot in enumerate(tabletop.buffers, start=1):
        _slot(axis, slot, tabletop.side, BUFFER, f"u{index}")
    for index, slot in enumerate(tabletop.stations, start=1):
        _station(axis, slot, tabletop, f"t{index}")
    axis.set_aspect("equal")
    axis.set(xlim=(-0.85, 0.85), ylim=(-0.85, 0.85), xlabel="x [m]", ylabel="y [m]")
    axis.set_title(f"Scene {tabletop.name!r}: blocks of {100 * tabletop.side:.1f} cm, to scale")
    trays = [Patch(facecolor="none", edgecolor=TRAY, label="station of a tray")] if tabletop.stations else []
    has_second = any(len(slot.directions) > 1 for slot in tabletop.stacks)
    second = [Patch(facecolor=STRIP, alpha=0.12, label="the same, second choice")] if has_second else []
    figure.legend(
        handles=[
            *trays,
            Line2D([], [], marker="o", color="#3b3f45", linestyle="none", markersize=10, label="robot's base"),
            Patch(color=STACK, label="stack"),
            Patch(color=BUFFER, label="buffer"),
            Patch(color=STRIP, alpha=0.35, label=f"landing strip, {FALLING} blocks"),
            *second,
            Patch(color="#eef3ee", label="reached from above at all heights"),
        ],
        loc="outside lower center",
        ncols=3,
        frameon=False,
    )
    figure.savefig(path, dpi=150)


def _station(axis: Any, slot: Slot, tabletop: Tabletop, name: str) -> None:
    from matplotlib.patches import Polygon

    assert tabletop.tray is not None
    length, width = tabletop.tray.size
    corners = _corners(slot.x, slot.y, slot.angle, width / 2, length / 2)
    axis.add_patch(Polygon(corners, facecolor="none", edgecolor=TRAY, linewidth=1.5, zorder=2))
    axis.text(slot.x, slot.y, name, ha="center", va="center", fontsize=8, zorder=4)


def _slot(axis: Any, slot: Slot, side: float, colour: str, name: str) -> None:
    from matplotlib.patches import Polygon

    axis.add_patch(Polygon(_corners(slot.x, slot.y, slot.angle, side / 2, side / 2), color=colour, zorder=2))
    far = slot.radius + 0.06
    axis.text(far * cos(slot.angle), far * sin(slot.angle), name, ha="center", va="center", fontsize=8, zorder=4)


def _strip(axis: Any, slot: Slot, direction: str, side: float, preferred: bool) -> None:
    from matplotlib.patches import Polygon

    area = strip(FALLING)
    half = (area.length - side) / 2
    x, y = slot.point(side + half, 0.0, direction)
    corners = _corners(x, y, slot.heading(direction), half, area.half_width)
    axis.add_patch(Polygon(corners, facecolor=STRIP, alpha=0.35 if preferred else 0.12, edgecolor="none", zorder=1))


def _corners(x: float, y: float, yaw: float, half_x: float, half_y: float) -> list[tuple[float, float]]:
    turn = yaw % (2 * pi)
    return [
        (x + a * half_x * cos(turn) - b * half_y * sin(turn), y + a * half_x * sin(turn) + b * half_y * cos(turn))
        for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))
    ]
