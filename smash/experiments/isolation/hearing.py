"""The caller's side of a piece of work: its lines as they arrive, until it has ended, and its answer."""

from __future__ import annotations

import json
import os
import selectors
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from threading import Event
from time import monotonic
from typing import Any, Protocol

from smash.experiments.isolation.job import load, longest
from smash.experiments.isolation.lines import Lines
from smash.experiments.isolation.starting import Guardian, guardian_of
from smash.experiments.isolation.work import Work
from smash.problem.errors import SmashError, Unsupported

_PATIENCE = 20.0
"""Seconds that a guardian has to say how work ended that was stopped."""
HERE_ALONE: Mapping[str, type[SmashError]] = {"not-installed": Unsupported, "malformed": SmashError}
"""Outcomes that speak of the machine and not of the work, which another one may do -> what is raised."""


class Hearing(Protocol):
    """Whoever puts the lines together.

    Attributes:
        until: when whoever guards the work is given up, on the monotonic clock [s].
        silent: whether it was.
    """

    until: float
    silent: bool

    def hear(self, line: bytes) -> bool:
        """Take one line; False where nothing is believed any more."""


def hear_out(work: Work, hearing: Hearing, stop: Event | None, *, may_fork: bool = False) -> None:
    """Have work done; when this returns or raises, all of its processes are gone.

    Args:
        work: what to do, and its limits.
        hearing: hears each line.
        stop: set from outside, it ends the work.
        may_fork: whether this process is there for this work alone: with one thread it may then be forked.
    """
    with guardian_of(work, may_fork=may_fork) as guardian:
        for line in _lines(guardian, hearing, stop):
            if not hearing.hear(line):
                break


def _lines(guardian: Guardian, hearing: Hearing, stop: Event | None) -> Iterator[bytes]:
    """Yield what the guardian says until it ends; where `stop` is set, close its input and hear it out."""
    said = Lines()
    with selectors.DefaultSelector() as selector:
        selector.register(guardian.stdout, selectors.EVENT_READ)
        while monotonic() < hearing.until:
            if stop is not None and stop.is_set() and not guardian.stdin.closed:
                guardian.stdin.close()
                hearing.until = monotonic() + _PATIENCE
            if not selector.select(0.1):
                continue
            chunk = os.read(guardian.stdout.fileno(), 1 << 16)
            if not chunk:
                return
            yield from said.feed(chunk)
    hearing.silent = True


@dataclass(frozen=True, slots=True)
class Done:
    """How a piece of this package's own work ended.

    Attributes:
        answer: what it answered, None where it has not.
        reason: why it has not, in a line.
        interrupted: whether it was stopped from outside.
    """

    answer: Mapping[str, Any] | None
    reason: str = ""
    interrupted: bool = False


def done(work: Work, stop: Event | None = None) -> Done:
    """Have work of this package's own done in processes of its own, within its limits, and return its answer.

    Planners are heard by `smash.experiments.isolation.caller`, which believes them nothing.

    Raises:
        Unsupported: where something that it needs is not installed on this machine.
        SmashError: where nothing can be written here.
    """
    heard = _Answer(monotonic() + longest(work.budget))
    hear_out(work, heard, stop)
    if heard.answer is None and stop is not None and stop.is_set():
        return Done(None, "stopped from outside", interrupted=True)
    if heard.unable is not None:
        raise heard.unable(heard.reason)
    guard = "the process that guards it " + (f"stood still ({load()})" if heard.silent else "was killed")
    return Done(heard.answer, "" if heard.answer is not None else heard.reason or guard)


class _Answer:
    """Keeps the answer, or why there is none."""

    def __init__(self, until: float) -> None:
        self.until = until
        self.silent = False
        self.answer: Mapping[str, Any] | None = None
        self.reason = ""
        self.unable: type[SmashError] | None = None

    def hear(self, line: bytes) -> bool:
        """Take one line."""
        try:
            message = json.loads(line)
        except ValueError:
            self.answer, self.reason = None, f"no line of its own on the pipe on which it speaks: {line[:60]!r}"
            return False
        match message["kind"]:
            case "result":
                self.answer = message["answer"]
            case "failed":
                self.reason = message["reason"]
                self.unable = HERE_ALONE.get(message["outcome"])
            case "ended":
                if message["outcome"] == "memory":
                    self.answer = None
                self.reason = self.reason or message["reason"]
        return True
