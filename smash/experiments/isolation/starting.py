"""How a guardian is started: in a fresh interpreter, or forked where the caller is there for this run alone.

Forking copies the one thread that forks and whatever locks others hold, and the memory of the caller counts as the
run's; so only a process of one thread that has loaded nothing but this package, and has started nothing else, does it.
It spares a small plan at the command line a second interpreter and all its imports.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic, sleep
from typing import IO, NoReturn

from smash.experiments.isolation.guardian import MARK, guard, scratch_prefix
from smash.experiments.isolation.job import Job
from smash.experiments.isolation.lifetime import adopting_orphans

_POLLING = 0.002
"""Seconds between two looks whether a forked guardian has ended."""
_ENDING = 10.0
"""Seconds that a guardian has to end once its input is closed."""


class Guardian(ABC):
    """A guardian at work.

    Attributes:
        stdin: closed, it tells the guardian to stop.
        stdout: the lines that it says.
    """

    stdin: IO[bytes]
    stdout: IO[bytes]

    @abstractmethod
    def wait(self, seconds: float) -> int | None:
        """Return its exit code, or None where it has not ended after so many seconds."""

    @abstractmethod
    def kill(self) -> None:
        """End it."""


@contextmanager
def guardian_of(job: Job, *, may_fork: bool) -> Iterator[Guardian]:
    """A guardian of a job; afterwards all of the run's processes are gone.

    Args:
        job: what it guards.
        may_fork: whether this process is there for this run alone.
    """
    mark = os.urandom(16).hex()
    if not may_fork or not _has_one_thread():
        with _ending(_Fresh(job, mark), mark) as guardian:
            yield guardian
        return
    with adopting_orphans(), _ending(_Forked(job, mark), mark) as guardian:
        yield guardian


@contextmanager
def _ending(guardian: Guardian, mark: str) -> Iterator[Guardian]:
    try:
        yield guardian
    finally:
        with suppress(BrokenPipeError):
            guardian.stdin.close()
        code = guardian.wait(_ENDING)
        if code is None:
            guardian.kill()
            guardian.wait(_ENDING)
        guardian.stdout.close()
        if code != 0:
            _end_marked(mark)


class _Fresh(Guardian):
    """A guardian in an interpreter of its own, which is told its job on its input."""

    def __init__(self, job: Job, mark: str) -> None:
        here = "import sys; sys.path[:] = {!r}; from smash.experiments.isolation.guardian import main; main()"
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-c", here.format([os.path.abspath(entry) for entry in sys.path])],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, MARK: mark},
            start_new_session=True,
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self.stdin, self.stdout = self._process.stdin, self._process.stdout
        with suppress(BrokenPipeError):
            self.stdin.write(json.dumps(job.document()).encode() + b"\n")
            self.stdin.flush()

    def wait(self, seconds: float) -> int | None:
        """Return its exit code, or None where it has not ended after so many seconds."""
        try:
            return self._process.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            return None

    def kill(self) -> None:
        """End it."""
        self._process.kill()


class _Forked(Guardian):
    """A guardian that is a copy of this process."""

    def __init__(self, job: Job, mark: str) -> None:
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # ignored, as some leave it, nothing is waited for
        sys.stdout.flush()
        sys.stderr.flush()
        asking, telling = os.pipe(), os.pipe()
        self._process = os.fork()
        if not self._process:
            _be_guardian(job, mark, asking[0], telling[1])
        os.close(asking[0])
        os.close(telling[1])
        self.stdin, self.stdout = os.fdopen(asking[1], "wb", 0), os.fdopen(telling[0], "rb", 0)

    def wait(self, seconds: float) -> int | None:
        """Return its exit code, or None where it has not ended after so many seconds."""
        until = monotonic() + seconds
        while True:
            done, status = os.waitpid(self._process, os.WNOHANG)
            if done:
                return os.waitstatus_to_exitcode(status)
            if monotonic() >= until:
                return None
            sleep(_POLLING)

    def kill(self) -> None:
        """End it."""
        os.kill(self._process, signal.SIGKILL)


def _be_guardian(job: Job, mark: str, asked: int, told: int) -> NoReturn:
    """In the copy: keep nothing of the caller's but its memory, guard the job, and end."""
    code = 1
    try:
        os.setsid()
        os.environ[MARK] = mark
        nothing = os.open(os.devnull, os.O_RDWR)
        for source, target in ((asked, 0), (told, 1), (nothing, 2)):
            os.dup2(source, target)
        for number in [int(name) for name in os.listdir("/proc/self/fd")]:
            if number > 2:
                with suppress(OSError):
                    os.close(number)
        sys.stdin, sys.stdout, sys.stderr = open(0), open(1, "w"), open(2, "w")  # noqa: SIM115 - until the end
        guard(job)
        code = 0
    except SystemExit as ended:
        code = ended.code if isinstance(ended.code, int) else 1
    finally:
        os._exit(code)


def _has_one_thread() -> bool:
    """Return whether this process has one thread, those of libraries counted."""
    if sys.platform != "linux" or threading.active_count() > 1:
        return False
    try:
        return len(list(Path("/proc/self/task").iterdir())) == 1
    except OSError:
        return False


def _end_marked(mark: str) -> None:
    """End what a killed guardian has left behind, found by the mark in its environment, and its scratch folder."""
    import psutil

    for process in psutil.process_iter():
        with suppress(psutil.Error, OSError):
            if process.environ().get(MARK) == mark:
                process.kill()
    for folder in Path(tempfile.gettempdir()).glob(f"{scratch_prefix(mark)}*"):
        shutil.rmtree(folder, ignore_errors=True)
