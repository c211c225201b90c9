"""One writer at a time in a results directory."""

from __future__ import annotations

import fcntl
from pathlib import Path
from typing import TextIO

from smash.problem.errors import MalformedFile, SmashError


class InUse(SmashError):
    """Another process is writing to the same directory."""


def hold(directory: Path) -> TextIO:
    """Make the directory where it is missing, and hold it until the returned file is closed, or the process ends.

    Raises:
        InUse: where another process holds it.
        MalformedFile: where it cannot be written.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
        lock = open(directory / ".lock", "w")  # noqa: SIM115 - held until closed
    except OSError as error:
        raise MalformedFile(str(directory), f"cannot be written: {error.strerror}") from None
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        lock.close()
        raise InUse(f"{directory}: another run is writing there; wait for it, or give another --out") from None
    return lock
