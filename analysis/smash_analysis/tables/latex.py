"""Tables as LaTeX that fit a paper: one column or two, text of 7 pt, booktabs alone, no number of their own.

What is too wide is wrapped; what cannot be wrapped is set in panels under each other, each with what names its rows;
what is too long goes to further floats. Widths are those of Computer Modern, which is wider than Times.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

SIZE = 7.0
"""Of the text [pt]; no table is scaled."""
WIDTHS = {"": 495.0, "-column": 240.0}
"""Ending of a file's name -> how wide its table may be [pt]: both columns, or one, of the narrowest usual styles."""
SEPARATION = 2.5
"""Left and right of every column [pt]."""
MOST_LINES = 56
"""A float with more lines would not fit a page."""
LEAD = 8.4
"""From line to line [pt]."""
NUMBERED = re.compile(r"^(Table|Figure) [IVX\d]+: ")
PIECE = re.compile(r"\S{1,14}?[-/_](?=\w)|\S{1,18}")
"""What stays on one line: words; long names are broken behind a sign between two parts, or where they must be."""
MINUS = re.compile(r"(?<![\w.)\]-])-(?=\.?\d)")
"""The sign of a number."""
EM = {"iljtfrI.,:;'|()[]! ": 0.36, "mwMW%@±≤×–": 0.95, "ABCDEFGHJKLNOPQRSTUVXYZ&+=<>": 0.78}
"""Letters -> how wide they are [em]; all others 0.57, which is a digit's."""
TEX = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "±": r"$\pm$", "≤": r"$\le$", "≥": r"$\ge$",
    "×": r"$\times$", "–": "--", "—": "---", "✓": r"$\surd$", "“": "``", "”": "''", "‘": "`", "’": "'", "…": r"\dots{}",
    "<": "$<$", ">": "$>$", "|": "$|$", '"': "''", "→": r"$\to$", "·": r"$\cdot$", "−": "$-$",
    "°": r"$^\circ$", "≠": r"$\ne$",
}  # fmt: skip


def tex(text: str) -> str:
    """Return a text as LaTeX shows it as it stands; a letter that its fonts lack is named by its code."""
    return "".join(TEX.get(letter) or _plain(letter) for letter in MINUS.sub("−", text))


def _plain(letter: str) -> str:
    if letter.isascii() or "LATIN" in unicodedata.name(letter, ""):
        return letter if letter.isprintable() else " "
    return f"[U+{ord(letter):04X}]"


def write_latex(table: pd.DataFrame, title: str, label: str, stem: Path) -> list[Path]:
    """Write a table for both columns and for one (`STEM.tex`, `STEM-column.tex`); return the files.

    Args:
        table: what to show; rows with the same first cell are one group.
        title: the caption; a number at its beginning is left out.
        label: to refer to it by.
        stem: of the files, without an ending.

    Raises:
        OSError: where one cannot be written.
    """
    files = []
    for ending in WIDTHS:
        files.append(stem.with_name(f"{stem.name}{ending}.tex"))
        files[-1].write_text(latex(table, title, label + ending, wide=not ending), encoding="utf-8")
    return files


def latex(table: pd.DataFrame, title: str, label: str, *, wide: bool = True) -> str:
    """Return a table as LaTeX floats that need booktabs alone.

    Args:
        table: what to show.
        title: the caption; a number at its beginning is left out.
        label: to refer to it by; further floats of a long table add their number.
        wide: over both columns (`table*`), else in one.
    """
    panels = _panels(table, WIDTHS[""] if wide else WIDTHS["-column"])
    floats = _floats(panels)
    environment = "table*" if wide else "table"
    caption = tex(NUMBERED.sub("", title))
    lines = []
    for number, bodies in enumerate(floats):
        part = f" ({number + 1} of {len(floats)})" if len(floats) > 1 else ""
        name = f"{label}-{number + 1}" if number else label
        lines += [rf"\begin{{{environment}}}[tp]", r"\centering", rf"\caption{{{caption}{part}}}\label{{{name}}}"]
        lines += [rf"\fontsize{{{SIZE:g}}}{{{LEAD:g}}}\selectfont\setlength{{\tabcolsep}}{{{SEPARATION:g}pt}}"]
        lines += [*_joined(bodies), rf"\end{{{environment}}}"]
    return "\n".join(lines) + "\n"


def _joined(bodies: Sequence[str]) -> list[str]:
    return [line for i, body in enumerate(bodies) for line in ([r"\par\medskip"] if i else []) + [body]]


def _wide(text: str) -> float:
    """Return how wide a text is [pt]."""
    return SIZE * sum(next((em for letters, em in EM.items() if letter in letters), 0.57) for letter in text)


def _pieces(text: str) -> list[str]:
    """Return what may stand on lines of its own; what has no blank before it is glued to the one before."""
    return PIECE.findall(text) or [""]


def _wrap(text: str, width: float) -> list[str]:
    """Return the lines of a text in a column of `width` [pt]."""
    lines, end = [""], 0
    for piece in PIECE.finditer(text):
        glue = " " if piece.start() > end else ""
        end = piece.end()
        longer = f"{lines[-1]}{glue}{piece[0]}" if lines[-1] else piece[0]
        if lines[-1] and _wide(longer) > width:
            lines.append(piece[0])
        else:
            lines[-1] = longer
    return lines


@dataclass(frozen=True, slots=True)
class _Panel:
    """Columns that stand side by side: their head and rows as texts, and their widths [pt]."""

    head: list[str]
    rows: list[list[str]]
    widths: list[float]

    def lines(self, row: Sequence[str]) -> int:
        """Return how many lines a row takes."""
        return max(len(_wrap(cell, width)) for cell, width in zip(row, self.widths, strict=True))


def _panels(table: pd.DataFrame, width: float) -> list[_Panel]:
    """Return a table in as few panels as its width asks for; what names a row stands in each."""
    head = [str(name) for name in table.columns]
    rows = [[" ".join(str(cell).split()) for cell in row] for row in table.itertuples(index=False)]
    if sum(map(_least, _columns(head, rows))) <= width:
        return [_panel(head, rows, range(len(head)), width)]
    names = _names(rows)
    if names is None or sum(map(_least, _columns(head, rows)[:names])) > width / 2:
        head, names = ["row", *head], 1
        rows = [[str(number), *row] for number, row in enumerate(rows, 1)]
    least = list(map(_least, _columns(head, rows)))
    chosen: list[list[int]] = []
    for index in range(names, len(head)):
        if not chosen or sum(least[at] for at in (*range(names), *chosen[-1], index)) > width:
            chosen.append([])
        chosen[-1].append(index)
    return [_panel(head, rows, [*range(names), *others], width) for others in chosen]


def _columns(head: list[str], rows: list[list[str]]) -> list[tuple[str, ...]]:
    return list(zip(head, *rows, strict=True))


def _least(column: Sequence[str]) -> float:
    """Return how wide a column is at least [pt]."""
    return max(_wide(piece) for cell in column for piece in _pieces(cell)) + 2 * SEPARATION


def _names(rows: list[list[str]]) -> int | None:
    """Return how many of the first columns tell all rows apart; None where it takes more than three."""
    for count in (1, 2, 3):
        if len({tuple(row[:count]) for row in rows}) == len(rows):
            return count
    return None


def _panel(head: list[str], rows: list[list[str]], chosen: Sequence[int], width: float) -> _Panel:
    columns = _columns(head, rows)
    natural = [max(map(_wide, columns[at])) + 2 * SEPARATION for at in chosen]
    widths = _widths([_least(columns[at]) for at in chosen], natural, width)
    shown = [[row[at] for at in chosen] for row in rows]
    return _Panel([head[at] for at in chosen], shown, [w - 2 * SEPARATION for w in widths])


def _widths(least: list[float], natural: list[float], width: float) -> list[float]:
    """Return the columns' widths: each its own where all fit, else none wider than a limit that makes them fit."""
    if sum(natural) <= width:
        return natural
    low, high = 0.0, max(natural)
    for _ in range(40):
        limit = (low + high) / 2
        fits = sum(max(a, min(b, limit)) for a, b in zip(least, natural, strict=True)) <= width
        low, high = (limit, high) if fits else (low, limit)
    return [max(a, min(b, low)) for a, b in zip(least, natural, strict=True)]


def _floats(panels: Sequence[_Panel]) -> list[list[str]]:
    """Return the bodies of each float: all panels of some rows."""
    count = len(panels[0].rows)
    heads = sum(panel.lines(panel.head) + 2 for panel in panels)
    parts: list[list[int]] = [[]]
    used = heads
    for index in range(count):
        taken = sum(panel.lines(panel.rows[index]) for panel in panels)
        if parts[-1] and used + taken > MOST_LINES:
            parts.append([])
            used = heads
        parts[-1].append(index)
        used += taken
    return [[_tabular(panel, part) for panel in panels] for part in parts]


def _tabular(panel: _Panel, part: Sequence[int]) -> str:
    """Return some rows of a panel as a `tabular`: rows with the same first cell are one group."""
    rows = [panel.rows[index] for index in part]
    groups = len({row[0] for row in panel.rows}) < len(panel.rows)
    last, body = "", list[str]()
    for row in rows:
        cells = list(row)
        if groups:
            body += [r"\midrule"] if body and cells[0] != last else []
            last, cells[0] = cells[0], "" if cells[0] == last else cells[0]
        body.append(_row(cells, panel.widths, "t"))
    align = "l" * min(2, len(panel.head)) + "c" * (len(panel.head) - 2)
    head = _row(panel.head, panel.widths, "b")
    start = [rf"\begin{{tabular}}{{@{{}}{align}@{{}}}}", r"\toprule", head, r"\midrule"]
    return "\n".join([*start, *body, r"\bottomrule", r"\end{tabular}"])


def _row(cells: Sequence[str], widths: Sequence[float], side: str) -> str:
    shown = [_cell(cell, width, side, at) for at, (cell, width) in enumerate(zip(cells, widths, strict=True))]
    return " & ".join(shown) + r" \\"


def _cell(text: str, width: float, side: str, at: int) -> str:
    """Return a cell; one of several lines is a table in the table, at the top or the bottom of its row."""
    lines = [tex(line) for line in _wrap(text, width)]
    if len(lines) == 1:
        return f"{{{lines[0]}}}" if lines[0].startswith("[") else lines[0]
    inner = r" \\ ".join(f"{{{line}}}" if line.startswith("[") else line for line in lines)
    return rf"\begin{{tabular}}[{side}]{{@{{}}{'l' if at < 2 else 'c'}@{{}}}}{inner}\end{{tabular}}"
