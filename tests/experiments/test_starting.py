"""How a guardian is started: in a fresh interpreter, or forked where the caller is there for one run alone."""

import subprocess
import sys
from pathlib import Path

import pytest

FIGURE_1 = Path(__file__).parents[2] / "examples" / "figure1.json"
BEGIN = f"""
import subprocess, sys, threading, time
import smash
from smash.experiments.isolation.caller import run_isolated
from smash.experiments.isolation.job import Job
from smash.experiments.isolation.starting import guardian_of
from smash.planners.protocol import Settings
from smash.problem.problem import Problem

def job(**limits):
    return Job("greedy", Problem(smash.read_instance({str(FIGURE_1)!r})), Settings(), 5.0, **limits)
"""


def said(program):
    """Run a program in a process of its own, which has one thread, and return what it prints."""
    ended = subprocess.run([sys.executable, "-c", BEGIN + program], capture_output=True, text=True, timeout=100)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.split()


@pytest.mark.skipif(sys.platform != "linux", reason="forks on Linux alone")
def test_a_process_there_for_one_run_forks_unless_it_has_a_second_thread():
    assert said("""
def kind(**how):
    with guardian_of(job(), **how) as guardian:
        return type(guardian).__name__

print(kind(may_fork=True), kind(may_fork=False))
ends = threading.Event()
threading.Thread(target=ends.wait).start()
print(kind(may_fork=True))
ends.set()
""") == ["_Forked", "_Fresh", "_Fresh"]


@pytest.mark.parametrize("for_this", [True, False])
def test_the_report_is_the_same_either_way(for_this):
    assert said(f"""
report = run_isolated(job(), for_this={for_this})
print(report.outcome, report.plan.cost, len(report.plan.incumbents) > 0, report.memory_mib > 1)
""") == ["feasible", "3", "True", "True"]


def test_the_memory_of_a_caller_is_not_the_run_s():
    assert said("""
data = bytearray(b"x") * (400 << 20)
print(run_isolated(job(memory=300)).outcome)
""") == ["feasible"]


def test_processes_of_the_caller_are_left_alone():
    assert said("""
own = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
during = []
start = lambda *_: during.append(subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE))
run_isolated(job(), start)
print(own.poll(), {process.poll() for process in during})
for process in (own, *during):
    process.communicate(b"\\n")
""") == ["None", "{None}"]


def test_a_command_started_with_children_ignored_plans():
    command = f"trap '' CHLD; exec {sys.executable} -m smash plan {FIGURE_1}"
    ended = subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=100)
    assert ended.returncode == 0, ended.stderr
    assert '"cost": 3' in ended.stdout
