"""How a guardian is started: the fork server of this process is asked for one.

The server is an interpreter of its own, started when it is first needed and kept for all runs of this process. Only
where this process is there for a single run, has one thread and has loaded nothing but this package, the server is a
copy of it: that spares a small plan at the command line a second interpreter and all its imports.
"""

from __future__ import annotations

import atexit
import json
import os
import selectors
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from pkgutil import resolve_name
from time import monotonic, sleep
from typing import IO

import psutil

from smash.experiments.isolation.job import load
from smash.experiments.isolation.leftovers import Left, clear_away
from smash.experiments.isolation.server import keep_only, request_line, search_path, serve
from smash.experiments.isolation.work import Work
from smash.problem.errors import SmashError

_ENDING = 10.0
"""Seconds that a guardian, or a server, has to end once its input is closed."""
_STARTING = 60.0
"""Seconds that a new server has to fork a guardian: it imports the package first."""
_FORKING = 10.0
"""Seconds that one has that has done so before."""
_SPELLS = 10
"""How often it may have as long, if it computes: the machine is busy, or code is compiled for the first time."""
_COMPUTES = 0.01
"""What part of a spell it has computed for, if it does not stand still."""
_ATTEMPTS = 3
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""What a server loads starts no threads: a copy of a process is whole only where that has one."""
_POLLING = 0.002
"""Seconds between two looks whether a server has ended."""


class Guardian:
    """A guardian at work.

    Attributes:
        stdin: closed, it tells the guardian to stop.
        stdout: the lines that it says.
        server: process id of the server that has forked it.
    """

    def __init__(self, stdin: int, stdout: int, status: int, pid: int, server: int) -> None:
        self.server = server
        self.stdin: IO[bytes] = os.fdopen(stdin, "wb")
        self.stdout: IO[bytes] = os.fdopen(stdout, "rb", 0)
        self._status = status
        self._process: psutil.Process | None = None
        with suppress(psutil.NoSuchProcess):  # it may have been killed already
            self._process = psutil.Process(pid)

    def wait(self, seconds: float) -> bool | None:
        """Return whether it ended well and left nothing, or None where it has not ended after so many seconds.

        Where the server was killed meanwhile nobody knows whether all went well: False.
        """
        line = _line(self._status, seconds)
        if line == b"" and self._process is not None:
            with suppress(psutil.NoSuchProcess):
                try:
                    self._process.wait(seconds)
                except psutil.TimeoutExpired:
                    return None
        return None if line is None else line == b"0"

    def kill(self) -> None:
        """End it, and what is below it."""
        if self._process is None:
            return
        with suppress(psutil.NoSuchProcess):
            for process in (*self._process.children(recursive=True), self._process):
                with suppress(psutil.NoSuchProcess):
                    process.kill()

    def close(self) -> None:
        """Close its files."""
        with suppress(BrokenPipeError):
            self.stdin.close()
        self.stdout.close()
        os.close(self._status)


@contextmanager
def guardian_of(job: Work, *, may_fork: bool) -> Iterator[Guardian]:
    """A guardian of a job; afterwards all of the run's processes are gone.

    Args:
        job: what it guards.
        may_fork: whether this process is there for this run alone.

    Raises:
        SmashError: where no process can be started.
    """
    if may_fork and _has_one_thread():
        with closing(ForkServer(job.loaded_by, copied=True)) as server, _ending(server, job) as guardian:
            yield guardian
        return
    with _ending(shared_server(job.loaded_by), job) as guardian:
        yield guardian


@contextmanager
def _ending(server: ForkServer, job: Work) -> Iterator[Guardian]:
    left = Left.by(os.urandom(16).hex())
    guardian = server.guardian(job, left)
    try:
        yield guardian
    finally:
        with suppress(BrokenPipeError):
            guardian.stdin.close()
        well = guardian.wait(_ENDING)
        if well is None:
            guardian.kill()
            well = guardian.wait(_ENDING)
        if well is None:
            server.replace(guardian)
        guardian.close()
        if not well:
            clear_away(left)


class ForkServer:
    """The server of this process: started when it is first asked, and again where it was killed.

    Args:
        loaded_by: of the work that it is asked for (`Work.loaded_by`).
        copied: whether it is a copy of this process, which has one thread, in place of an interpreter of its own.
    """

    def __init__(self, loaded_by: str, copied: bool = False) -> None:
        self._loaded_by = loaded_by
        self._copied = copied
        self._lock = threading.Lock()
        self._socket: socket.socket | None = None
        self._process = 0
        self._owner = 0
        self._has_forked = False

    def guardian(self, job: Work, left: Left) -> Guardian:
        """Have a guardian forked and tell it its job.

        Raises:
            SmashError: where that does not work out.
        """
        why = ""
        for _ in range(_ATTEMPTS):
            with self._lock:
                guardian = self._asked(left)
                if isinstance(guardian, str):
                    why = guardian
                    self._drop(patience=0.0)
                    continue
            with suppress(BrokenPipeError):
                guardian.stdin.write(request_line(job, left.mark))
                guardian.stdin.flush()
            return guardian
        raise SmashError(f"no process can be started for a run, after {_ATTEMPTS} attempts: {why}")

    def close(self) -> None:
        """Have it end, which it does once its guardians have, and wait for that."""
        with self._lock:
            if self._owner == os.getpid():
                self._drop(_ENDING)

    def replace(self, guardian: Guardian) -> None:
        """End the server that does not tell what became of a guardian; the next run starts another."""
        with self._lock:
            if self._process == guardian.server:
                self._drop(patience=0.0)

    def _asked(self, left: Left) -> Guardian | str:
        """Return a guardian that waits for its job; why there is none, where the server is gone or says nothing."""
        server = self._running()
        (asked, stdin), (stdout, told), (status, telling) = os.pipe(), os.pipe(), os.pipe()
        try:
            socket.send_fds(server, [json.dumps(asdict(left)).encode()], [asked, told, telling])
            sent = True
        except OSError:
            sent = False
        for number in (asked, told, telling):
            os.close(number)
        since = monotonic()
        words = self._said(status) if sent else b""
        if words:
            self._has_forked = True
            return Guardian(stdin, stdout, status, int(words), self._process)
        for number in (stdin, stdout, status):
            os.close(number)
        if words is None:
            return f"the process that starts them said nothing for {monotonic() - since:.1f} s ({load()})"
        return "the process that starts them ends at once"

    def _said(self, status: int) -> bytes | None:
        """Return the server's first line in a pipe, empty at its end; None where it stands still or takes too long."""
        patience = _FORKING if self._has_forked else _STARTING
        had = _computed(self._process)
        for _ in range(_SPELLS):
            words = _line(status, patience)
            if words is not None:
                return words
            before, had = had, _computed(self._process)
            if had - before < _COMPUTES * patience:
                break
        return None

    def _running(self) -> socket.socket:
        if self._socket is None or self._owner != os.getpid():
            self._socket, its = socket.socketpair()
            self._owner = os.getpid()
            self._has_forked = False
            self._process = (_copy if self._copied else _fresh)(its, self._loaded_by)
            its.close()
        return self._socket

    def _drop(self, patience: float) -> None:
        """Close the socket and collect the process, which is killed where it has not ended after `patience` seconds."""
        if self._socket is None:
            return
        self._socket.close()
        self._socket = None
        until = monotonic() + patience
        with suppress(ChildProcessError):
            while not os.waitpid(self._process, os.WNOHANG)[0]:
                if monotonic() >= until:
                    os.kill(self._process, signal.SIGKILL)
                sleep(_POLLING)


_SERVERS: dict[str, ForkServer] = {}
"""The servers of this process, by what they have loaded."""


def shared_server(loaded_by: str) -> ForkServer:
    """Return the server of all work of this process that has the same to be loaded."""
    return _SERVERS.setdefault(loaded_by, ForkServer(loaded_by))


def server_processes() -> set[int]:
    """Return the processes of the servers of this process that have been started."""
    return {server._process for server in _SERVERS.values() if server._process}


def _close_all() -> None:
    for server in _SERVERS.values():
        server.close()


atexit.register(_close_all)


def _fresh(connection: socket.socket, loaded_by: str) -> int:
    """Start a server in an interpreter of its own; return its process id."""
    begin = "import sys; sys.path[:] = {!r}; from smash.experiments.isolation.server import main; main({}, {!r})"
    program = begin.format(search_path(), connection.fileno(), loaded_by)
    process = subprocess.Popen(
        [sys.executable, "-P", "-c", program],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        pass_fds=[connection.fileno()],
        start_new_session=True,
        env={**os.environ, **ONE_THREAD},
    )
    process.returncode = 0  # collected by `ForkServer`, not by the object that goes here
    return process.pid


def _copy(connection: socket.socket, loaded_by: str) -> int:
    """Copy this process as a server; return its process id."""
    resolve_name(loaded_by)  # imported, lest each run does it
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # ignored, as some leave it, nothing is waited for
    sys.stdout.flush()
    sys.stderr.flush()
    process = os.fork()
    if not process:
        try:
            os.setsid()
            keep_only(os.open(os.devnull, os.O_RDONLY), os.open(os.devnull, os.O_WRONLY), connection.fileno())
            serve(socket.socket(fileno=3))
        finally:
            os._exit(0)
    return process


def _line(pipe: int, seconds: float) -> bytes | None:
    """Return the next line of a pipe, empty at its end, or None where there is none after so many seconds."""
    until, line = monotonic() + seconds, b""
    with selectors.DefaultSelector() as selector:
        selector.register(pipe, selectors.EVENT_READ)
        while selector.select(max(0.0, until - monotonic())):
            byte = os.read(pipe, 1)
            if byte in (b"", b"\n"):
                return line if byte else b""
            line += byte
    return None


def _computed(process: int) -> float:
    """Return how long a process has computed [s]."""
    with suppress(psutil.Error):
        times = psutil.Process(process).cpu_times()
        return float(times.user + times.system)
    return 0.0


def _has_one_thread() -> bool:
    """Return whether this process has one thread, those of libraries counted."""
    if sys.platform != "linux" or threading.active_count() > 1:
        return False
    try:
        return len(list(Path("/proc/self/task").iterdir())) == 1
    except OSError:
        return False
