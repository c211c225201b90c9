"""Charts of small panels: one description, drawn as a whole figure for paper or panel by panel for a page."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8C8C00")
DASHES = ("-", "--", "-.", ":")
"""Okabe and Ito's colours for every kind of colour vision; line styles tell curves apart in grey."""
GRID_COLOUR = "#dddddd"
WIDTH, KEYS_A_LINE = 7.0, 4
"""Of a figure over both columns of a paper [in], and the curves that a line of its legend names."""


@dataclass(frozen=True, slots=True)
class Curve:
    """How one curve looks in every panel: its name, colour and line style."""

    name: str
    colour: str
    dash: str

    def style(self) -> dict[str, Any]:
        """Return the keywords for matplotlib; `gid` marks the curve in an SVG."""
        return {"color": self.colour, "linestyle": self.dash, "label": self.name, "gid": f"curve:{self.name}"}


def curves(names: Sequence[str]) -> list[Curve]:
    """Return a curve for each name: no two look the same, in colour or in line style, up to 32 of them."""
    return [
        Curve(name, COLOURS[i % len(COLOURS)], DASHES[(i + i // len(COLOURS)) % len(DASHES)])
        for i, name in enumerate(names)
    ]


@dataclass(frozen=True, slots=True)
class Panel:
    """One pair of axes: a title, what is drawn into it, and the same in words for who cannot see it."""

    title: str
    draw: Callable[[Axes], None]
    words: str = ""


@dataclass(frozen=True, slots=True)
class Chart:
    """A grid of panels with the same axes.

    Attributes:
        rows: Panels, row by row, all rows of equal length.
        across: What runs to the right, with its unit; `upward` likewise.
        legend: The curves that may occur.
        panel_size: Width and height of a panel that stands alone [in].
    """

    rows: list[list[Panel]]
    across: str
    upward: str
    legend: list[Curve]
    panel_size: tuple[float, float] = (3.3, 2.4)

    def figure(self) -> Figure:
        """Draw all panels and one legend, as wide as both columns of a paper."""
        below = -(-len(self.legend) // KEYS_A_LINE)
        figure = _blank(WIDTH, 1.9 * len(self.rows) + 0.3 + 0.16 * below)
        axes = figure.subplots(len(self.rows), len(self.rows[0]), squeeze=False, sharey=True)
        for row, panels in enumerate(self.rows):
            for column, panel in enumerate(panels):
                _draw(axes[row][column], panel)
            axes[row][0].set_ylabel(self.upward)
        for axis in axes[-1]:
            axis.set_xlabel(self.across)
        lines = {line.get_label(): line for axis in axes.flat for line in axis.get_lines()}
        named = {name: line for name, line in lines.items() if not str(name).startswith("_")}
        keys = list(map(as_it_stands, named))
        figure.legend(named.values(), keys, loc="outside lower center", ncols=KEYS_A_LINE, frameon=False)
        return figure

    def panel_figure(self, panel: Panel) -> Figure:
        """Draw one panel alone, with its own axis titles and without a legend."""
        figure = _blank(*self.panel_size, layout=None)
        axis = figure.subplots()
        figure.subplots_adjust(left=0.17, right=0.97, top=0.97, bottom=0.45 / self.panel_size[1])
        _draw(axis, replace(panel, title=""))
        axis.set_xlabel(self.across)
        axis.set_ylabel(self.upward)
        return figure


def _blank(width: float, height: float, layout: Literal["constrained"] | None = "constrained") -> Figure:
    import matplotlib as mpl
    from matplotlib.figure import Figure

    mpl.rcParams.update({"font.size": 7, "axes.titlesize": 7.5, "pdf.fonttype": 42})
    return Figure(figsize=(width, height), layout=layout)


def _draw(axis: Axes, panel: Panel) -> None:
    panel.draw(axis)
    axis.set_title(as_it_stands(panel.title))
    axis.grid(color=GRID_COLOUR, linewidth=0.6)
    axis.spines[["top", "right"]].set_visible(False)


def as_it_stands(text: str) -> str:
    """Return a text as a picture shows it as it stands: no part of it is read as a formula."""
    return text.replace("$", r"\$")
