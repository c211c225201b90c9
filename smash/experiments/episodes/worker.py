"""Processes that run episodes in turn, so that libraries are loaded once; a crash costs the episode it happened in."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from contextlib import suppress
from queue import SimpleQueue
from tempfile import TemporaryFile
from threading import Timer
from typing import TYPE_CHECKING

import msgspec

from smash.records.episodes import Episode
from smash.records.record import decoded

if TYPE_CHECKING:
    from smash.experiments.episodes.series import EpisodeRun

LONGEST_EPISODE = 900.0
"""Seconds of wall time after which an episode is given up."""
MOST_EPISODES = 40
"""A process is replaced after so many, lest what libraries leak adds up."""


class EpisodeLost(Exception):
    """The process ended, or was ended, before it had an answer; the message says why."""


class EpisodeWorker:
    """One process, started when it is first asked, and started again after a crash."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._errors = TemporaryFile()  # noqa: SIM115 (lives as long as the worker)
        self._asked = 0

    def ask(self, question: EpisodeRun) -> Episode:
        """Return the episode (`smash.experiments.episodes.process` runs it).

        Raises:
            EpisodeLost: where there is no answer.
        """
        process = self._running()
        assert process.stdin is not None
        assert process.stdout is not None
        self._asked += 1
        late = Timer(LONGEST_EPISODE, process.kill)
        late.start()
        try:
            with suppress(BrokenPipeError):
                process.stdin.write(json.dumps(msgspec.to_builtins(question)).encode() + b"\n")
                process.stdin.flush()
            line = process.stdout.readline()
        finally:
            overdue = not late.is_alive()
            late.cancel()
        if line.endswith(b"\n"):
            return decoded(line, Episode)
        self.close()
        raise EpisodeLost(f"no end after {LONGEST_EPISODE:.0f} s" if overdue else self._last_words(process.returncode))

    def close(self) -> None:
        """End the process, whatever it is doing."""
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.wait()
            for pipe in filter(None, (process.stdin, process.stdout)):
                with suppress(OSError):
                    pipe.close()

    def _running(self) -> subprocess.Popen[bytes]:
        if self._asked >= MOST_EPISODES:
            self.close()
        if self._process is None:
            self._asked = 0
            self._process = subprocess.Popen(
                [sys.executable, "-m", "smash.experiments.episodes.process", str(os.getpid())],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._errors,
                start_new_session=True,
            )
        return self._process

    def _last_words(self, code: int) -> str:
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        self._errors.truncate(0)
        return lines[-1] if lines else f"the process ended with {code}"


class Crew:
    """So many workers, lent to whoever has an episode to run; use as a context manager."""

    def __init__(self, size: int) -> None:
        self._workers = [EpisodeWorker() for _ in range(size)]
        self._idle: SimpleQueue[EpisodeWorker] = SimpleQueue()
        for worker in self._workers:
            self._idle.put(worker)

    def __enter__(self) -> Crew:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def ask(self, question: EpisodeRun) -> Episode:
        """Let the next idle worker answer.

        Raises:
            EpisodeLost: where there is no answer.
        """
        worker = self._idle.get()
        try:
            return worker.ask(question)
        finally:
            self._idle.put(worker)

    def close(self) -> None:
        """End all of them."""
        for worker in self._workers:
            worker.close()
