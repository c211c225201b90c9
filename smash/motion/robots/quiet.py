"""Libraries that write what is wrong to standard error by themselves: kept from it, for an error of ours to say."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def overheard() -> Iterator[Callable[[], str]]:
    """Keep standard error from what C++ writes to it; what the context gives tells what that was."""
    sys.stderr.flush()
    kept = os.dup(2)
    with tempfile.TemporaryFile() as heard:
        os.dup2(heard.fileno(), 2)

        def words() -> str:
            heard.seek(0)
            return heard.read().decode(errors="replace")

        try:
            yield words
        finally:
            os.dup2(kept, 2)
            os.close(kept)


def first_complaint(words: str, otherwise: str) -> str:
    """Return the first line that says what is wrong, without the library's own places."""
    for line in words.splitlines():
        said = line.strip().removeprefix("Error:").removeprefix("message:").strip()
        if said and not said.lower().startswith(("at line", "from file", "in function")):
            return said
    return otherwise
