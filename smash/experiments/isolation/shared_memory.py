"""What a run holds in shared memory: files of `/dev/shm`, memory files (`memfd`), System V segments.

None of it need be mapped by any process, so that resident sets do not show it, and files and segments outlive the
processes that made them. Where the kernel lets us (Linux; as root, or where users may have namespaces), a run gets a
`/dev/shm` and System V segments of its own: they are counted exactly and go with its last process. Elsewhere what is
counted, and removed at the end, is what a process of the run was seen to hold open or to have made.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Collection, Iterable
from contextlib import suppress
from pathlib import Path

PLACE = "/dev/shm"
BEYOND_MIB = 64
"""How much more than its limit a run may write there before the kernel refuses [MiB]: that it is beyond must show."""

_CLONE_NEWNS = 0x00020000
_CLONE_NEWIPC = 0x08000000
_CLONE_NEWUSER = 0x10000000
_MS_NOSUID, _MS_NODEV, _MS_REC, _MS_PRIVATE = 2, 4, 1 << 14, 1 << 18
_IPC_RMID = 0
_SEGMENTS = Path("/proc/sysvipc/shm")


def may_be_apart() -> bool:
    """Return whether a process here may have shared memory of its own; tried in a process that is there for it alone.

    A namespace that is given and then cannot be used (as some systems have it) would be worse than none.
    """
    if sys.platform != "linux":
        return False
    trial = os.fork()
    if not trial:
        try:
            os._exit(0 if set_apart(1) else 1)
        finally:
            os._exit(1)
    return os.waitpid(trial, 0)[1] == 0


def set_apart(limit: int) -> bool:
    """Give this process, and those that it starts, shared memory of their own; False where the kernel does not.

    Args:
        limit: memory limit of the run [MiB].
    """
    libc = ctypes.CDLL(None, use_errno=True)
    user, group = os.getuid(), os.getgid()
    if libc.unshare(_CLONE_NEWNS | _CLONE_NEWIPC):
        if libc.unshare(_CLONE_NEWNS | _CLONE_NEWIPC | _CLONE_NEWUSER):
            return False
        try:
            Path("/proc/self/setgroups").write_text("deny")
            Path("/proc/self/uid_map").write_text(f"{user} {user} 1")
            Path("/proc/self/gid_map").write_text(f"{group} {group} 1")
        except OSError:
            return False
    if libc.mount(None, b"/", None, _MS_REC | _MS_PRIVATE, None):
        return False
    how = f"size={limit + BEYOND_MIB}m,mode=1777".encode()
    refused: int = libc.mount(b"tmpfs", PLACE.encode(), b"tmpfs", _MS_NOSUID | _MS_NODEV, how)
    return not refused


class SharedMemory:
    """The shared memory of one run, seen from its guardian.

    Args:
        apart: whether the guardian has shared memory of its own (`set_apart`).
    """

    def __init__(self, apart: bool) -> None:
        self.apart = apart
        self._before = set() if apart else {*_names(), *segments()}
        self._files: dict[str, int] = {}
        self._made: set[int] = set()
        self._processes: set[int] = set()

    def held(self, processes: Collection[int]) -> float:
        """Return how much the run holds [MiB].

        Args:
            processes: process ids of its tree.
        """
        self._processes.update(processes)
        files: dict[tuple[int, int], tuple[str, int]] = {}
        for process in processes:
            files.update(
                (number, file)
                for number, file in _open_files(process, memory_alone=self.apart).items()
                if file[0] not in self._before
            )
        total = sum(size for _, size in files.values())
        self._files |= {name: number for (_, number), (name, _) in files.items()}
        if self.apart:
            space = os.statvfs(PLACE)
            total += (space.f_blocks - space.f_bfree) * space.f_frsize
        for segment, (creator, size) in segments().items():
            if self.apart or (creator in self._processes and segment not in self._before):
                self._made.add(segment)
                total += size
        return total / 2**20

    def clear(self) -> None:
        """Remove what was seen of it; what is the run's own goes with its last process."""
        if self.apart:
            return
        for name, number in self._files.items():
            with suppress(OSError):
                if os.lstat(name).st_ino == number:
                    os.unlink(name)
        for segment in self._made:
            ctypes.CDLL(None).shmctl(segment, _IPC_RMID, None)


def mapped(processes: Iterable[int]) -> float:
    """Return how much of the resident sets of processes is shared memory [MiB]."""
    total = 0
    for process in processes:
        with suppress(OSError, ValueError):
            for line in Path(f"/proc/{process}/status").read_text().splitlines():
                if line.startswith("RssShmem:"):
                    total += int(line.split()[1])
    return total / 2**10


def _open_files(process: int, memory_alone: bool) -> dict[tuple[int, int], tuple[str, int]]:
    """Return (device, number) -> name, size [bytes] of the memory files, and files of `/dev/shm`, that it has open."""
    found = {}
    wanted = "/memfd:" if memory_alone else ("/memfd:", f"{PLACE}/")
    with suppress(OSError):
        for entry in os.scandir(f"/proc/{process}/fd"):
            with suppress(OSError):
                name = os.readlink(entry.path)
                if name.startswith(wanted):
                    state = os.stat(entry.path)
                    found[state.st_dev, state.st_ino] = name, state.st_blocks * 512
    return found


def _names() -> list[str]:
    with suppress(OSError):
        return [entry.path for entry in os.scandir(PLACE)]
    return []


def segments() -> dict[int, tuple[int, int]]:
    """Return each System V segment here: who made it, and its size in memory [bytes]."""
    try:
        head, *lines = _SEGMENTS.read_text().splitlines()
        names = head.split()
        where = [names.index(name) for name in ("shmid", "cpid", "rss", "swap")]
        rows = [[int(line.split()[place]) for place in where] for line in lines]
    except (OSError, ValueError):
        return {}
    return {segment: (creator, size + swap) for segment, creator, size, swap in rows}
