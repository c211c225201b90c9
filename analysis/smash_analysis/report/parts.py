"""The parts of a report as files: pictures as PNG and PDF, tables as Markdown, LaTeX and CSV."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from smash_analysis.report.blocks import Block, ChartBlock, GridBlock, Listing, Section, TableBlock, Words
from smash_analysis.tables.latex import tex, write_latex
from smash_analysis.tables.writing import markdown, write_csv

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURE_DPI = 150
METADATA = {"png": {"Software": None}, "pdf": {"CreationDate": None, "Creator": None, "Producer": None}}
"""Nothing that would make files of the same records differ."""


class Slugs:
    """Names as they may stand in paths and ids: each is given once."""

    def __init__(self) -> None:
        self._given: set[str] = set()

    def __call__(self, name: str) -> str:
        """Return a slug of `name` that was not given before."""
        plain = re.sub(r"[^a-z0-9.]+", "-", name.lower()).strip("-.") or "part"
        slug, number = plain, 2
        while slug in self._given:
            slug, number = f"{plain}-{number}", number + 1
        self._given.add(slug)
        return slug


def write_parts(
    section: Section, slug: str, slugs: list[str], out: Path, said: Callable[[str], None] = lambda _: None
) -> dict[str, list[Path]]:
    """Write the files of a section's blocks to `out/slug`; return them by the block's slug.

    Args:
        section: what to write.
        slug: of the section.
        slugs: of its blocks, in their order.
        out: directory of all parts.
        said: hears which part is written.
    """
    directory = out / slug
    directory.mkdir(parents=True, exist_ok=True)
    files = {}
    for number, (block, name) in enumerate(zip(section.blocks, slugs, strict=True), start=1):
        said(f"{section.name}: part {number} of {len(slugs)}: {block.title}")
        files[name] = _write(block, directory, name, slug)
    return files


def _write(block: Block, directory: Path, name: str, section: str) -> list[Path]:
    if isinstance(block, TableBlock):
        return _table(block.frame, block.title, directory / name, section)
    if isinstance(block, ChartBlock):
        return _pictures(block.chart.figure, directory / name)
    if isinstance(block, GridBlock):
        pictures = _pictures(block.picture, directory / name) if block.picture is not None else []
        return pictures + _table(block.frame, block.title, directory / name, section)
    return []


def _pictures(draw: Callable[[], Figure], stem: Path) -> list[Path]:
    figure, files = draw(), []
    for ending, metadata in METADATA.items():
        files.append(stem.with_name(f"{stem.name}.{ending}"))
        figure.savefig(files[-1], dpi=PICTURE_DPI, metadata=metadata)
        figure.set_layout_engine("none")  # where things stand is settled by the first
    return files


def _table(frame: pd.DataFrame, title: str, stem: Path, section: str) -> list[Path]:
    if frame.empty:
        return []
    files = [stem.with_name(f"{stem.name}.{ending}") for ending in ("md", "csv")]
    files[0].write_text(markdown(frame), encoding="utf-8")
    write_csv(frame, files[1])
    return files + write_latex(frame, title, f"tab:{section}-{stem.name}", stem)


def report_markdown(sections: list[Section], files: list[dict[str, list[Path]]], out: Path) -> str:
    """Return the whole report as Markdown; pictures by links relative to `out`."""
    lines = ["# Report", ""]
    for section, made in zip(sections, files, strict=True):
        lines += [f"## {section.title}", "", section.lead, "", *(f"- {line}" for line in section.headlines), ""]
        for block, parts in zip(section.blocks, made.values(), strict=True):
            lines += _markdown_block(block, parts, out)
        for block in section.appendix:
            lines += _markdown_block(block, [], out)
    return "\n".join(lines) + "\n"


def _markdown_block(block: Block, parts: list[Path], out: Path) -> list[str]:
    lines = [f"### {block.title}", ""]
    lines += [f"![{block.title}]({file.relative_to(out).as_posix()})" for file in parts if file.suffix == ".png"]
    if isinstance(block, Words | GridBlock):
        lines += ["", *(f"- {line}" for line in block.lines), ""]
    if isinstance(block, TableBlock | GridBlock):
        lines += [block.note, "", markdown(block.frame) if len(block.frame) else "None.", ""]
    if isinstance(block, Listing):
        lines += ["```", block.text, "```", ""]
    if isinstance(block, ChartBlock):
        lines += ["", block.note, ""]
    return lines


PREAMBLE = r"""\documentclass[10pt]{article}
\usepackage[a4paper,margin=18mm]{geometry}
\usepackage[T1]{fontenc}
\usepackage{booktabs,graphicx}
\begin{document}
"""


def report_latex(sections: list[Section], files: list[dict[str, list[Path]]], out: Path) -> str:
    """Return a LaTeX document that holds every table and picture of the report."""
    lines = [PREAMBLE]
    for section, made in zip(sections, files, strict=True):
        lines += [rf"\section{{{tex(section.title)}}}", tex(section.lead)]
        if section.headlines:
            lines += [r"\begin{itemize}", *(rf"\item {tex(line)}" for line in section.headlines), r"\end{itemize}"]
        for block, parts in zip(section.blocks, made.values(), strict=True):
            for file in parts:
                inner = file.relative_to(out).as_posix()
                if file.suffix == ".pdf":
                    picture = rf"\includegraphics[width=\textwidth,height=0.8\textheight,keepaspectratio]{{{inner}}}"
                    lines += [
                        r"\begin{figure}[p]\centering",
                        picture,
                        rf"\caption{{{tex(block.title)}}}",
                        r"\end{figure}",
                    ]
                elif file.suffix == ".tex" and not file.stem.endswith("-column"):
                    lines.append(rf"\input{{{inner}}}")
        lines.append(r"\clearpage")
    return "\n".join([*lines, r"\end{document}"]) + "\n"
