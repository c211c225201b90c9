"""The one writer of records: one at a time in a directory, each record on disk at once, none twice."""

from __future__ import annotations

import json
import os
from collections.abc import Hashable
from pathlib import Path
from types import TracebackType
from typing import Generic, Self

from smash.problem.errors import MalformedFile
from smash.records.files import R, RecordFile
from smash.records.locking import hold
from smash.records.reading import Reading, read


class Writer(Generic[R]):
    """A file of records, open for one writer; what an earlier one finished is kept.

    Attributes:
        path: The file.
        earlier: The records that were there when it was opened.
        finished: Keys of all records there.
        set_aside: Whether the last line was damaged, as a kill leaves it; it lies in the `.damaged` file now.

    Raises:
        InUse: where another process has the directory.
        MalformedFile: where the file is damaged elsewhere than in its last line, or cannot be read or written.
    """

    def __init__(self, directory: Path, kind: RecordFile[R]) -> None:
        self.path = kind.path(directory)
        self._lock = hold(directory)
        try:
            reading = read(directory, kind) if self.path.is_file() else None
            self.earlier: list[R] = [] if reading is None else self._repaired(reading, kind.aside(directory))
            self._file = open(self.path, "ab")  # noqa: SIM115 - open until `__exit__`
        except OSError as error:
            self._lock.close()
            raise MalformedFile(str(self.path), f"cannot be written: {error.strerror}") from None
        except MalformedFile:
            self._lock.close()
            raise
        self.set_aside = reading is not None and len(self.earlier) < len(reading.lines) + len(reading.damaged)
        self.finished: set[Hashable] = {record.key for record in self.earlier}

    def _repaired(self, reading: Reading[R], aside: Path) -> list[R]:
        """Move a last line that is damaged, or lacks its end, out of the file; return the records that stay."""
        reading.refuse_damage(but_last=True)
        if reading.ended and not reading.damaged:
            return reading.records
        with open(self.path, "rb") as file:
            file.seek(reading.begins)
            last = file.read()
        with open(aside, "ab") as kept:
            kept.write(last.rstrip(b"\n") + b"\n")
        os.truncate(self.path, reading.begins)
        return reading.records if reading.damaged else reading.records[:-1]

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
        try:
            self._file.write(json.dumps(record.document).encode() + b"\n")
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise MalformedFile(str(self.path), f"cannot be written: {error.strerror}") from None
        self.finished.add(record.key)
