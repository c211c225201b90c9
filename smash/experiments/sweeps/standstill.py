"""Workers of a Dask cluster that stand still: found by the sweep's own clock, their runs given to others.

A worker that was stopped, or whose machine is gone without a word, keeps its connection: nothing fails, and its runs
would be waited for until the scheduler's own patience ends. Two signs are read: no heartbeat of it reaches the
scheduler any more; or it is heard, yet none of its runs ends although the limits of the longest are over.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

SILENCE = 30.0
"""Seconds without a heartbeat (twice a second to once in some seconds, by the size of the cluster)."""
SCHEDULERS_SILENCE = 60.0
"""Seconds without an answer of the scheduler, whose connection stays open where it was stopped."""
_ANSWER = SILENCE + 10.0
"""Seconds that it has for one answer."""
_LOOKING = 5.0
"""Seconds between two looks."""


@dataclass
class Standstill:
    """Tells, look by look, which workers stand still.

    Attributes:
        longest: seconds that a run can take at most.
    """

    longest: float
    _heard: dict[str, tuple[float, float]] = field(default_factory=dict)
    _at_work: dict[str, tuple[frozenset[str], float]] = field(default_factory=dict)

    def look(self, now: float, heartbeats: Mapping[str, float], at_work: Mapping[str, Iterable[str]]) -> dict[str, str]:
        """Return the workers that stand still, and why.

        Args:
            now: seconds on this clock.
            heartbeats: when the scheduler heard of each worker last, on a clock of its own.
            at_work: the keys of the runs that each worker has.
        """
        still = {}
        for worker, beat in heartbeats.items():
            runs = frozenset(at_work.get(worker, ()))
            last_beat, heard = self._heard.get(worker, (None, now))
            self._heard[worker] = (beat, now if beat != last_beat else heard)
            had, since = self._at_work.get(worker, (frozenset(), now))
            self._at_work[worker] = (runs, since if had and had <= runs else now)
            if runs and now - self._heard[worker][1] > SILENCE:
                still[worker] = f"nothing heard of it for {SILENCE:.0f} s"
            elif runs and now - self._at_work[worker][1] > self.longest:
                still[worker] = f"no run of it has ended for {self.longest:.0f} s"
        for worker in [*self._heard]:
            if worker not in heartbeats or worker in still:
                del self._heard[worker], self._at_work[worker]
        return still


@contextmanager
def watched(
    client: Any, longest: float, tell: Callable[[str], object], give_up: Callable[[str], object]
) -> Iterator[None]:
    """Have workers that stand still removed from a cluster as long as it lasts (a nanny starts them anew).

    Args:
        client: of the cluster.
        longest: seconds that a run can take at most.
        tell: is told of each in a line.
        give_up: is told where the scheduler itself stands still.
    """
    over = threading.Event()
    watch = threading.Thread(target=_watch, args=(client, Standstill(longest), tell, give_up, over), daemon=True)
    watch.start()
    try:
        yield
    finally:
        over.set()
        watch.join(timeout=5)


def _watch(
    client: Any,
    standstill: Standstill,
    tell: Callable[[str], object],
    give_up: Callable[[str], object],
    over: threading.Event,
) -> None:
    answered = monotonic()
    while not over.wait(_LOOKING):
        if monotonic() - answered > SCHEDULERS_SILENCE:
            give_up(f"the scheduler stands still: no answer of it for {SCHEDULERS_SILENCE:.0f} s")
            return
        try:
            workers = _asked(client, client.scheduler.identity, n_workers=-1)["workers"]
            at_work = _asked(client, client.scheduler.processing, workers=None)
            answered = monotonic()
            heartbeats = {worker: state["last_seen"] for worker, state in workers.items()}
            for worker, why in standstill.look(answered, heartbeats, at_work).items():
                tell(f"worker {worker} stands still ({why}): its runs go to others")
                _asked(
                    client,
                    client.scheduler.restart_workers,
                    workers=[worker],
                    timeout=SILENCE,
                    wait_for_workers=False,
                    on_error="return",
                    stimulus_id="smash-standstill",
                )
        except Exception as error:  # the scheduler is gone, or does not answer now: the sweep itself hears of that
            logging.getLogger(__name__).debug("no look at the workers: %s", error)


def _asked(client: Any, question: Callable[..., Any], **named: Any) -> Any:
    """Return the scheduler's answer.

    Raises:
        TimeoutError: where there is none in time.
    """
    return client.sync(question, callback_timeout=_ANSWER, **named)
