"""The `smash` command in this process: how it ended, what it said, how long it took and where it wrote."""

import io
import os
import signal
import sys
import tempfile
import traceback
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from time import process_time
from unittest import mock

from smash.cli import main

LONGEST = 5.0
"""The most that a command may take [s of a processor]."""
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_CHANGES = {
    "os.mkdir": 0,
    "os.rename": 1,
    "os.remove": 0,
    "os.rmdir": 0,
    "os.symlink": 1,
    "os.link": 1,
    "os.truncate": 0,
}
_BARE = {"os.truncate"}
"""Events that do not say which open folder a path is below."""
_watched: list[list[str]] = []


@dataclass(frozen=True)
class Ended:
    """How a command ended; `written` is every path that it opened to write, made, moved to or removed."""

    code: int | str
    said: str
    seconds: float
    written: list[str]


class TooLong(BaseException):
    """A command takes longer than `LONGEST`."""


def _note(event, arguments):
    if not _watched:
        return
    if event == "open" and isinstance(arguments[0], str | bytes | os.PathLike) and arguments[2] & _WRITES:
        _watched[-1].append(os.path.abspath(os.fsdecode(arguments[0])))
    elif event in _CHANGES:
        path, within = arguments[_CHANGES[event]], arguments[-1]
        if isinstance(path, str | bytes | os.PathLike) and (event in _BARE or within == -1):
            _watched[-1].append(os.path.abspath(os.fsdecode(path)))


sys.addaudithook(_note)


def _too_long(number, frame):
    raise TooLong("".join(traceback.format_stack(frame)[-3:]))


@contextmanager
def _at_most(seconds):
    earlier = signal.signal(signal.SIGPROF, _too_long)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, earlier)


def run(words, longest=60.0):
    """Run `smash WORDS` as its console script does, for at most `longest` seconds of a processor."""
    out, err = (io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in range(2))
    written: list[str] = []
    began = process_time()
    code: int | str = "did not exit"
    _watched.append(written)
    try:
        argv = mock.patch.object(sys, "argv", ["smash", *words])
        with redirect_stdout(out), redirect_stderr(err), argv, _at_most(longest):
            main()
    except SystemExit as ended:
        code = ended.code
    except TooLong as error:
        code = f"too long: {error}"
    except BaseException as error:
        code = "".join(traceback.format_exception(error)[-4:])
    finally:
        _watched.pop()
    said = b"".join(stream.buffer.getvalue() for stream in (out, err)).decode(errors="replace")
    return Ended(code, said, process_time() - began, written)


def outside(ended, *allowed):
    """The paths that were written outside of the allowed folders, of temporary files and of caches."""
    own = [f"{os.path.abspath(folder)}/" for folder in allowed]
    temporary = tuple(f"{tempfile.gettempdir()}/{name}" for name in ("smash", "tmp", "matplotlib"))
    return [
        path
        for path in ended.written
        if not f"{path}/".startswith((*own, *temporary, "/dev/", "/proc/self/"))
        and not any(part in path for part in ("__pycache__", "/matplotlib", "/.numba"))
    ]
