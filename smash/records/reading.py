"""The one reader of records: whole typed records, and every line that is none with its number and the reason."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Generic

import msgspec

from smash.problem.errors import MalformedFile
from smash.problem.files.documents import read_bytes
from smash.records.files import R, RecordFile
from smash.records.record import decoded
from smash.records.sharing import Sharing, kept_objects

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
        one: What one line tells of, in a word.
        lines: Every whole line, in their order.
        damaged: Every other line.
        ended: Whether the last line has its end: a file that was cut off there must not be added to.
    """

    path: Path
    one: str
    lines: list[Line[R]]
    damaged: list[Damaged]
    ended: bool

    @property
    def records(self) -> list[R]:
        """The whole records, each key once: of lines with equal keys the first counts."""
        return list({line.record.key: line.record for line in reversed(self.lines)}.values())[::-1]

    def repeated(self) -> Iterator[tuple[Line[R], Line[R]]]:
        """Yield every line whose key an earlier one has, and that one."""
        first: dict[Hashable, Line[R]] = {}
        for line in self.lines:
            earlier = first.setdefault(line.record.key, line)
            if earlier is not line:
                yield line, earlier

    def notes(self) -> Iterator[str]:
        """Yield in words what of the file does not count."""
        for damaged in self.damaged:
            yield f"{self.path}:{damaged.number}: {damaged.reason}; left out, a resumed run does its {self.one} again"
        for line, earlier in self.repeated():
            yield f"{self.path}:{line.number}: has the key of line {earlier.number}; counted once"


def read(results: Path, kind: RecordFile[R]) -> Reading[R]:
    """Read a file of records.

    Raises:
        MalformedFile: where it cannot be read.
    """
    path = kind.path(results)
    content = read_bytes(path)
    texts = content.removesuffix(b"\n").split(b"\n") if content else []
    shared: Sharing[R] = Sharing()
    lines, damaged = [], []
    with kept_objects():
        for number, text in enumerate(texts, start=1):
            try:
                lines.append(Line(number, shared(decoded(text, kind.record))))
            except msgspec.ValidationError as error:
                damaged.append(Damaged(number, f"no {kind.format} object: {error}", number == len(texts)))
            except RecursionError:
                damaged.append(Damaged(number, f"{NO_JSON}: nested too deeply", number == len(texts)))
            except ValueError as error:
                damaged.append(Damaged(number, f"{NO_JSON}: {error}", number == len(texts)))
    return Reading(path, kind.one, lines, damaged, content.endswith(b"\n") or not content)


def finished(results: Path, kind: RecordFile[R]) -> Reading[R]:
    """Return what a file holds that has something to show.

    Raises:
        NoRecords: where there is no whole record.
        MalformedFile: where the file cannot be read.
    """
    reading = read(results, kind)
    if not reading.lines:
        why = next((f"; line {line.number}: {line.reason}" for line in reading.damaged), "")
        raise NoRecords(str(reading.path), f"no finished {kind.one}{why}")
    return reading
