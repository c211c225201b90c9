"""How a guardian is started: by one fork server, a copy of the caller where that is there for one run alone."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

FIGURE_1 = Path(__file__).parents[2] / "examples" / "figure1.json"
BEGIN = f"""
import os, subprocess, sys, threading, time
import psutil
import smash
from smash.experiments.isolation import starting
from smash.experiments.isolation.caller import run_isolated
from smash.experiments.isolation.job import Job
from smash.experiments.isolation.starting import guardian_of, shared_server
from smash.planners.protocol import Settings
from smash.problem.problem import Problem

def job(planner="greedy", **limits):
    return Job(planner, Problem(smash.read_instance({str(FIGURE_1)!r})), Settings(), 5.0, **limits)
"""
WHERE = """import os, sys
class Where:
    def solve(self, instance, options, budget, on_incumbent=None):
        raise ValueError(f"{os.getcwd()} {os.environ['NEW']} {sys.path[0]}")
"""


def said(program):
    """Run a program in a process of its own, which has one thread, and return what it prints."""
    ended = subprocess.run([sys.executable, "-c", BEGIN + program], capture_output=True, text=True, timeout=100)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.split()


@pytest.mark.skipif(sys.platform != "linux", reason="copies itself on Linux alone")
def test_a_process_there_for_one_run_copies_itself_unless_it_has_a_second_thread():
    assert said("""
def kind(**how):
    shared_server(Job.loaded_by).close()
    with guardian_of(job(), **how):
        return "copied" if shared_server(Job.loaded_by)._socket is None else "fresh"

print(kind(may_fork=True), kind(may_fork=False))
ends = threading.Event()
threading.Thread(target=ends.wait).start()
print(kind(may_fork=True))
ends.set()
""") == ["copied", "fresh", "fresh"]


def test_one_server_serves_all_runs_and_has_one_thread():
    assert said("""
servers = set()
for _ in range(3):
    run_isolated(job())
    servers.add(shared_server(Job.loaded_by)._process)
(server,) = servers
print(psutil.Process(server).num_threads(), len(psutil.Process(server).children()))
""") == ["1", "0"]


def test_a_killed_server_costs_no_run():
    assert said("""
for _ in range(2):
    print(run_isolated(job()).outcome)
    psutil.Process(shared_server(Job.loaded_by)._process).kill()
    time.sleep(0.1)
print(run_isolated(job()).outcome)
""") == ["feasible", "feasible", "feasible"]


@pytest.mark.slow
def test_a_server_that_stands_still_is_replaced():
    assert said("""
starting._FORKING = 2.0
run_isolated(job())
psutil.Process(shared_server(Job.loaded_by)._process).suspend()
print(run_isolated(job()).outcome)
""") == ["feasible"]


LATE = """
starting._STARTING = {seconds}
starting._SPELLS = 1000
starting._COMPUTES = {computes}
try:
    print(run_isolated(job()).outcome)
except smash.SmashError as error:
    print(error)
"""


def test_a_server_that_is_late_and_stands_still_is_not_called_ended():
    assert re.fullmatch(
        r"no process can be started for a run, after 3 attempts: "
        r"the process that starts them said nothing for 0\.\d s \(load \d+\.\d on \d+ processors?\)",
        " ".join(said(LATE.format(seconds=0.001, computes=1e9))),
    )


def test_a_server_that_is_late_and_computes_is_waited_for():
    assert said(LATE.format(seconds=0.05, computes=0.0)) == ["feasible"]


@pytest.mark.skipif(sys.platform != "linux", reason="copies itself on Linux alone")
def test_a_planner_that_is_not_ready_in_time_says_how_long_it_computed_and_how_busy_the_machine_is():
    words = " ".join(
        said("""
from smash.experiments.isolation import guardian
guardian.STARTUP_LIMIT = 0.0
report = run_isolated(job(), for_this=True)
print(report.outcome, report.reason)
""")
    )
    assert re.fullmatch(
        r"crashed not ready to plan after 0 s, \d+\.\d s of them computing \(load \d+\.\d on \d+ processors?\)", words
    )


def test_a_run_has_the_environment_the_folder_and_the_path_of_its_caller_at_that_time(tmp_path):
    site = tmp_path / "site"
    (site / "where-1.dist-info").mkdir(parents=True)
    (site / "where-1.dist-info" / "METADATA").write_text("Name: where\nVersion: 1\n")
    (site / "where-1.dist-info" / "entry_points.txt").write_text("[smash.planners]\nwhere = where:Where\n")
    (site / "where.py").write_text(WHERE)
    assert said(f"""
run_isolated(job())
os.environ["NEW"] = "word"
os.chdir({str(tmp_path)!r})
sys.path.insert(0, "site")
print(run_isolated(job(planner="where")).reason)
""") == ["ValueError:", str(tmp_path), "word", str(site), "(where.py:4)"]


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
