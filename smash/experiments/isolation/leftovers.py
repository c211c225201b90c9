"""What a killed guardian leaves behind: processes and a scratch folder, and how they are found."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import psutil

MARK = "SMASH_RUN"
"""Environment variable that every program which a run starts inherits, with a value of the run's own; what is forked
and stays the same program shows its parent's."""
_ROUNDS = 200


@dataclass(frozen=True, slots=True)
class Left:
    """By what the leftovers of a run are known.

    Attributes:
        mark: the value of `MARK` in its processes.
        folder: where its scratch folder lies.
    """

    mark: str
    folder: str

    @classmethod
    def by(cls, mark: str) -> Left:
        """Return that of a run that this process asks for."""
        return cls(mark, tempfile.gettempdir())


def scratch_prefix(mark: str) -> str:
    """Return how the name of a run's scratch folder begins."""
    return f"smash-run-{mark[:16]}-"


def end_tree(root: psutil.Process, spare: Collection[int] = (), collect: Callable[[int], object] | None = None) -> None:
    """End all processes below `root`; those that lose their parent must come to it (`adopt_orphans`).

    All are stopped before any is ended, so that none starts another meanwhile.

    Args:
        root: this process.
        spare: children that are left alone, with all below them.
        collect: waits for a process that has been ended, where it is a child.
    """
    for _ in range(_ROUNDS):
        below = _below(root, spare)
        if not below:
            return
        stopped: set[int] = set()
        while below and not stopped.issuperset(process.pid for process in below):
            for process in below:
                with suppress(psutil.Error):
                    process.suspend()
            stopped.update(process.pid for process in below)
            below = _below(root, spare)
        for process in below:
            with suppress(psutil.Error):
                process.kill()
        for process in below:
            with suppress(ChildProcessError):
                (collect or _wait_for)(process.pid)


def _below(root: psutil.Process, spare: Collection[int]) -> list[psutil.Process]:
    with suppress(psutil.Error):
        children = [child for child in root.children() if child.pid not in spare]
        if children and not spare:
            return root.children(recursive=True)
        return [process for child in children for process in (child, *_children(child))]
    return []


def _children(process: psutil.Process) -> list[psutil.Process]:
    with suppress(psutil.Error):
        return process.children(recursive=True)
    return []


def clear_away(left: Left) -> None:
    """End the processes of a run that bear its mark, and remove its scratch folder."""
    for process in psutil.process_iter():
        with suppress(psutil.Error, OSError):
            if process.environ().get(MARK) == left.mark:
                process.kill()
    for folder in Path(left.folder).glob(f"{scratch_prefix(left.mark)}*"):
        shutil.rmtree(folder, ignore_errors=True)


def _wait_for(process: int) -> None:
    os.waitpid(process, 0)
