"""Time that planning takes: by the wall's clock, and by the thread's own, which a busy machine does not lengthen."""

from __future__ import annotations

from time import perf_counter, thread_time
from types import TracebackType
from typing import Self


class Stopwatch:
    """Measures what is done inside it; use as a context manager, once.

    Attributes:
        wall: [s].
        cpu: Of the calling thread, which is where motions are planned [s].
    """

    def __init__(self) -> None:
        self.wall = 0.0
        self.cpu = 0.0

    def __enter__(self) -> Self:
        self._begun = perf_counter(), thread_time()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.wall, self.cpu = perf_counter() - self._begun[0], thread_time() - self._begun[1]
