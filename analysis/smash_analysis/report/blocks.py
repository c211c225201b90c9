"""What a section of the report is built of; each block is shown on the page and written as files of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import pandas as pd

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from smash_analysis.charts.panels import Chart
    from smash_analysis.report.pictures import Card


@dataclass(slots=True)
class Words:
    """Sentences."""

    name: str
    title: str
    lines: list[str]
    kind: Literal["words"] = "words"


@dataclass(slots=True)
class Listing:
    """Text as it stands: commands, an experiment file."""

    name: str
    title: str
    text: str
    note: str = ""
    folded: bool = False
    kind: Literal["listing"] = "listing"


@dataclass(slots=True)
class TableBlock:
    """A table of texts.

    Attributes:
        note: What is counted, over which subset.
        emphasis: Rows to stand out, by their number (the paper's).
        folded: Whether a reader opens it first.
        grouped: Whether rows with the same first cell are one group, which says it once.
        pictures: Column -> small inline SVG beside the text of each row, on the page alone.
        entries: Per row the runs behind it (numbers of the section's store), empty where a row has none to show.
        store: Name of that store.
    """

    name: str
    title: str
    frame: pd.DataFrame
    note: str = ""
    emphasis: frozenset[int] = frozenset()
    folded: bool = False
    grouped: bool = False
    pictures: dict[str, list[str]] = field(default_factory=dict)
    entries: list[list[int]] = field(default_factory=list)
    store: str = ""
    kind: Literal["table"] = "table"

    def spans(self) -> list[int]:
        """Return per row how many rows its first cell stands for; 0 where a cell above does."""
        spans = [1] * len(self.frame)
        if self.grouped:
            first = self.frame.iloc[:, 0].tolist()
            for row in range(len(first) - 1, 0, -1):
                if first[row] == first[row - 1]:
                    spans[row - 1], spans[row] = spans[row] + 1, 0
        return spans


@dataclass(slots=True)
class ChartBlock:
    """A chart of small panels."""

    name: str
    title: str
    chart: Chart
    note: str = ""
    kind: Literal["chart"] = "chart"


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell of a grid.

    Attributes:
        text: What it shows.
        colour: Its background, as CSS; empty for none.
        ink: black or white, on that background.
        words: What a screen reader says and the list of runs is titled.
        entries: Rows of the store behind it: the row's number, then a text for each of the grid's own columns.
        few: How many instances it stands for, where they are so few that it should look like it; else 0.
    """

    text: str
    colour: str
    ink: str
    words: str
    entries: list[list[Any]]
    few: int = 0


@dataclass(slots=True)
class Grid:
    """A heatmap as a table: cells by row and column, None where nothing was run."""

    title: str
    across: str
    upward: str
    columns: list[str]
    rows: list[str]
    cells: list[list[Cell | None]]
    extra: list[str] = field(default_factory=list)
    wide: bool = False


@dataclass(slots=True)
class GridBlock:
    """Grids that belong together.

    Attributes:
        store: Name of the store whose rows stand behind the cells.
        lines: Findings on them, a sentence each.
        picture: Draws the same for paper; None where `frame` says it all.
        frame: The same as a table of texts, for the files.
        fold: Whether it may be folded.
        opened: Whether it begins open.
        summary: What it says while it is folded.
    """

    name: str
    title: str
    store: str
    grids: list[Grid]
    frame: pd.DataFrame
    lines: list[str] = field(default_factory=list)
    note: str = ""
    picture: Callable[[], Figure] | None = None
    fold: bool = False
    opened: bool = True
    summary: str = ""
    kind: Literal["grids"] = "grids"


@dataclass(slots=True)
class CardsBlock:
    """Instances as pictures of start and goal."""

    name: str
    title: str
    cards: list[Card]
    store: str
    note: str = ""
    kind: Literal["cards"] = "cards"


Block = Words | Listing | TableBlock | ChartBlock | GridBlock | CardsBlock


@dataclass(slots=True)
class Store:
    """Rows that cells point at: a run, an episode or a trial each."""

    columns: list[str]
    rows: list[list[Any]]


@dataclass(slots=True)
class Section:
    """One source as it is shown.

    Attributes:
        headlines: The findings that the overview repeats.
        figures: (number, what it counts) for the top of the section.
        blocks: In order; `appendix` comes at the end of the page.
    """

    name: str
    title: str
    lead: str
    headlines: list[str]
    figures: list[tuple[str, str]]
    blocks: list[Block]
    appendix: list[Block]
    stores: dict[str, Store]
