"""The records that tables and figures are made of: believed ones, and on standard error what is left out."""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterable
from pathlib import Path

from smash.problem.words import one_line
from smash.records.believing import Believed, believed_runs
from smash.records.files import R, RecordFile
from smash.records.reading import finished
from smash.records.record import shown
from smash.records.runs import RunRecord

MOST_LINES = 20
"""Lines that are said of one file."""


def believed_of(results: Path, keys: Collection[str] | None = None) -> Believed:
    """Return the runs of a directory, or those that are meant, as they are believed; say what contradicts first.

    Raises:
        MalformedFile: where there are none, or they cannot be read.
    """
    found = believed_runs(results, keys)
    say(found.lines())
    return found


def runs_of(results: Path) -> list[RunRecord]:
    """Return the runs of a directory as tables and figures show them.

    Raises:
        MalformedFile: as `believed_of`.
    """
    return believed_of(results).records


def records_of(results: Path, kind: RecordFile[R]) -> list[R]:
    """Return the whole records of a file, for tables; say what of it does not count.

    Raises:
        MalformedFile: where there are none, or they cannot be read.
    """
    reading = finished(results, kind)
    say(reading.notes())
    return [shown(record) for record in reading.records]


def say(said: Iterable[str]) -> None:
    """Print lines on standard error, the first of many."""
    lines = list(said)
    for line in lines[:MOST_LINES]:
        print(one_line(line), file=sys.stderr)
    if len(lines) > MOST_LINES:
        print(f"and {len(lines) - MOST_LINES} more: `smash records check` has them all", file=sys.stderr)
