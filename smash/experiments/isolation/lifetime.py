"""No process outlives whoever waits for it, whatever ends the one that waits."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_PR_SET_PDEATHSIG = 1
_PR_SET_CHILD_SUBREAPER = 36
_ROUNDS = 20


def end_with_parent(parent: int) -> None:
    """Have the kernel kill this process once the thread that started it is gone (Linux), or end it if it is already.

    Args:
        parent: process id of whoever started this one.
    """
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)


def adopt_orphans(adopt: bool) -> None:
    """Have processes below this one that lose their parent become children of this one (Linux), or no longer."""
    _prctl(_PR_SET_CHILD_SUBREAPER, int(adopt))


@contextmanager
def adopting_orphans() -> Iterator[None]:
    """Adopt orphans for as long as it lasts, and end those that came meanwhile; children from before are left alone.

    Only for a process of one thread, which starts nothing else meanwhile.
    """
    before = _children()
    adopt_orphans(True)
    try:
        yield
    finally:
        for _ in range(_ROUNDS):  # each may have had children of its own
            for orphan in _children() - before:
                with suppress(OSError):
                    os.kill(orphan, signal.SIGKILL)
                with suppress(OSError):
                    os.waitpid(orphan, 0)
        adopt_orphans(False)


def _children() -> set[int]:
    """Return the process ids of this process's children; none where the system does not tell."""
    try:
        words = Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()
    except OSError:
        return set()
    return set(map(int, words))


def _prctl(option: int, argument: int) -> None:
    """Call Linux's `prctl`; elsewhere nothing."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None, use_errno=True).prctl(option, argument, 0, 0, 0)
