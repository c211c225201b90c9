"""Colours, sizes and small helpers that all the drawings share."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from smash.problem.errors import MalformedFile, SmashError, Unsupported

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INK = "#2b2d33"
GREY = "#8a8f99"
PALE = "#eceef2"
PINK = "#d6337c"
PALE_PINK = "#fbe3ee"
BLUE = "#2f6db5"
PALE_BLUE = "#e2edf8"
GREEN = "#2f8f5b"
RADIUS = 0.31
"""Radius of a node, in units of one height."""

STILLS = (".png", ".pdf", ".svg")

PALETTE = (
    "#f0a202", "#3a86c8", "#2a9d6f", "#e4572e", "#8e6bbf", "#6cc3d5", "#b5bd3f", "#c97b9a", "#7f6a5b", "#1b5e7b",
    "#f7c873", "#97c9f0", "#94d7b8", "#f3a48c", "#cdb8e8", "#4b8a3c", "#a23b5a", "#5a5f8f", "#d9b38c", "#607d8b",
)  # fmt: skip


def block_colours(blocks: Sequence[str]) -> dict[str, str]:
    """Return a fill colour per block, in order; colours repeat after twenty."""
    return {block: PALETTE[number % len(PALETTE)] for number, block in enumerate(blocks)}


def ink_on(colour: str) -> str:
    """Return black or white, whichever is read better on `colour` (`#rrggbb`)."""
    red, green, blue = (int(colour[at : at + 2], 16) for at in (1, 3, 5))
    return INK if 0.299 * red + 0.587 * green + 0.114 * blue > 135 else "white"


def short(name: str, most: int = 4) -> str:
    """Return a name that fits into a pebble."""
    shown = name if name.isprintable() else name.encode("unicode_escape").decode("ascii")
    return shown if len(shown) <= most else shown[: most - 1] + "…"


def check_suffix(path: Path, allowed: Sequence[str] = STILLS) -> None:
    """Refuse a file whose suffix no drawing can be written to.

    Raises:
        SmashError: naming the suffixes that are allowed.
    """
    if path.suffix.lower() not in allowed:
        raise SmashError(f"{path}: cannot draw to {path.suffix or 'no suffix'!r}; allowed: {', '.join(allowed)}")


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of the given size [inch].

    Raises:
        Unsupported: where matplotlib is not installed.
    """
    try:
        from matplotlib import rc_context
        from matplotlib.figure import Figure
    except ImportError:
        raise Unsupported("drawing needs matplotlib: pip install 'smash-testbed[analysis]'") from None
    with rc_context({"svg.fonttype": "none", "pdf.fonttype": 42}):
        return Figure(figsize=(width, height), facecolor="white")


def save(figure: Figure, path: Path) -> None:
    """Write a figure to a PNG (200 dpi), PDF or SVG file.

    Raises:
        MalformedFile: where it cannot be written.
    """
    try:
        figure.savefig(path, dpi=200, bbox_inches="tight", pad_inches=0.12)
    except OSError as error:
        raise MalformedFile(str(path), f"cannot be written: {error.strerror}") from None
