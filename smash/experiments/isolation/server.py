"""The fork server: a process of one thread, all imports done, that forks a guardian for each run.

A fork costs milliseconds where an interpreter of its own costs a fifth of a second. The server loads nothing but this
package (never a planner's code) and does no work of a run, so every run begins from the same clean memory. It is asked
on a socket and ends when that closes, however its caller ended. Guardians are its children, and what a killed
guardian leaves behind comes to it and is ended before the caller is told.

`multiprocessing`'s own fork server is not used: it imports the caller's main module again in every child.
"""

from __future__ import annotations

import fcntl
import gc
import json
import os
import selectors
import signal
import socket
import sys
from contextlib import suppress
from pkgutil import resolve_name
from typing import Any, NoReturn

import psutil

from smash.experiments.isolation.guardian import guard
from smash.experiments.isolation.leftovers import MARK, Left, clear_away, end_tree
from smash.experiments.isolation.lifetime import adopt_orphans
from smash.experiments.isolation.shared_memory import may_be_apart
from smash.experiments.isolation.work import Work, work_document, work_from_document

REQUEST_BYTES = 1 << 16
"""Longest request on the socket: what becomes of a run's leftovers, and three files."""


def main(connection: int, loaded_by: str) -> None:
    """Serve on a socket that was inherited, until its other end closes.

    Args:
        connection: the socket.
        loaded_by: of the work that it forks for (`Work.loaded_by`).
    """
    resolve_name(loaded_by)()
    serve(socket.socket(fileno=connection))


def serve(connection: socket.socket) -> None:
    """Fork a guardian for each request, tell its process id and at last its exit code, and return at the end of input.

    A request is a JSON line (`Left`: by what a killed guardian's leftovers are known) with three files: the guardian's
    input and output, and the pipe on which its process id and its exit code are told, a line each.
    """
    adopt_orphans(True)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    woken, waking = os.pipe()
    os.set_blocking(woken, False)
    os.set_blocking(waking, False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(waking, warn_on_full_buffer=False)
    apart = may_be_apart()
    gc.freeze()
    at_work: dict[int, tuple[int, Left]] = {}
    with selectors.DefaultSelector() as selector:
        selector.register(connection, selectors.EVENT_READ)
        selector.register(woken, selectors.EVENT_READ)
        asked = True
        while asked or at_work:
            for key, _ in selector.select():
                if key.fd == woken:
                    with suppress(BlockingIOError):
                        os.read(woken, 4096)
                    _reap(at_work)
                elif not _take(connection, at_work, apart):
                    selector.unregister(connection)
                    asked = False


def _take(connection: socket.socket, at_work: dict[int, tuple[int, Left]], apart: bool) -> bool:
    """Take one request; False where there are no more."""
    try:
        words, files, _, _ = socket.recv_fds(connection, REQUEST_BYTES, 3)
    except ConnectionError:
        return False
    if not words:
        return False
    asking, telling, status = files
    left = Left(**json.loads(words))
    guardian = os.fork()
    if not guardian:
        _be_guardian(asking, telling, left, apart)
    os.close(asking)
    os.close(telling)
    at_work[guardian] = status, left
    _tell(status, guardian)
    return True


def _reap(at_work: dict[int, tuple[int, Left]]) -> None:
    """Collect children that have ended; clear away what guardians left that did not end well, then tell."""
    ended = {}
    with suppress(ChildProcessError):
        while (child := os.waitpid(-1, os.WNOHANG))[0]:
            ended[child[0]] = os.waitstatus_to_exitcode(child[1])
    for guardian, code in ended.items():
        if guardian not in at_work:
            continue
        status, left = at_work.pop(guardian)
        if code != 0:
            end_tree(psutil.Process(), spare=set(at_work))
            clear_away(left)
        _tell(status, code)
        os.close(status)


def _tell(status: int, number: int) -> None:
    with suppress(BrokenPipeError):
        os.write(status, b"%d\n" % number)


def _be_guardian(asked: int, told: int, left: Left, apart: bool) -> NoReturn:
    """In the copy: keep nothing of the server's but its memory, take the caller's surroundings, guard the job, end."""
    code = 1
    try:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        os.setsid()
        keep_only(asked, told)
        request = json.loads(sys.stdin.buffer.readline())
        surroundings(request)
        guard(work_from_document(request["job"]), left, apart)
        code = 0
    except SystemExit as ended:
        code = ended.code if isinstance(ended.code, int) else 1
    finally:
        os._exit(code)


def keep_only(asked: int, told: int, *others: int) -> None:
    """Have these two files as input and output, nothing as standard error, others from 3 on, and close all the rest."""
    nothing = os.open(os.devnull, os.O_RDWR)
    wanted = (asked, told, nothing, *others)
    high = [fcntl.fcntl(number, fcntl.F_DUPFD, len(wanted)) for number in wanted]
    for target, source in enumerate(high):
        os.dup2(source, target)
    os.closerange(len(wanted), os.sysconf("SC_OPEN_MAX"))
    sys.stdin = open(0, closefd=False)  # noqa: SIM115 - until the end
    sys.stdout, sys.stderr = (
        open(number, "w", closefd=False, errors="backslashreplace")  # noqa: SIM115
        for number in (1, 2)
    )


def surroundings(request: dict[str, Any]) -> None:
    """Take over the environment, the working folder and the search path that the caller has now."""
    os.environ.clear()
    os.environ.update(request["environment"])
    sys.path[:] = request["path"]
    with suppress(OSError):
        os.chdir(request["folder"])


def search_path() -> list[str]:
    """Return where modules are looked for, in words that do not depend on the working folder."""
    return [os.path.abspath(entry) for entry in sys.path]


def request_line(job: Work, mark: str) -> bytes:
    """Return what a guardian is told on its input: its job, and the surroundings of this process."""
    try:
        folder = os.getcwd()
    except OSError:  # it was removed
        folder = os.sep
    request = {
        "job": work_document(job),
        "environment": {**os.environ, MARK: mark},
        "path": search_path(),
        "folder": folder,
    }
    return json.dumps(request).encode() + b"\n"
