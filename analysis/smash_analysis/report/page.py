"""The report as one HTML page that needs nothing else: style, script, pictures and the runs behind each cell inside."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from smash.problem.words import counted
from smash_analysis.charts.panels import COLOURS, Curve
from smash_analysis.report.appendix import report_command
from smash_analysis.report.blocks import Block, CardsBlock, ChartBlock, Grid, GridBlock, Section, TableBlock
from smash_analysis.report.build import section
from smash_analysis.report.instances import relative_link
from smash_analysis.report.parts import Slugs, report_latex, report_markdown, write_parts
from smash_analysis.report.sources import find_sources
from smash_analysis.report.svg import inline_svg

DASH_ARRAYS = {"-": "", "--": "6 3", "-.": "7 3 2 3", ":": "2 3"}
"""Line styles of matplotlib as SVG dashes."""


@dataclass(slots=True)
class Behind:
    """What stands behind the cells, as the page's script reads it."""

    stores: dict[str, Any] = field(default_factory=dict)
    grids: list[list[Any]] = field(default_factory=list)
    cells: list[list[Any]] = field(default_factory=list)

    def grid(self, store: str, extra: list[str]) -> int:
        """Announce cells that share a store and columns of their own; return their number."""
        self.grids.append([store, extra])
        return len(self.grids) - 1

    def cell(self, grid: int, entries: list[list[Any]]) -> int:
        """Add one cell; return its number."""
        self.cells.append([grid, entries])
        return len(self.cells) - 1


@dataclass(slots=True)
class ShownPanel:
    """One panel of a chart on the page."""

    title: str
    svg: str


@dataclass(slots=True)
class Shown:
    """A block as the template needs it.

    Attributes:
        files: (label, link) of its files.
        numbers: Numbers of its cells: per grid, row and column, or per table row or card.
    """

    block: Block
    slug: str
    files: list[tuple[str, str]]
    numbers: Any = None
    panels: list[ShownPanel] = field(default_factory=list)


@dataclass(slots=True)
class ShownSection:
    """A section as the template needs it."""

    section: Section
    slug: str
    blocks: list[Shown]
    appendix: list[Shown]


def make(results: Path, out: Path, said: Callable[[str], None] = lambda _: None) -> Path:
    """Write `out/index.html` and `out/parts` from the records at and below `results`; return the page.

    Args:
        results: directory with records, or with such directories.
        out: directory of the report.
        said: hears what is being done.

    Raises:
        NoRecords: where there is no record.
        OSError: where a file cannot be written.
    """
    parts, slugs, behind = out / "parts", Slugs(), Behind()
    sections, files, shown = [], [], []
    for source in find_sources(results, out, said):
        kinds = ((source.runs, "run"), (source.episodes, "episode"), (source.trials, "topple"))
        said(f"{source.title}: {', '.join(counted(len(records), kind) for records, kind in kinds)}")
        made = section(source)
        slug = slugs(made.name)
        names = [slugs(f"{slug}-{block.name}") for block in made.blocks]
        files.append(write_parts(made, slug, names, parts, said))
        sections.append(made)
        shown.append(_shown(made, slug, files[-1], behind, slugs, out))
    (parts / "report.md").write_text(report_markdown(sections, files, parts), encoding="utf-8")
    (parts / "report.tex").write_text(report_latex(sections, files, parts), encoding="utf-8")
    page = out / "index.html"
    page.write_text(_render(results, out, shown, behind), encoding="utf-8")
    return page


def _shown(
    made: Section, slug: str, files: dict[str, list[Path]], behind: Behind, slugs: Slugs, out: Path
) -> ShownSection:
    for name, store in made.stores.items():
        behind.stores[f"{slug}/{name}"] = {"columns": store.columns, "rows": store.rows}
    blocks = [
        _block(block, name, files[name], behind, slug, out) for block, name in zip(made.blocks, files, strict=True)
    ]
    appendix = [_block(block, slugs(f"{slug}-{block.name}"), [], behind, slug, out) for block in made.appendix]
    return ShownSection(made, slug, blocks, appendix)


def _block(block: Block, name: str, files: list[Path], behind: Behind, section_slug: str, out: Path) -> Shown:
    links = [(_kind(file), relative_link(str(file), out)) for file in files]
    shown = Shown(block, name, links)
    if isinstance(block, GridBlock):
        shown.numbers = [_numbers(grid, behind, f"{section_slug}/{block.store}") for grid in block.grids]
    elif isinstance(block, ChartBlock):
        panels = enumerate([panel for row in block.chart.rows for panel in row])
        shown.panels = [
            ShownPanel(p.title, inline_svg(block.chart.panel_figure(p), p.title, p.words, f"{name}-{number}"))
            for number, p in panels
        ]
    elif isinstance(block, TableBlock | CardsBlock):
        entries = block.entries if isinstance(block, TableBlock) else [card.entries for card in block.cards]
        if entries:
            grid = behind.grid(f"{section_slug}/{block.store}", [])
            shown.numbers = [behind.cell(grid, [[number] for number in row]) if row else None for row in entries]
    return shown


def _kind(file: Path) -> str:
    """Return what a file's link is called: its ending, and the width where there are two (`tables.latex`)."""
    kind = file.suffix[1:].upper()
    return f"{kind}, one column" if file.stem.endswith("-column") else kind


def _numbers(grid: Grid, behind: Behind, store: str) -> list[list[int | None]]:
    number = behind.grid(store, grid.extra)
    return [[None if cell is None else behind.cell(number, cell.entries) for cell in row] for row in grid.cells]


def _render(results: Path, out: Path, sections: list[ShownSection], behind: Behind) -> str:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("smash_analysis.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["prose"] = prose
    template = environment.get_template("page.html")
    return template.render(
        title=results.resolve().name or "results",
        sections=sections,
        totals=list(_totals(sections)),
        behind={"stores": behind.stores, "grids": behind.grids, "cells": behind.cells},
        command=report_command(results, out),
        sample=sample,
        link=lambda file: relative_link(file, out),
    )


def _totals(sections: list[ShownSection]) -> Iterator[tuple[str, str]]:
    stores = [(name, store) for shown in sections for name, store in shown.section.stores.items()]
    for kind, words in (("runs", "runs"), ("episodes", "episodes carried out"), ("trials", "topples tried")):
        count = sum(len(store.rows) for name, store in stores if name == kind)
        if count:
            yield f"{count:,}", words


def prose(text: str) -> str:
    """Return a sentence as HTML, with what stands between backticks as code; all else in it is text."""
    from markupsafe import Markup, escape

    return Markup(re.sub(r"`([^`]+)`", r"<code>\1</code>", str(escape(text))))


def sample(curve: Curve) -> tuple[str, str]:
    """Return (CSS colour, SVG dashes) of a curve for a legend; no dash at all means dots."""
    return f"var(--curve-{COLOURS.index(curve.colour)})", DASH_ARRAYS.get(curve.dash, "none")
