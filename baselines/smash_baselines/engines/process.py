"""Engines as processes: each in a group of its own, with limits, that never outlives its caller."""

from __future__ import annotations

import contextlib
import ctypes
import os
import resource
import selectors
import signal
import subprocess
import sys
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from time import monotonic
from types import TracebackType

import psutil

MEMORY_LIMIT = 2 << 30
"""Default memory limit of an engine, all its processes together [bytes]."""

_LINE_TAIL = 30
_WATCH_SECONDS = 0.2
_PR_SET_PDEATHSIG = 1


def dies_with_parent(address_space: int | None = None) -> Callable[[], None]:
    """Return a function for a child to run before its program starts.

    It asks the kernel to kill the child when the thread that started it ends, however it ends (Linux; elsewhere
    only an orderly end of the caller kills it), writes no core file, and bounds the child's address space.

    Args:
        address_space: limit [bytes], or None.
    """
    parent = os.getpid()
    libc = ctypes.CDLL(None, use_errno=True) if sys.platform == "linux" else None

    def prepare() -> None:
        if libc is not None:
            libc.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
            if os.getppid() != parent:  # it died before the line above
                os._exit(1)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if address_space is not None:
            resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))

    return prepare


class EngineProcess:
    """One run of an engine: its output by line, until it ends, a deadline passes or it takes too much memory.

    A context manager: on leaving, however it is left, the whole process group is killed and reaped.

    Attributes:
        deadline: when it is killed, on the clock of `time.monotonic` [s]; may be set anew while it runs.
        timed_out: whether it was killed then.
        out_of_memory: whether it was killed at its memory limit.
        tail: its last lines.
    """

    def __init__(
        self,
        command: Sequence[str],
        *,
        directory: Path,
        deadline: float,
        memory: int = MEMORY_LIMIT,
        limit_address_space: bool = True,
        stdin: Path | None = None,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        """Start `command` in `directory`.

        Args:
            command: program and arguments.
            directory: its working directory.
            deadline: when it is killed, on the clock of `time.monotonic` [s].
            memory: limit [bytes]: as an address space limit where the engine can live with one (its own "out of
                memory" is then clean), and by watching the group's resident memory always.
            limit_address_space: False for Java, which reserves more than it uses.
            stdin: file to read from; nothing, where None.
            environment: variables to set beside the caller's.
        """
        self.deadline = deadline
        self._memory = memory
        self.timed_out = False
        self.out_of_memory = False
        self.tail: deque[str] = deque(maxlen=_LINE_TAIL)
        with open(os.devnull if stdin is None else stdin, "rb") as source:
            self._process = subprocess.Popen(
                list(command),
                cwd=directory,
                stdin=source,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env={**os.environ, **(environment or {})},
                preexec_fn=dies_with_parent(memory if limit_address_space else None),
            )

    def __enter__(self) -> EngineProcess:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.kill()

    @property
    def pid(self) -> int:
        """Process id, and id of the process group."""
        return self._process.pid

    def kill(self) -> None:
        """Kill the whole group, if anything of it is left, and reap the engine."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()

    def lines(self, look: Callable[[], None] | None = None) -> Iterator[str]:
        """Yield the output line by line, as it comes; stop at the deadline or above the memory limit.

        It ends with the engine too, whoever else still holds its output open.

        Args:
            look: called every now and then, for what the engine leaves elsewhere.
        """
        assert self._process.stdout is not None
        descriptor = self._process.stdout.fileno()
        rest = b""
        watched = monotonic()
        with selectors.DefaultSelector() as selector:
            selector.register(descriptor, selectors.EVENT_READ)
            while True:
                now = monotonic()
                if now >= self.deadline:
                    self.timed_out = True
                    break
                if now - watched >= _WATCH_SECONDS:
                    watched = now
                    if self._group_memory() > self._memory:
                        self.out_of_memory = True
                        break
                    if look is not None:
                        look()
                ended = self._process.poll() is not None
                if not selector.select(0 if ended else min(_WATCH_SECONDS, self.deadline - now)):
                    if ended:
                        break
                    continue
                chunk = os.read(descriptor, 1 << 16)
                if not chunk:
                    break
                *whole, rest = (rest + chunk).split(b"\n")
                yield from map(self._line, whole)
        if rest:
            yield self._line(rest)

    def returncode(self) -> int | None:
        """Return the engine's exit code once its output has ended; None where it was killed at a limit."""
        if self.timed_out or self.out_of_memory:
            self.kill()
            return None
        try:
            return self._process.wait(timeout=max(0.1, self.deadline - monotonic()))
        except subprocess.TimeoutExpired:
            self.timed_out = True
            self.kill()
            return None

    def _line(self, raw: bytes) -> str:
        line = raw.decode("utf-8", "replace").rstrip("\r")
        self.tail.append(line)
        return line

    def _group_memory(self) -> int:
        total = 0
        with contextlib.suppress(psutil.Error):
            engine = psutil.Process(self._process.pid)
            for process in (engine, *engine.children(recursive=True)):
                with contextlib.suppress(psutil.Error):
                    total += process.memory_info().rss
        return total
