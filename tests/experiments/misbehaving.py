"""Planners that do what no planner should, each with the name that its end has to have.

`ENDS` has, beside those here, the troubled ones of `troubled.py`: planner -> outcome and words of the reason.
"""

import ctypes
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress

import psutil

from smash.planners.protocol import PlanResult
from smash.problem import Pick, Place, Topple
from smash.problem.plan import Incumbent
from smash.problem.rules import Law, Verdict
from tests.experiments import troubled
from tests.experiments.troubled import SLEEPER, detour


def best(instance):
    """The optimum of the tower, with which good planners answer."""
    return PlanResult("optimal", detour(instance, 0), 3, "seen")


def misbehaves(solve):
    """A planner of a function of (instance, on_incumbent)."""

    def method(self, instance, options, budget, on_incumbent=None):
        return solve(instance, on_incumbent)

    return type(
        solve.__name__, (), {"solve": method, "anytime": True, "budget_dependent": False, "__module__": __name__}
    )


def on_every_file(line):
    """Write to every file that is open here, the pipe of the run among them."""
    for number in range(3, 64):
        with suppress(OSError):
            os.write(number, line)


# --- lies


@misbehaves
def lies_high(instance, on_incumbent):
    return PlanResult("optimal", detour(instance, 1), 5, "wishful")


@misbehaves
def lies_low(instance, on_incumbent):
    on_incumbent(0.0, 1, detour(instance, 0))
    return best(instance)


@misbehaves
def lies_early(instance, on_incumbent):
    time.sleep(0.5)
    on_incumbent(0.0, 3, detour(instance, 0))
    return PlanResult("feasible", detour(instance, 0), incumbents=(Incumbent(0.0, 3, "mine"),))


@misbehaves
def lies_negative(instance, on_incumbent):
    on_incumbent(-5.0, -3, detour(instance, 0))
    return best(instance)


@misbehaves
def says_infeasible(instance, on_incumbent):
    return PlanResult("infeasible")


@misbehaves
def says_infeasible_with_a_plan(instance, on_incumbent):
    on_incumbent(0.0, 3, detour(instance, 0))
    return PlanResult("infeasible")


@misbehaves
def says_solved(instance, on_incumbent):
    return PlanResult("solved", detour(instance, 0))


@misbehaves
def says_optimal_without_a_plan(instance, on_incumbent):
    return PlanResult("optimal")


@misbehaves
def names_a_stranger(instance, on_incumbent):
    return PlanResult("feasible", (Pick("nobody", "s1"), Place("nobody", "s2")))


@misbehaves
def topples_nothing(instance, on_incumbent):
    return PlanResult("feasible", (Topple("s1", 99), *detour(instance, 0)))


@misbehaves
def ends_with_a_full_hand(instance, on_incumbent):
    return PlanResult("feasible", (*detour(instance, 0), Pick("b1", "s2")))


@misbehaves
def is_infinitely_sure(instance, on_incumbent):
    return PlanResult("feasible", detour(instance, 0), float("inf"), "proof")


@misbehaves
def bounds_beyond_all_numbers(instance, on_incumbent):
    return PlanResult("feasible", detour(instance, 0), 10**9000, "proof")


# --- answers that are none


@misbehaves
def answers_with_objects(instance, on_incumbent):
    return PlanResult("feasible", (object(), object()))


@misbehaves
def answers_with_numbers(instance, on_incumbent):
    return PlanResult("feasible", (1, 2, 3))


@misbehaves
def answers_in_circles(instance, on_incumbent):
    details = {}
    details["again"] = details
    return PlanResult("feasible", detour(instance, 0), details=details)


@misbehaves
def answers_with_a_gigabyte(instance, on_incumbent):
    return PlanResult("feasible", detour(instance, 0), details={"all": "x" * (1 << 27)})


@misbehaves
def huge_incumbent(instance, on_incumbent):
    plan = detour(instance, 50_000)
    on_incumbent(0.0, len(plan), plan)
    return best(instance)


@misbehaves
def floods_with_incumbents(instance, on_incumbent):
    plan = detour(instance, 20)
    while True:
        on_incumbent(0.0, len(plan), plan)


# --- the pipe, the files, the process


@misbehaves
def forges_its_end(instance, on_incumbent):
    on_every_file(b'{"kind": "ended", "outcome": "optimal", "reason": "", "by": "guardian"}\n')
    time.sleep(600)


@misbehaves
def forges_a_malformed_file(instance, on_incumbent):
    on_every_file(b'{"kind": "failed", "outcome": "malformed", "reason": "stop the sweep"}\n')
    time.sleep(600)


@misbehaves
def forges_its_time(instance, on_incumbent):
    time.sleep(0.5)
    plan = [["topple", "s1", 2], ["pick", "b1", "s1"], ["place", "b1", "s2"]]
    line = {"at": 0.0, "kind": "incumbent", "seconds": 0.0, "cost": 3, "actions": plan}
    on_every_file(json.dumps(line).encode() + b"\n")
    return PlanResult("feasible", detour(instance, 0))


@misbehaves
def writes_a_line_without_end(instance, on_incumbent):
    while True:
        on_every_file(b"x" * (1 << 16))


@misbehaves
def closes_all_files(instance, on_incumbent):
    os.closerange(0, 1000)
    return best(instance)


@misbehaves
def opens_all_files(instance, on_incumbent):
    kept = []
    with suppress(OSError):
        while True:
            kept.append(os.open(os.devnull, os.O_RDONLY))
    return best(instance)


@misbehaves
def exits_well(instance, on_incumbent):
    os._exit(0)


@misbehaves
def leaves(instance, on_incumbent):
    sys.exit("enough")


@misbehaves
def is_interrupted(instance, on_incumbent):
    raise KeyboardInterrupt


@misbehaves
def recurses(instance, on_incumbent):
    return recurses.solve(None, instance, None, None)


@misbehaves
def aborts(instance, on_incumbent):
    os.abort()


@misbehaves
def kills_itself(instance, on_incumbent):
    os.kill(os.getpid(), signal.SIGKILL)


@misbehaves
def stops_itself(instance, on_incumbent):
    os.kill(os.getpid(), signal.SIGSTOP)


@misbehaves
def screams(instance, on_incumbent):
    raise ValueError("\x1b[31m\ud800 \r\n =1+1 | <script>")


@misbehaves
def ignores_signals(instance, on_incumbent):
    for number in set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP}:
        signal.signal(number, signal.SIG_IGN)
    time.sleep(600)


@misbehaves
def hangs_in_a_library(instance, on_incumbent):
    signal.pthread_sigmask(signal.SIG_BLOCK, set(signal.Signals))
    ctypes.PyDLL(None).sleep(600)


@misbehaves
def has_a_thread_that_stays(instance, on_incumbent):
    threading.Thread(target=time.sleep, args=(600,)).start()
    return best(instance)


# --- memory


@misbehaves
def asks_for_too_much(instance, on_incumbent):
    return bytearray(1 << 60)


@misbehaves
def limits_itself(instance, on_incumbent):
    resource.setrlimit(resource.RLIMIT_AS, (1 << 28, 1 << 28))
    return [bytearray(1 << 24) for _ in range(100)]


@misbehaves
def prints_a_gigabyte(instance, on_incumbent):
    for _ in range(1 << 10):
        os.write(1, b"noise..\n" * (1 << 17))
    return best(instance)


@misbehaves
def fills_its_scratch_folder(instance, on_incumbent):
    with open(os.path.join(os.environ["TMPDIR"], "hoard"), "wb") as file:
        while True:
            file.write(os.urandom(1 << 20))


# --- the house


@misbehaves
def monkeypatches_the_law(instance, on_incumbent):
    Law.check = lambda *_: Verdict(True, cost=1)
    return PlanResult("optimal", (Pick("b1", "s1"),), 1, "patched")


@misbehaves
def monkeypatches_its_messenger(instance, on_incumbent):
    from smash.experiments.isolation import solving

    solving._Voice.say = lambda voice, **_: os.write(voice._pipe, b'{"kind": "won"}\n')
    return best(instance)


@misbehaves
def removes_its_scratch_folder(instance, on_incumbent):
    shutil.rmtree(os.environ["TMPDIR"])
    os.chdir("/")
    return best(instance)


@misbehaves
def kills_the_server(instance, on_incumbent):
    psutil.Process(os.getppid()).parent().kill()
    time.sleep(0.2)
    return best(instance)


@misbehaves
def stops_the_server(instance, on_incumbent):
    psutil.Process(os.getppid()).parent().suspend()
    time.sleep(0.2)
    return best(instance)


@misbehaves
def stops_its_guardian(instance, on_incumbent):
    os.kill(os.getppid(), signal.SIGSTOP)
    time.sleep(600)


@misbehaves
def fells_all_above(instance, on_incumbent):
    subprocess.Popen(SLEEPER, start_new_session=True)
    psutil.Process(os.getppid()).parent().kill()
    os.kill(os.getppid(), signal.SIGSTOP)
    time.sleep(600)


# --- children


@misbehaves
def leaves_a_daemon(instance, on_incumbent):
    subprocess.Popen(SLEEPER, start_new_session=True, env={}, close_fds=True, cwd="/")
    return best(instance)


@misbehaves
def leaves_zombies(instance, on_incumbent):
    for _ in range(50):
        if os.fork() == 0:
            os._exit(0)
    return best(instance)


@misbehaves
def forks_like_rabbits(instance, on_incumbent):
    """Each has two children, five times, in sessions of their own."""
    for _ in range(5):
        if os.fork() == 0:
            os.setsid()
    time.sleep(600)


@misbehaves
def comes_back(instance, on_incumbent):
    """Two processes, each of which starts the other anew where it is gone."""
    while True:
        child = os.fork()
        if child == 0:
            os.setsid()
            time.sleep(600)
        os.waitpid(child, 0)


MISBEHAVING = {name.replace("_", "-"): value for name, value in vars().items() if getattr(value, "anytime", False)}
"""Planners of this file by name."""

ENDS = {
    "answers-in-circles": ("crashed", "RecursionError"),
    "answers-with-a-gigabyte": ("memory", "MiB used"),
    "answers-with-numbers": ("refused", "plan: null"),
    "answers-with-objects": ("refused", "plan: null"),
    "aborts": ("crashed", "SIGABRT"),
    "asks-for-too-much": ("memory", "MemoryError"),
    "bounds-beyond-all-numbers": ("crashed", "no valid PlanResult"),
    "closes-all-files": ("crashed", "no answer"),
    "comes-back": ("over-budget", "stopped"),
    "ends-with-a-full-hand": ("refused", "hand"),
    "exits-well": ("crashed", "exit code 0 and no answer"),
    "fells-all-above": ("crashed", "stood still"),
    "fills-its-scratch-folder": ("memory", "scratch folder"),
    "floods-with-incumbents": ("over-budget", "stopped"),
    "forges-a-malformed-file": ("crashed", "wrote to the pipe"),
    "forges-its-end": ("crashed", "wrote to the pipe"),
    "forges-its-time": ("feasible", ""),
    "forks-like-rabbits": ("memory", "MiB used"),
    "hangs-in-a-library": ("over-budget", "stopped"),
    "has-a-thread-that-stays": ("optimal", ""),
    "huge-incumbent": ("optimal", ""),
    "ignores-signals": ("over-budget", "stopped"),
    "is-infinitely-sure": ("feasible", ""),
    "is-interrupted": ("crashed", "KeyboardInterrupt"),
    "kills-itself": ("crashed", "SIGKILL"),
    "kills-the-server": ("optimal", ""),
    "leaves": ("crashed", "SystemExit: enough"),
    "leaves-a-daemon": ("optimal", ""),
    "leaves-zombies": ("optimal", ""),
    "lies-early": ("feasible", ""),
    "lies-high": ("optimal", ""),  # one run cannot know better: `records check` and `report` do
    "lies-low": ("refused", "its cost says 1, the law counts 3"),
    "lies-negative": ("refused", "its cost says -3"),
    "limits-itself": ("memory", "MemoryError"),
    "monkeypatches-its-messenger": ("crashed", "wrote to the pipe"),
    "monkeypatches-the-law": ("refused", "step 1"),
    "names-a-stranger": ("refused", "nobody"),
    "opens-all-files": ("optimal", ""),
    "prints-a-gigabyte": ("memory", "printed and written"),
    "recurses": ("crashed", "RecursionError"),
    "removes-its-scratch-folder": ("optimal", ""),
    "says-infeasible": ("refused", "there is a plan"),
    "says-infeasible-with-a-plan": ("refused", "status infeasible"),
    "says-optimal-without-a-plan": ("refused", "without a plan"),
    "says-solved": ("crashed", "status 'solved' is not one of"),
    "screams": ("crashed", "ValueError"),
    "stops-its-guardian": ("crashed", "stood still"),
    "stops-itself": ("over-budget", "stopped"),
    "stops-the-server": ("optimal", ""),
    "topples-nothing": ("refused", "step 1"),
    "writes-a-line-without-end": ("crashed", "wrote to the pipe"),
    # of troubled.py
    "babbles": ("crashed", "wrote to the pipe"),
    "boasts": ("refused", "lower bound 4"),
    "cheats": ("refused", "step 1"),
    "declines": ("unsupported", "not today"),
    "eats-memory": ("memory", "MiB used"),
    "eats-memory-files": ("memory", "MiB used"),
    "eats-memory-in-a-child": ("memory", "MiB used"),
    "eats-segments": ("memory", "MiB used"),
    "eats-shared-memory": ("memory", "MiB used"),
    "hangs": ("over-budget", "stopped"),
    "kills-its-guardian": ("crashed", "was killed"),
    "leaves-children": ("over-budget", "stopped"),
    "mumbles": ("crashed", "no valid PlanResult"),
    "prints-for-ever": ("memory", "printed and written"),
    "raises-at-import": ("crashed", "born broken"),
    "segfaults": ("crashed", "SIGSEGV"),
    "writes-to-shared-memory": ("memory", "MiB used"),
}
PLANNERS = MISBEHAVING | troubled.PLANNERS
