"""How the process that does a piece of work speaks: JSON lines on the pipe to its guardian."""

from __future__ import annotations

import json
import os
import sys
import threading
import traceback
from collections.abc import Callable
from typing import Any, NoReturn


class Voice:
    """The pipe to the guardian; any thread may speak."""

    def __init__(self, pipe: int) -> None:
        self._pipe = pipe
        self._lock = threading.Lock()

    def say(self, **message: Any) -> None:
        """Say one line."""
        line = memoryview(json.dumps(message).encode() + b"\n")
        with self._lock:
            while line:
                line = line[os.write(self._pipe, line) :]


def to_its_end(voice: Voice, do: Callable[[], None]) -> NoReturn:
    """Do the work and end the process; nothing is left to the interpreter's shutdown, where threads can hang.

    What it fails of is said as `failed`.
    """
    try:
        do()
    except MemoryError as error:
        voice.say(kind="failed", outcome="memory", reason=_words(error))
    except BaseException as error:
        voice.say(kind="failed", outcome="crashed", reason=_words(error))
        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


def _words(error: BaseException) -> str:
    """Return the exception in one line, with the place where it was raised."""
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({os.path.basename(frames[-1].filename)}:{frames[-1].lineno})" if frames else ""
    return " ".join(f"{type(error).__name__}: {error}".split())[:500] + place
