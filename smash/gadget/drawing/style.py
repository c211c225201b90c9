"""Colours, sizes and small helpers that all the drawings share."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from smash.problem.errors import SmashError
from smash.problem.extras import require
from smash.problem.files.documents import replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BLUE = "#2f6db5"
PALE_BLUE = "#e2edf8"
GREEN = "#2f8f5b"
RADIUS = 0.31
"""Radius of a node, in units of one height."""

STILLS = (".png", ".pdf", ".svg")


def check_suffix(path: Path, allowed: Sequence[str] = STILLS) -> None:
    """Refuse a file whose suffix no drawing can be written to.

    Raises:
        SmashError: naming the suffixes that are allowed.
    """
    if path.suffix.lower() not in allowed:
        raise SmashError(f"{path}: cannot draw to {path.suffix or 'no suffix'!r}; allowed: {', '.join(allowed)}")


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of the given size [inch], which shows itself in a notebook without pyplot.

    Raises:
        MissingExtra: where matplotlib is not installed.
    """
    require("drawing", "matplotlib")
    from matplotlib import rc_context

    from smash.gadget.drawing.shown import ShownFigure

    with rc_context({"svg.fonttype": "none", "pdf.fonttype": 42}):
        return ShownFigure(figsize=(width, height), facecolor="white")


def save(figure: Figure, path: Path) -> None:
    """Write a figure to a PNG (200 dpi), PDF or SVG file.

    Raises:
        SmashError: where the suffix is none of these or the file cannot be written.
    """
    check_suffix(path)
    with replacing(path) as whole:
        figure.savefig(whole, dpi=200, bbox_inches="tight", pad_inches=0.12)
