"""Tables on a terminal: where one is wider than the terminal its columns go on below, and nothing is cut."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from smash.problem.words import visible

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import Console
    from rich.table import Table

WIDE = 120
"""Columns of what is no terminal, unless COLUMNS says another number."""


def console() -> Console:
    """Return standard output as wide as the terminal, as COLUMNS says, or as `WIDE` where neither tells."""
    from rich.console import Console

    output = Console()
    if not output.is_terminal and "COLUMNS" not in os.environ:
        output.width = WIDE
    return output


def show(rows: pd.DataFrame, title: str) -> None:
    """Print a table whose first column names its rows; a part that does not fit goes on below under the same names.

    Args:
        rows: what to print.
        title: stands above.
    """
    from rich.measure import Measurement

    output = console()
    names = list(range(rows.shape[1]))
    parts: list[list[int]] = [names[:1]]
    for column in names[1:]:
        wider = [*parts[-1], column]
        needs = Measurement.get(output, output.options.update(width=10_000), _table(rows.iloc[:, wider], "")).maximum
        if needs > output.width and len(parts[-1]) > 1:
            parts.append([0, column])
        else:
            parts[-1] = wider
    for number, part in enumerate(parts):
        output.print(_table(rows.iloc[:, part], f"{title}, continued" if number else title))


def _table(rows: pd.DataFrame, title: str) -> Table:
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(visible(title)) if title else None, title_justify="left")
    for number, column in enumerate(rows.columns):
        table.add_column(Text(visible(str(column))), overflow="fold", no_wrap=not number)
    for row in rows.itertuples(index=False):
        table.add_row(*(Text(visible(str(cell))) for cell in row))
    return table
