"""Tables beside the pictures, as CSV, Markdown and text."""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import chain
from math import isnan
from pathlib import Path
from typing import Any

import pandas as pd

from smash.problem.words import counted
from smash_analysis.statistics.intervals import FEWEST_UNITS, Rate, is_range, wilson


def mean_std(values: pd.Series[float], digits: int = 2) -> str:
    """Return `mean ± std` as the paper prints it (sample standard deviation), or a dash without a value."""
    known = values.dropna()
    if known.empty:
        return "–"
    spread = known.std() if len(known) > 1 else 0.0
    return f"{known.mean():.{digits}f} ± {spread:.{digits}f}"


def median_iqr(values: pd.Series[float], digits: int = 2) -> str:
    """Return `median [first quartile, third quartile]`, or a dash without a value."""
    known = values.dropna()
    if known.empty:
        return "–"
    low, middle, high = known.quantile([0.25, 0.5, 0.75])
    return f"{middle:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


def of_seconds(show: Callable[[pd.Series[float]], str], values: pd.Series[float], digits: int = 2) -> str:
    """Return what `show` makes of seconds; of milliseconds, which it then says, where the middle would round to zero.

    Args:
        show: makes a text of numbers (`median_iqr`, `mean_std`).
        values: seconds.
        digits: that `show` shows behind the point.
    """
    small = 0 < values.median() < 0.5 * 10.0**-digits
    return f"{show(1000 * values)} ms" if small else show(values)


def share(successes: int, trials: int) -> str:
    """Return a share in percent with its 95 % Wilson interval."""
    low, high = wilson(successes, trials)
    return f"{100 * successes / trials:.0f} % [{100 * low:.0f}, {100 * high:.0f}]" if trials else "–"


SPREADS = (
    f"Behind a mean or ratio stands its 95 % bootstrap interval in brackets; with fewer than {FEWEST_UNITS} instances "
    "(or seeds of one instance), which carry no interval, their range in parentheses."
)
"""What `with_spread` shows, for a table's legend."""


def with_spread(value: float, ends: tuple[float, float], units: int, digits: int = 1) -> str:
    """Return a mean or ratio with its interval or range (`statistics.intervals.bootstrap`), or a dash without a value.

    Args:
        value: the mean or ratio.
        ends: of its interval or range; not shown where there are none (nan).
        units: how many it is made of.
        digits: shown behind the point.
    """
    if isnan(value):
        return "–"
    low, high = (f"{end:.{digits}f}" for end in ends)
    if isnan(ends[0]):
        return f"{value:.{digits}f}"
    return f"{value:.{digits}f} " + (f"({low} to {high})" if is_range(units) else f"[{low}, {high}]")


RATES = (
    "Success is the mean over instances of each one's own rate; its 95 % Wilson interval counts instances, not "
    "episodes: seeds of one instance are not independent, and so it is conservative."
)
"""What `rate_cell` shows, for a table's legend."""


def rate_cell(rate: Rate, trials: str) -> str:
    """Return a rate with its 95 % interval, the number of instances and of trials (in a word for one: episode, say)."""
    if not rate.units:
        return "–"
    low, high = rate.interval
    return f"{rate.mean:.2f} [{low:.2f}, {high:.2f}] of {rate.units} ({counted(rate.trials, trials)})"


_NUMBERS = re.compile(r"[-+]?[\d.][\d.,%±()\[\] –to-]*")
"""What begins with a sign and is no formula."""
_STRUCTURAL = re.compile(r'[",\r\n]')
"""What parts cells and lines of CSV."""


def write_csv(table: pd.DataFrame, file: Path) -> None:
    """Write a table as CSV; a text that a spreadsheet would take for a formula gets an apostrophe before it.

    Raises:
        OSError: where it cannot be written.
    """
    head = [_csv_text(str(name)) for name in table.columns]
    rows = zip(*(_csv_cells(column) for _, column in table.items()), strict=True)
    with file.open("w", encoding="utf-8", newline="") as stream:
        stream.writelines(",".join(row) + "\n" for row in chain([head], rows))


def _csv_cells(column: pd.Series[Any]) -> list[str]:
    """Return the cells of a column; each text of it is looked at once (pandas' own writer takes thrice as long)."""
    if pd.api.types.is_datetime64_any_dtype(column):
        return column.to_csv(index=False, header=False).replace('""', "").splitlines()
    values = column.astype("object").where(column.notna(), None).tolist()
    texts = {value: _csv_text(value) for value in set(values) if isinstance(value, str)}
    return ["" if value is None else texts[value] if isinstance(value, str) else str(value) for value in values]


def _csv_text(text: str) -> str:
    """Return a text as a cell says it: in quotes where it would not be one cell otherwise."""
    if text[:1] in ("=", "+", "-", "@") and not _NUMBERS.fullmatch(text):
        text = f"'{text}"
    return '"' + text.replace('"', '""') + '"' if _STRUCTURAL.search(text) else text


def ablation_table(runs: pd.DataFrame) -> pd.DataFrame:
    """Return the table beside the heatmaps: per planner, suite, buffers and variant at the largest budget.

    Args:
        runs: `runs_table` without the cut-off runs.
    """
    largest = runs.groupby(["label", "suite"])["budget"].transform("max")
    rows = []
    for (label, suite, buffers, variant), part in runs[runs["budget"] == largest].groupby(
        ["label", "suite", "buffers", "variant"]
    ):
        rows.append(
            {
                "planner": label,
                "suite": suite,
                "B": buffers,
                "variant": variant,
                "budget [s]": f"{part['budget'].iloc[0]:g}",
                "runs": len(part),
                "success": share(int(part["solved"].sum()), len(part)),
                "actions, solved runs (mean ± std)": mean_std(part["cost"]),
                "first plan [s] (median [IQR])": of_seconds(median_iqr, part["first_seconds"]),
                "proven optimal": f"{part['proven'].sum()}/{len(part)}",
            }
        )
    return pd.DataFrame(rows)


def markdown(table: pd.DataFrame) -> str:
    """Return a table as Markdown."""

    def line(cells: list[str]) -> str:
        return "| " + " | ".join(_cell(cell) for cell in cells) + " |"

    head = [str(column) for column in table.columns]
    body = [[str(cell) for cell in row] for row in table.itertuples(index=False)]
    return "\n".join([line(head), line(["---"] * len(head)), *map(line, body)]) + "\n"


def _cell(text: str) -> str:
    """Return a text as a cell of Markdown shows it."""
    return " ".join(text.split()).replace("\\", "\\\\").replace("|", "\\|").replace("<", "&lt;")
