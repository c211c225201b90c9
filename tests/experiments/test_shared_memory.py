"""Shared memory where runs have none of their own: what a process of the run has open, or has made, is the run's."""

import subprocess
import sys
from contextlib import suppress
from multiprocessing.shared_memory import SharedMemory as Block
from pathlib import Path

import pytest

from smash.experiments.isolation.shared_memory import PLACE, SharedMemory, segments

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="told by Linux alone")

BEGIN = "import ctypes, os; from multiprocessing.shared_memory import SharedMemory; "
OPEN = BEGIN + "kept = SharedMemory(create=True, size=2**22); kept.buf[:] = bytes(2**22); name = kept.name; "
MEMORY_FILE = BEGIN + "kept = os.memfd_create('x'); os.write(kept, bytes(2**22)); name = 'none'; "
SEGMENT = BEGIN + (
    "libc = ctypes.CDLL(None); libc.shmat.restype = ctypes.c_void_p; kept = libc.shmget(0, 2**22, 0o1600); "
    "place = ctypes.c_void_p(libc.shmat(kept, None, 0)); ctypes.memset(place, 1, 2**22); libc.shmdt(place); "
    "name = kept; "
)


@pytest.fixture
def shares():
    """Start a process that keeps shared memory; return its id and how that is called."""
    started = []

    def start(program):
        program += "print(name, flush=True); input(); os._exit(0)"
        process = subprocess.Popen(
            [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        started.append(process)
        return process.pid, process.stdout.readline().strip()

    yield start
    for process in started:
        with suppress(BrokenPipeError):
            process.communicate("\n")


@pytest.mark.parametrize("program", [OPEN, MEMORY_FILE, SEGMENT], ids=["posix", "memory file", "system v"])
def test_what_a_process_of_the_run_holds_counts_and_goes(shares, program):
    memory = SharedMemory(apart=False)
    process, name = shares(program)
    assert memory.held([process]) == pytest.approx(4, abs=0.1)
    memory.clear()
    assert not (Path(PLACE) / name).exists()
    assert name not in map(str, segments())


def test_what_others_hold_is_left_alone(shares):
    of_before = Block(create=True, size=2**20)
    memory = SharedMemory(apart=False)
    _other, name = shares(OPEN)
    mine, _ = shares(f"{BEGIN} kept = SharedMemory({of_before.name!r}); name = 0; ")
    assert memory.held([mine]) == 0
    memory.clear()
    assert (Path(PLACE) / of_before.name).exists()
    assert (Path(PLACE) / name).exists()
    of_before.close()
    with suppress(FileNotFoundError):  # the tracker of the process that has opened it ends it too
        of_before.unlink()
    (Path(PLACE) / name).unlink()
