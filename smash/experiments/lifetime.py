"""No process outlives whoever waits for it, whatever ends the one that waits."""

from __future__ import annotations

import signal
import sys

_PR_SET_PDEATHSIG = 1


def end_with_parent() -> None:
    """Have the kernel kill this process as soon as the thread that started it is gone (Linux; elsewhere nothing)."""
    prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


def prctl(option: int, argument: int) -> None:
    """Call Linux's `prctl`; elsewhere nothing."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None, use_errno=True).prctl(option, argument, 0, 0, 0)
