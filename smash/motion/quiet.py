"""Libraries that write to standard output and standard error by themselves: kept from it."""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def redirected(to: int, *numbers: int) -> Iterator[None]:
    """Send to another descriptor what anybody, C libraries too, writes to these."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(number) for number in numbers]
    try:
        for number in numbers:
            os.dup2(to, number)
        yield
    finally:
        ctypes.CDLL(None).fflush(None)
        for number, copy in zip(numbers, kept, strict=True):
            os.dup2(copy, number)
            os.close(copy)


@contextmanager
def overheard() -> Iterator[Callable[[], str]]:
    """Keep standard error from what C++ writes to it; what the context gives tells what that was."""
    with tempfile.TemporaryFile() as heard, redirected(heard.fileno(), 2):

        def words() -> str:
            heard.seek(0)
            return heard.read().decode(errors="replace")

        yield words


def first_complaint(words: str, otherwise: str) -> str:
    """Return the first line that says what is wrong, without the library's own places."""
    for line in words.splitlines():
        said = line.strip().removeprefix("Error:").removeprefix("message:").strip()
        if said and not said.lower().startswith(("at line", "from file", "in function")):
            return said
    return otherwise
