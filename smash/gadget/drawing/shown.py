"""A figure that a notebook shows where it is the value of a cell; pyplot, which would see to that, is not imported."""

from __future__ import annotations

from io import BytesIO

from matplotlib.figure import Figure


class ShownFigure(Figure):
    """A matplotlib figure with a picture of itself."""

    def _repr_png_(self) -> bytes:
        """Return the figure as a PNG picture."""
        content = BytesIO()
        self.savefig(content, format="png", dpi=100, bbox_inches="tight", pad_inches=0.12)
        return content.getvalue()
