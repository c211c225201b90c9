"""How a sweep goes: a bar with what is done, running and left where someone watches, else a line a run."""

from __future__ import annotations

import sys
from collections import Counter
from threading import Lock
from time import monotonic
from types import TracebackType
from typing import Any, Self

from smash.experiments.sweeps.experiment import Run
from smash.problem.words import visible
from smash.records.runs import RunRecord


class Progress:
    """Shows done, running, left and the time left on stderr; `running` is at most the pool's width."""

    def __init__(self, total: int, kept: int, width: int, pool_begins: bool) -> None:
        self._total = total
        self._done = kept
        self._width = width
        self._begun = 0
        self._pool_begins = pool_begins
        self._ended = 0
        self._lock = Lock()
        self._started = monotonic()
        self._bar: Any = None
        self.outcomes: Counter[str] = Counter()

    def __enter__(self) -> Self:
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
            from rich.progress import Progress as Bar

            columns = [BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"), TimeElapsedColumn()]
            self._bar = Bar(*columns, console=Console(stderr=True))
            self._task = self._bar.add_task("", total=self._total, completed=self._done)
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()

    def begun(self, run: Run) -> None:
        """Count a run that has started (called from the pool's threads)."""
        with self._lock:
            self._begun += 1
        self._show()

    def ended(self, run: Run, record: RunRecord) -> None:
        """Count a run that has ended."""
        with self._lock:
            self._done += 1
            self._ended += 1
            self.outcomes[record.outcome] += 1
        if self._bar is None:
            cost = "no plan" if record.cost is None else f"cost {record.cost}"
            name = f"{run.suite}/{visible(run.job.instance.name)}"
            where = f"{name} B={record.buffers} {run.variant} {run.job.budget:g} s"
            words = f"[{self._done}/{self._total}] {visible(run.label)}: {where}: {record.outcome}, {cost}"
            print(f"{words} ({self._words()})", file=sys.stderr)
        self._show()

    def _words(self) -> str:
        left = self._total - self._done
        running = min(left, self._width, self._begun - self._ended if self._pool_begins else left)
        words = f"{running} running, {left - running} left"
        if self._ended:
            words += f", about {span((monotonic() - self._started) / self._ended * left)} to go"
        return words

    def _show(self) -> None:
        if self._bar is not None:
            self._bar.update(self._task, completed=self._done, description=self._words())


def span(seconds: float) -> str:
    """Return a span of time as people say it."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.1f} h"
