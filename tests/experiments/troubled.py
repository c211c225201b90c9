"""Planners with only `solve`, as a third party would write them: sound ones and every kind of trouble."""

import ctypes
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from multiprocessing import resource_tracker
from multiprocessing.shared_memory import SharedMemory

from smash.planners.protocol import IncumbentLog, PlanResult
from smash.problem import Pick, Place, Topple
from smash.problem.plan import Incumbent

SLEEPER = [sys.executable, "-c", "import time; time.sleep(600)"]
SAID_ALL = [sys.executable, "-c", "import time; time.sleep(601)"]  # started once all has been streamed


def detour(instance, rounds):
    """A legal plan for `tower` made longer by picking and placing the same block `rounds` times."""
    top, source = "b2", "s1"
    wasted = [action for _ in range(rounds) for action in (Pick(top, source), Place(top, source))]
    return (*wasted, Topple("s1", 2), Pick("b1", "s1"), Place("b1", "s2"))


class Sound:
    anytime = True
    budget_dependent = False

    def solve(self, instance, options, budget, on_incumbent=None):
        for rounds, pause in ((3, 0.0), (1, 0.15), (0, 0.1)):
            time.sleep(pause)
            plan = detour(instance, rounds)
            if on_incumbent:
                on_incumbent(0.0 if rounds == 3 else 1e9, len(plan), plan)
        return PlanResult("optimal", plan, 3, "seen", (Incumbent(0.25, 3, "engine"),), {"nodes": 7})


class Bare:
    def solve(self, instance, options, budget, on_incumbent=None):
        return PlanResult("feasible", detour(instance, 0))


class Raises:
    def solve(self, instance, options, budget, on_incumbent=None):
        raise ValueError("no\nluck")


class RaisesAtImport:
    def __init__(self):
        raise RuntimeError("born broken")


class Segfaults:
    def solve(self, instance, options, budget, on_incumbent=None):
        on_incumbent(0.0, 5, detour(instance, 1))
        ctypes.string_at(0)


class Exits:
    def solve(self, instance, options, budget, on_incumbent=None):
        os._exit(3)


class HangsWithPlan:
    def solve(self, instance, options, budget, on_incumbent=None):
        on_incumbent(0.0, 5, detour(instance, 1))
        time.sleep(600)


class HangsWithBounds:
    """Streams bounds that rise, then a plan of 5, then nothing more: a process of its own shows that it has."""

    bounds = (2, 3, 1)

    def solve(self, instance, options, budget, on_incumbent=None):
        log = IncumbentLog(instance, options, on_incumbent)
        for bound in self.bounds:
            log.prove(bound, f"proof of {bound}")
        if options.topple:
            log.offer(detour(instance, 1), "mine")
        subprocess.run(SAID_ALL, check=False)


class HangsProven(HangsWithBounds):
    bounds = (5,)


class HangsAfterBoasting(HangsWithBounds):
    bounds = (6,)


class Hangs:
    def solve(self, instance, options, budget, on_incumbent=None):
        while True:
            pass


class LeavesChildren:
    """Starts a process in a session of its own and one that is orphaned at once, streams a plan, hangs on a third."""

    def solve(self, instance, options, budget, on_incumbent=None):
        subprocess.Popen(SLEEPER, start_new_session=True)
        if os.fork() == 0:
            subprocess.Popen(SLEEPER, start_new_session=True)
            os._exit(0)
        on_incumbent(0.0, 5, detour(instance, 1))
        subprocess.run(SAID_ALL, check=False)


class EatsMemory:
    def solve(self, instance, options, budget, on_incumbent=None):
        hoard = []
        while True:
            hoard.append(bytearray(os.urandom(1) * 2**24))
            time.sleep(0.01)


class EatsMemoryInAChild:
    def solve(self, instance, options, budget, on_incumbent=None):
        subprocess.run([sys.executable, "-c", "import time; x = b'x' * 2**29; time.sleep(600)"], check=False)


class EatsSharedMemory:
    """POSIX shared memory, mapped."""

    def solve(self, instance, options, budget, on_incumbent=None):
        hoard = []
        while True:
            hoard.append(SharedMemory(create=True, size=2**24))
            hoard[-1].buf[:] = bytes(2**24)
            time.sleep(0.01)


class WritesToSharedMemory:
    """Files of /dev/shm that nobody has open or mapped for long."""

    def solve(self, instance, options, budget, on_incumbent=None):
        for number in range(1000):
            with open(f"/dev/shm/{os.path.basename(os.environ['TMPDIR'])}-{number}", "wb") as file:
                file.write(bytes(2**24))
            time.sleep(0.01)


class EatsMemoryFiles:
    """Files that have no name and are not mapped."""

    def solve(self, instance, options, budget, on_incumbent=None):
        file = os.memfd_create("hoard")
        while True:
            os.write(file, bytes(2**24))
            time.sleep(0.01)


class EatsSegments:
    """System V segments, let go of as soon as they are written: they outlive the process."""

    def solve(self, instance, options, budget, on_incumbent=None):
        libc = ctypes.CDLL(None)
        libc.shmat.restype = ctypes.c_void_p
        while True:
            place = ctypes.c_void_p(libc.shmat(libc.shmget(0, 2**24, 0o1600), None, 0))
            ctypes.memset(place, 1, 2**24)
            libc.shmdt(place)
            time.sleep(0.01)


class LeavesSharedMemory:
    """Answers, and leaves shared memory of each kind behind."""

    def solve(self, instance, options, budget, on_incumbent=None):
        kept = SharedMemory(create=True, size=2**20)
        kept.buf[:] = bytes(2**20)
        resource_tracker.unregister(kept._name, "shared_memory")
        ctypes.CDLL(None).shmget(0, 2**20, 0o1600)
        time.sleep(0.3)
        return PlanResult("feasible", detour(instance, 0))


class Cheats:
    def solve(self, instance, options, budget, on_incumbent=None):
        return PlanResult("optimal", (Pick("b1", "s1"), Place("b1", "s2")), 2, "wishful")


class Boasts:
    def solve(self, instance, options, budget, on_incumbent=None):
        return PlanResult("feasible", detour(instance, 0), 4, "wishful")


class Mumbles:
    def solve(self, instance, options, budget, on_incumbent=None):
        return "a plan"


class GivesUp:
    def solve(self, instance, options, budget, on_incumbent=None):
        return PlanResult("infeasible" if not options.topple else "unknown")


class Declines:
    def unsupported(self, instance, options):
        return "not today"

    def solve(self, instance, options, budget, on_incumbent=None):
        raise AssertionError


class Lacks:
    def missing(self):
        return "pip install luck"

    def solve(self, instance, options, budget, on_incumbent=None):
        raise AssertionError


class Shouts:
    def solve(self, instance, options, budget, on_incumbent=None):
        print("noise")
        os.write(1, b"more noise\n")
        return PlanResult("feasible", detour(instance, 0))


class IsSure:
    def solve(self, instance, options, budget, on_incumbent=None):
        return PlanResult("optimal", detour(instance, 0))


class Babbles:
    """Writes to every file that is open here, the pipe of its run among them."""

    def solve(self, instance, options, budget, on_incumbent=None):
        for number in range(3, 64):
            with suppress(OSError):
                os.write(number, b"[1, 2\n")
        return PlanResult("feasible", detour(instance, 0))


class PrintsForEver:
    def solve(self, instance, options, budget, on_incumbent=None):
        while True:
            os.write(1, b"noise " * 2**16)
            time.sleep(0.001)


class KillsItsGuardian:
    def solve(self, instance, options, budget, on_incumbent=None):
        with open(os.environ["STARTS"], "w") as file:
            file.write(os.environ["TMPDIR"])
        os.kill(os.getppid(), signal.SIGKILL)
        time.sleep(600)


class NotesStarts:
    """Sound; notes each start as a line of the file that `STARTS` names, and takes its time."""

    anytime = True
    budget_dependent = False

    def solve(self, instance, options, budget, on_incumbent=None):
        with open(os.environ["STARTS"], "a") as starts:
            starts.write(f"{instance.name} {options.topple}\n")
        plan = detour(instance, len(instance.name) % 3)
        on_incumbent(0.0, len(plan), plan)
        time.sleep(0.2)
        return PlanResult("feasible", plan)


PLANNERS = {
    "sound": Sound,
    "bare": Bare,
    "raises": Raises,
    "raises-at-import": RaisesAtImport,
    "segfaults": Segfaults,
    "exits": Exits,
    "hangs-with-plan": HangsWithPlan,
    "hangs-with-bounds": HangsWithBounds,
    "hangs-proven": HangsProven,
    "hangs-after-boasting": HangsAfterBoasting,
    "hangs": Hangs,
    "leaves-children": LeavesChildren,
    "eats-memory": EatsMemory,
    "eats-memory-in-a-child": EatsMemoryInAChild,
    "eats-shared-memory": EatsSharedMemory,
    "writes-to-shared-memory": WritesToSharedMemory,
    "eats-memory-files": EatsMemoryFiles,
    "eats-segments": EatsSegments,
    "leaves-shared-memory": LeavesSharedMemory,
    "cheats": Cheats,
    "boasts": Boasts,
    "mumbles": Mumbles,
    "notes-starts": NotesStarts,
    "gives-up": GivesUp,
    "declines": Declines,
    "lacks": Lacks,
    "shouts": Shouts,
    "is-sure": IsSure,
    "prints-for-ever": PrintsForEver,
    "kills-its-guardian": KillsItsGuardian,
    "babbles": Babbles,
}
