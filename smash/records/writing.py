"""The one writer of records: one at a time in a directory, each record on disk at once, none twice."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Hashable, Iterable
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Generic, Self

from smash.problem.errors import MalformedFile
from smash.problem.files.documents import replacing
from smash.records.files import R, RecordFile
from smash.records.locking import hold
from smash.records.reading import read


class Writer(Generic[R]):
    """A file of records, open for one writer; what an earlier one finished is kept.

    Attributes:
        path: The file.
        earlier: The records that were there when it was opened, each key once.
        finished: Keys of all records there.
        redone: How many records were moved to the `.redone` file, to be done again.
        set_aside: In words, each line that was damaged, or cut off by a kill; they lie in the `.damaged` file now.

    Args:
        directory: the results directory.
        kind: which file.
        again: the records that are to be done again, for which this is true; None: none of them.

    Raises:
        InUse: where another process has the directory.
        MalformedFile: where the file cannot be read or written.
    """

    def __init__(self, directory: Path, kind: RecordFile[R], again: Callable[[R], bool] | None = None) -> None:
        self.path = kind.path(directory)
        self._lock = hold(directory)
        self._again: Callable[[R], bool] = again or (lambda _: False)
        self.redone = 0
        try:
            self.earlier: list[R]
            self.set_aside: list[str]
            self.earlier, self.set_aside = self._repaired(directory, kind) if self.path.is_file() else ([], [])
            self._file = open(self.path, "ab", buffering=0)  # noqa: SIM115 - open until `__exit__`
        except OSError as error:
            self._lock.close()
            raise MalformedFile(str(self.path), f"cannot be written: {error.strerror}") from None
        except MalformedFile:
            self._lock.close()
            raise
        self.finished: set[Hashable] = {record.key for record in self.earlier}

    def _repaired(self, directory: Path, kind: RecordFile[R]) -> tuple[list[R], list[str]]:
        """Move lines that are damaged, or lack their end, out of the file; return the records that stay, and words."""
        reading = read(directory, kind)
        moved = {line.number: f"line {line.number}: {line.reason}" for line in reading.damaged}
        texts = self.path.read_bytes().removesuffix(b"\n").split(b"\n")
        if not reading.ended:
            moved.setdefault(len(texts), f"line {len(texts)}: cut off at its end")
        again = {line.number for line in reading.lines if line.number not in moved and self._again(line.record)}
        if not moved and not again:
            return reading.records, []
        self.redone = len(again)
        for target, numbers in ((kind.aside(directory), set(moved)), (kind.redone(directory), again)):
            if numbers:
                _add(target, [text for number, text in enumerate(texts, start=1) if number in numbers])
        stay = [text for number, text in enumerate(texts, start=1) if number not in again.union(moved)]
        with replacing(self.path) as whole:
            _add(whole, stay)
        return read(directory, kind).records, [f"{self.path}: {moved[number]}" for number in sorted(moved)]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
        self._lock.close()

    def append(self, record: R) -> None:
        """Write one record and have it on disk before this returns; nothing is written twice.

        Raises:
            MalformedFile: where it cannot be written (a full disk).
        """
        if record.key in self.finished:
            return
        before = os.fstat(self._file.fileno()).st_size
        left = memoryview(json.dumps(record.document).encode() + b"\n")
        try:
            while left:
                left = left[self._file.write(left) :]
            os.fsync(self._file.fileno())
        except OSError as error:
            with suppress(OSError):
                self._file.truncate(before)  # no half of a record stays
            raise MalformedFile(str(self.path), f"cannot be written: {error.strerror}") from None
        self.finished.add(record.key)


def _add(file: Path, lines: Iterable[bytes]) -> None:
    """Add lines to a file and have them on disk."""
    with open(file, "ab") as kept:
        kept.writelines(line + b"\n" for line in lines)
        kept.flush()
        os.fsync(kept.fileno())
