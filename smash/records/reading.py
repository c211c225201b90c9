"""The one reader of records: whole typed records, and every line that is none with its number and the reason."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Generic

import msgspec

from smash.problem.errors import MalformedFile
from smash.problem.files.documents import read_bytes
from smash.records.files import RUNS, R, RecordFile
from smash.records.record import decoded
from smash.records.runs import RunRecord

NO_JSON = "no JSON"


class NoRecords(MalformedFile):
    """A file without a whole record."""


@dataclass(frozen=True, slots=True)
class Line(Generic[R]):
    """A whole record, and the number of its line from 1."""

    number: int
    record: R


@dataclass(frozen=True, slots=True)
class Damaged:
    """A line that is no record: its number from 1, why, and whether it is the last, as a kill leaves it."""

    number: int
    reason: str
    last: bool


@dataclass(frozen=True, slots=True)
class Reading(Generic[R]):
    """What a file holds.

    Attributes:
        path: The file.
        lines: Every whole line, in their order.
        damaged: Every other line.
        begins: Where the last line begins [bytes].
        ended: Whether it has its end: a file that was cut off there must not be added to.
    """

    path: Path
    lines: list[Line[R]]
    damaged: list[Damaged]
    begins: int
    ended: bool

    @property
    def records(self) -> list[R]:
        """The whole records."""
        return [line.record for line in self.lines]

    def refuse_damage(self, but_last: bool = False) -> None:
        """Refuse a file with a damaged line, `but_last`: elsewhere than in its last line.

        Raises:
            MalformedFile: which names the first such line.
        """
        for line in self.damaged:
            if not (but_last and line.last):
                where = f"{self.path}:{line.number}"
                raise MalformedFile(where, f"{line.reason}; set the line aside and start again")


def read(results: Path, kind: RecordFile[R], escaped: bool = False) -> Reading[R]:
    """Read a file of records.

    Args:
        results: the directory that holds it.
        kind: which file.
        escaped: whether names that are no Unicode text are escaped, for tables and pages (`record.decoded`).

    Raises:
        MalformedFile: where it cannot be read.
    """
    path = kind.path(results)
    content = read_bytes(path)
    texts = content.removesuffix(b"\n").split(b"\n") if content else []
    lines, damaged = [], []
    for number, text in enumerate(texts, start=1):
        try:
            lines.append(Line(number, decoded(text, kind.record, escaped)))
        except msgspec.ValidationError as error:
            damaged.append(Damaged(number, f"no {kind.format} object: {error}", number == len(texts)))
        except (ValueError, RecursionError):
            damaged.append(Damaged(number, NO_JSON, number == len(texts)))
    begins = len(content.removesuffix(b"\n")) - len(texts[-1]) if texts else 0
    return Reading(path, lines, damaged, begins, content.endswith(b"\n") or not content)


def finished(results: Path, kind: RecordFile[R]) -> list[R]:
    """Return what tables and pages are made from: all records, but for a damaged last line (a kill's trace).

    Raises:
        NoRecords: where there are none.
        MalformedFile: where it cannot be read, or a line before the last is damaged.
    """
    reading = read(results, kind, escaped=True)
    reading.refuse_damage(but_last=True)
    if not reading.lines:
        raise NoRecords(str(reading.path), f"no finished {kind.one}")
    return reading.records


def finished_runs(results: Path, keys: Collection[str] | None = None) -> list[RunRecord]:
    """Return the `finished` runs of a directory, or those of them that are meant.

    Raises:
        MalformedFile: as `finished`, and where runs under one label are of several solvers.
    """
    runs = [run for run in finished(results, RUNS) if keys is None or run.key in keys]
    if not runs:
        raise NoRecords(str(RUNS.path(results)), f"no finished {RUNS.one}")
    _expect_one_solver(runs, str(RUNS.path(results)))
    return runs


def _expect_one_solver(runs: Iterable[RunRecord], where: str) -> None:
    """Refuse runs that stand under one label and were solved by several solvers: a table would mix them."""
    solvers: dict[str, str] = {}
    for run in runs:
        other = solvers.setdefault(run.label, run.solver)
        if other != run.solver:
            words = f"runs labelled {run.label!r} are of the solvers {other} and {run.solver}"
            raise MalformedFile(where, f"{words}; tables do not mix solvers, give each a label of its own")
