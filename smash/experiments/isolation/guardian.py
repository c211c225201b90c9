"""The guardian: a small process between a run and whoever asked for it, which no planner outlives.

It forks the planner's process, passes on the JSON lines that this one says, and watches three limits: wall
time (budget and grace), memory (resident set of the whole tree and its shared memory; what it prints and writes to
its scratch folder may not be more either) and start-up. It ends the whole tree (Fast
Downward, Java, whatever was started, in sessions of their own too) when a limit is hit, when the planner
has answered, and when its own standard input closes: that is how a caller stops it, and what the kernel
does where the caller is killed. If the guardian itself is killed, the planner's process dies with it.
"""

from __future__ import annotations

import faulthandler
import json
import os
import resource
import selectors
import shutil
import signal
import sys
import tempfile
from contextlib import suppress
from pkgutil import resolve_name
from time import monotonic, sleep
from types import FrameType
from typing import Any, BinaryIO, NoReturn

import psutil

from smash.experiments.isolation.job import STARTUP_LIMIT, grace, load, still_running
from smash.experiments.isolation.leftovers import Left, end_tree, scratch_prefix
from smash.experiments.isolation.lifetime import adopt_orphans, end_with_parent
from smash.experiments.isolation.lines import Lines
from smash.experiments.isolation.shared_memory import SharedMemory, mapped, set_apart
from smash.experiments.isolation.work import Work

_LOST = 1
"""Exit code of a planner's process that cannot even say what happened."""
_PIPES = 32
"""Reads after which whatever a pipe held has been read."""
_ENDING = 10.0
"""Seconds that the planner's process has to be gone once it was killed."""
SAMPLING = 0.1
"""Seconds between two looks at the tree's memory."""
SAID_LINES = 20


def guard(job: Work, left: Left, apart: bool) -> None:
    """Run a job, write what happens to standard output, and end it where standard input closes.

    Args:
        job: the run.
        left: how its scratch folder is called, and where it lies.
        apart: whether it may have shared memory of its own.
    """
    signal.signal(signal.SIGTERM, _leave)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    adopt_orphans(True)
    shared = SharedMemory(apart and set_apart(job.memory))
    scratch = ""
    try:
        scratch = tempfile.mkdtemp(prefix=scratch_prefix(left.mark), dir=left.folder)
        with open(os.path.join(scratch, "said.txt"), "w+b") as said:
            _guard(job, said, scratch, shared)
    except OSError as error:
        where = error.filename or scratch or left.folder
        words = f"{where}: a run cannot write there: {error.strerror}"
        _say(
            json.dumps(
                {"kind": "failed", "at": 0.0, "by": "guardian", "outcome": "malformed", "reason": words}
            ).encode()
        )
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def _guard(job: Work, said: BinaryIO, scratch: str, shared: SharedMemory) -> None:
    os.environ["TMPDIR"] = scratch
    tempfile.tempdir = None
    pipe, planner = _start(job, said)
    watch = _Watch(job, planner, pipe, said, scratch, shared)
    try:
        watch.run()
    finally:
        watch.end_all()
        shared.clear()


def _leave(signum: int, frame: FrameType | None) -> NoReturn:
    raise SystemExit(128 + signum)


def _start(job: Work, said: BinaryIO) -> tuple[int, int]:
    """Fork the planner's process; return the pipe on which it talks and its process id."""
    reading, writing = os.pipe()
    guardian = os.getpid()
    planner = os.fork()
    if planner:
        os.close(writing)
        os.set_blocking(reading, False)
        return reading, planner
    try:
        end_with_parent(guardian)
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, signal.SIG_DFL)
        os.close(reading)
        nothing = os.open(os.devnull, os.O_RDONLY)
        for source, target in ((nothing, 0), (said.fileno(), 1), (said.fileno(), 2)):
            os.dup2(source, target)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        faulthandler.enable()
        resolve_name(job.done_by)(job, writing)
    finally:
        os._exit(_LOST)


class _Watch:
    """Passes on what the planner says, and ends it at its limits."""

    def __init__(self, job: Work, planner: int, pipe: int, said: BinaryIO, scratch: str, shared: SharedMemory) -> None:
        self.job = job
        self.shared = shared
        self.scratch = scratch
        self.planner = planner
        self.pipe = pipe
        self.said = said
        self.lines = Lines()
        self.started: float | None = None
        self.deadline = monotonic() + STARTUP_LIMIT
        self.peak = 0.0
        self.cpu: float | None = None
        self.answered = False
        self.status: int | None = None

    def run(self) -> None:
        """Watch until the planner has answered, ended or hit a limit; then say how it ended."""
        with selectors.DefaultSelector() as selector:
            selector.register(sys.stdin.fileno(), selectors.EVENT_READ)
            selector.register(self.pipe, selectors.EVENT_READ)
            next_look = monotonic()
            while True:
                pause = max(0.0, min(self.deadline, next_look) - monotonic())
                ready = {key.fd for key, _ in selector.select(pause)}
                if sys.stdin.fileno() in ready and not os.read(sys.stdin.fileno(), 4096):
                    return self._drain()  # what it had said before it was stopped counts
                if self.pipe in ready and not self._pass_on():
                    selector.unregister(self.pipe)
                    self._reap(patience=1.0)
                if monotonic() >= next_look:
                    self._reap()
                    if (beyond := self._beyond_memory()) is not None:
                        return self._ended("memory", beyond)
                    next_look = monotonic() + SAMPLING
                if self.answered or self.status is not None:
                    self._drain()
                    self._reap(patience=0.5)
                    return self._ended(*self._at_its_end())
                if monotonic() >= self.deadline:
                    return self._ended(*self._late())

    def end_all(self) -> None:
        """End every process below the guardian; orphans come back to it, so nothing escapes by forking twice."""
        end_tree(psutil.Process(), collect=self._collect)

    def _collect(self, process: int) -> None:
        if process == self.planner:
            self._reap(patience=_ENDING)
        else:
            os.waitpid(process, 0)

    def _pass_on(self) -> bool:
        """Pass on what the planner has said since; False where there is nothing more (or an answer already)."""
        if self.answered:
            return False
        try:
            chunk = os.read(self.pipe, 1 << 16)
        except BlockingIOError:
            return False
        for line in self.lines.feed(chunk):
            kind = line[:40]
            if b'"solving"' in kind:
                self.started = monotonic()
                self.deadline = self.started + self.job.budget + grace(self.job.budget)
            self.answered = self.answered or b'"result"' in kind or b'"failed"' in kind
            _say(self._stamped(line))
        return bool(chunk)

    def _drain(self) -> None:
        """Pass on what the pipe holds, and no more: there may be no end of it."""
        for _ in range(_PIPES):
            if not self._pass_on():
                return

    def _stamped(self, line: bytes) -> bytes:
        """Return a line of the planner with the time of its arrival [s], from the start of its clock.

        What stands last in an object counts, so that no planner can say it itself, nor speak as the guardian.
        """
        at = 0.0 if self.started is None else monotonic() - self.started
        return b'%s, "at": %.6f, "by": "planner"}' % (line[:-1], at) if line.endswith(b"}") else line

    def _beyond_memory(self) -> str | None:
        """Return what of the run takes more than its limit, or None."""
        if self._look_at_memory() > self.job.memory:
            return f"{self.peak:.0f} MiB used, the limit is {self.job.memory}"
        if (written := _size(self.scratch)) <= self.job.memory:
            return None
        return f"{written:.0f} MiB printed and written to its scratch folder, the limit is {self.job.memory}"

    def _look_at_memory(self) -> float:
        """Return what the planner's tree uses [MiB], and keep its peak.

        That is the resident sets of its processes, and what of its shared memory is in none of them.
        """
        total, tree = 0, []
        for process in _tree():
            with suppress(psutil.Error):
                total += process.memory_info().rss
                tree.append(process.pid)
        used = total / 2**20
        held = self.shared.held(tree)
        if held:
            used += max(0.0, held - mapped(tree))
        self.peak = max(self.peak, used)
        return used

    def _reap(self, patience: float = 0.0) -> None:
        """Collect the planner's process if it has ended, waiting for it up to `patience` seconds."""
        until = monotonic() + patience
        while self.status is None:
            try:
                done, status, usage = os.wait4(self.planner, os.WNOHANG)
            except ChildProcessError:
                return
            if done:
                self.status = status
                self.cpu = usage.ru_utime + usage.ru_stime
                unit = 2**20 if sys.platform == "darwin" else 2**10
                self.peak = max(self.peak, usage.ru_maxrss / unit)
            elif monotonic() >= until:
                return
            else:
                sleep(0.002)

    def _late(self) -> tuple[str, str]:
        if self.started is None:
            had = sum(_seconds(process) for process in _tree())
            return "crashed", f"not ready to plan after {STARTUP_LIMIT:.0f} s, {had:.1f} s of them computing ({load()})"
        allowed = self.job.budget + grace(self.job.budget)
        return "over-budget", still_running(allowed, self.job.budget)

    def _at_its_end(self) -> tuple[str, str]:
        """Return how a run ended that has answered or whose process is gone: what it left is looked at once more."""
        beyond = self._beyond_memory()
        if beyond is not None:
            return "memory", beyond
        return ("", "") if self.answered else self._abnormal()

    def _abnormal(self) -> tuple[str, str]:
        code = os.waitstatus_to_exitcode(self.status or 0)
        if code < 0:
            return "crashed", f"its process was killed by {signal.Signals(-code).name}"
        return "crashed", f"its process ended with exit code {code} and no answer"

    def _ended(self, outcome: str, reason: str) -> None:
        wall = None if self.started is None else monotonic() - self.started
        self.end_all()
        self.said.seek(max(0, self.said.seek(0, os.SEEK_END) - 4000))
        lines = self.said.read().decode(errors="replace").splitlines()[-SAID_LINES:]
        message: dict[str, Any] = {
            "kind": "ended",
            "at": wall or 0.0,
            "by": "guardian",
            "outcome": outcome,
            "reason": reason,
            "wall_seconds": wall,
            "cpu_seconds": self.cpu,
            "memory_mib": round(self.peak, 1),
            "log": "\n".join(lines),
        }
        _say(json.dumps(message).encode())


def _size(folder: str) -> float:
    """Return how much the files of a folder take [MiB]."""
    total = 0
    for place, _, files in os.walk(folder):
        for name in files:
            with suppress(OSError):
                total += os.lstat(os.path.join(place, name)).st_blocks * 512
    return total / 2**20


def _seconds(process: psutil.Process) -> float:
    """Return how long a process has computed [s]."""
    try:
        times = process.cpu_times()
    except psutil.Error:
        return 0.0
    return float(times.user + times.system)


def _tree() -> list[psutil.Process]:
    try:
        return psutil.Process().children(recursive=True)
    except psutil.Error:
        return []


def _say(line: bytes) -> None:
    left = memoryview(line + b"\n")
    while left:
        left = left[os.write(sys.stdout.fileno(), left) :]
