"""The datasheet of a data set: what it is for, how it was made, what it does not say (after Gebru et al., 2021)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

SHEET = Path(__file__).with_name("datasheet.md")
"""Its words; what stands in braces is filled in."""


def datasheet(rows: Sequence[dict[str, Any]]) -> str:
    """Return the datasheet of a data set with these rows of `problems.csv`."""
    sets = Counter(row["set"] for row in rows)
    optimal = Counter(row["set"] for row in rows if row["status"] == "optimal")
    lines = [f"| {name} | {count} | {optimal[name]} | {count - optimal[name]} |" for name, count in sets.items()]
    return SHEET.read_text(encoding="utf-8").format(
        count=len(rows),
        instances=len({row["instance"] for row in rows}),
        optimal=optimal.total(),
        open=len(rows) - optimal.total(),
        sets="\n".join(lines),
    )
