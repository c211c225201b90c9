"""The pool of a Dask cluster: a run that one worker cannot do goes to another, and nothing is waited for in vain."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor, Future, InvalidStateError
from contextlib import suppress
from functools import partial
from threading import Lock, Thread
from typing import Any

from smash.problem.errors import SmashError


class Unable(Exception):
    """A worker cannot do a run: a planner or an extra is not there, its disk is full, it can start no process.

    Args:
        worker: its address.
        reason: why, in a line.
    """

    def __init__(self, worker: str, reason: str) -> None:
        super().__init__(worker, reason)
        self.worker, self.reason = worker, reason


def on_worker(task: Callable[[Any], Any], run: Any) -> Any:
    """Do a run on a worker.

    Raises:
        Unable: where it cannot be done there.
    """
    from distributed import get_worker

    try:
        record = task(run)
    except SmashError as error:
        raise Unable(get_worker().address, str(error)) from None
    if getattr(record, "outcome", None) == "not-installed":  # it is where the sweep was started, or it were left out
        raise Unable(get_worker().address, record.reason)
    return record


class ClusterExecutor(Executor):
    """Hands runs to the workers of a cluster.

    Args:
        client: of the cluster.
        tell: is told in a line of each worker that cannot do what it is asked.
    """

    def __init__(self, client: Any, tell: Callable[[str], object]) -> None:
        self._client = client
        self._anywhere = client.get_executor(pure=False)
        self._tell = tell
        self._told: set[str] = set()
        self._waiting: dict[Future[Any], Future[Any] | None] = {}  # what is promised -> what Dask is asked for it
        self._lock = Lock()

    def submit(self, task: Callable[..., Any], /, *arguments: Any, **named: Any) -> Future[Any]:
        """Hand out one run."""
        promise: Future[Any] = Future()
        with self._lock:
            self._waiting[promise] = None
        promise.add_done_callback(self._let_go)
        do = partial(on_worker, partial(task, **named), *arguments)
        self._hand_out(promise, self._anywhere, do, frozenset())
        return promise

    def give_up(self, reason: str) -> None:
        """Have every run that is waited for end with an error, as nobody will tell what became of it."""
        with self._lock:
            waiting = list(self._waiting)
        for promise in waiting:
            with suppress(InvalidStateError):
                promise.set_exception(ConnectionError(reason))

    def _hand_out(
        self, promise: Future[Any], executor: Executor, do: Callable[[], Any], unable: frozenset[str]
    ) -> None:
        handed = executor.submit(do)
        with self._lock:
            if promise in self._waiting:
                self._waiting[promise] = handed
        if promise.cancelled():
            handed.cancel()
        handed.add_done_callback(lambda handed: self._ended(promise, do, unable, handed))

    def _let_go(self, promise: Future[Any]) -> None:
        """Keep nothing of what has ended: a result that somebody holds is made again where its worker dies."""
        with self._lock:
            handed = self._waiting.pop(promise, None)
        if handed is not None and promise.cancelled():
            handed.cancel()

    def _hand_out_again(self, promise: Future[Any], do: Callable[[], Any], unable: frozenset[str], reason: str) -> None:
        """Let any worker do it but those that are unable."""
        with suppress(InvalidStateError):
            try:
                others = [worker for worker in self._client.nthreads() if worker not in unable]
                if not others:
                    raise RuntimeError(f"no worker can do them: {reason}")
                self._hand_out(promise, self._client.get_executor(pure=False, workers=others), do, unable)
            except Exception as error:
                promise.set_exception(error)

    def _ended(self, promise: Future[Any], do: Callable[[], Any], unable: frozenset[str], handed: Future[Any]) -> None:
        with suppress(InvalidStateError):  # it was cancelled, or given up, meanwhile
            if handed.cancelled():
                promise.cancel()
                return
            error = handed.exception()
            if error is None:
                promise.set_result(handed.result())
            elif isinstance(error, Unable) and not promise.done():
                self._say(f"worker {error.worker} cannot do a run ({error.reason}): it goes to others")
                # in a thread: this is called from Dask's event loop, which cannot wait for an answer to itself
                again = (promise, do, unable | {error.worker}, error.reason)
                Thread(target=self._hand_out_again, args=again, daemon=True).start()
            else:
                promise.set_exception(error)

    def _say(self, words: str) -> None:
        with self._lock:
            if words in self._told:
                return
            self._told.add(words)
        self._tell(words)
