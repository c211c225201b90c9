"""A run's own process: limits hold, every end has a name, what was found is kept, nothing outlives it."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from threading import Event

import psutil
import pytest

from smash.experiments.isolation.caller import run_isolated, when
from smash.experiments.isolation.job import Job
from smash.experiments.isolation.shared_memory import PLACE, segments
from smash.experiments.isolation.starting import server_processes
from smash.planners.protocol import Settings
from smash.problem import PlanOptions
from smash.problem.errors import SmashError
from smash.problem.files.instances import instance_from_document, read_instance
from smash.problem.files.plans import plan_from_document, plan_text
from smash.problem.problem import Problem
from tests.experiments.troubled import SAID_ALL

pytestmark = pytest.mark.usefixtures("third_party")


def problem(file, topple=True):
    return Problem(read_instance(file), PlanOptions(topple))


@pytest.fixture
def run(tower_file):
    def call(planner, budget=60.0, memory=2048, topple=True, **more):
        return run_isolated(Job(planner, problem(tower_file, topple), Settings(), budget, memory), **more)

    return call


@pytest.fixture
def one_location():
    """Two blocks whose order one location cannot change."""
    start, goal = {"s": ["a", "b"]}, {"kind": "stacks", "stacks": {"s": ["b", "a"]}}
    place = {"format": "smash-instance/1", "name": "one", "blocks": ["a", "b"], "stacks": ["s"], "buffers": []}
    return instance_from_document({**place, "start": start, "goal": goal})


def runs(process):
    """Whether a process is there still, and no zombie."""
    try:
        return process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def marked(mark):
    """Processes that carry this value of MARKED in their environment."""
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error, OSError):
            if process.environ().get("MARKED") == mark:
                found.append(process)
    return found


@pytest.fixture
def alive(monkeypatch, tmp_path):
    """Count processes below this one, or with the mark of this test, that are still alive; the fork servers apart."""
    mark = tmp_path.name + str(time.time())
    monkeypatch.setenv("MARKED", mark)

    def count():
        found = {*marked(mark), *psutil.Process().children(recursive=True)}
        apart = {os.getpid(), *server_processes()}
        return [p for p in found if p.pid not in apart and runs(p)]

    return count


def test_incumbents_arrive_as_they_are_found_and_times_to_come_are_replaced(run):
    heard, began = [], time.monotonic()
    report = run("sound", on_incumbent=lambda seconds, cost, actions: heard.append((seconds, cost)))
    assert [cost for _, cost in heard] == [9, 5, 3]
    assert heard[0][0] == 0.0
    assert 0.0 < heard[1][0] < heard[2][0] <= time.monotonic() - began
    assert (report.outcome, report.plan.status, len(report.plan.actions), report.plan.lower_bound) == (
        "optimal",
        "optimal",
        3,
        3,
    )
    assert report.plan.incumbents[-1].origin == "engine"
    assert report.plan.details == {"nodes": 7}
    assert report.verdict.accepted
    assert report.memory_mib > 1


def test_a_plan_that_was_never_streamed_counts_from_the_end_of_the_call(run):
    report = run("bare")
    assert report.outcome == "feasible"
    assert [entry.cost for entry in report.plan.incumbents] == [3]


@pytest.mark.parametrize(
    ("planner", "outcome", "words"),
    [
        ("raises", "crashed", "ValueError: no luck (troubled.py:"),
        ("raises-at-import", "crashed", "RuntimeError: born broken"),
        ("segfaults", "crashed", "SIGSEGV"),
        ("exits", "crashed", "exit code 3"),
        ("cheats", "refused", "step 1"),
        ("boasts", "refused", "lower bound 4"),
        ("mumbles", "crashed", "no valid PlanResult"),
        ("gives-up", "budget-spent", ""),
        ("declines", "unsupported", "not today"),
        ("lacks", "not-installed", "pip install luck"),
    ],
)
def test_every_end_has_a_name_and_a_reason(run, planner, outcome, words):
    report = run(planner)
    assert report.outcome == outcome
    assert words in report.reason
    assert "\n" not in report.reason


def test_a_crash_keeps_what_was_found_and_what_was_printed(run):
    report = run("segfaults")
    assert [entry.cost for entry in report.plan.incumbents] == [5]
    assert "Segmentation fault" in report.log


def test_infeasible_is_checked_where_the_law_can_decide_it(run, one_location):
    report = run("gives-up", topple=False)
    assert (report.outcome, report.plan.status) == ("refused", "unknown")
    assert "start and goal show that there is a plan" in report.reason
    report = run_isolated(Job("gives-up", Problem(one_location, PlanOptions(topple=False)), Settings(), 60.0))
    assert (report.outcome, report.plan.status, report.reason) == ("infeasible", "infeasible", "")


@pytest.mark.parametrize(("said", "counts"), [(0.0, 3.0), (2.9, 2.9), (3.0, 3.0), (9.0, 3.0)])
def test_a_plan_counts_from_when_its_line_arrived(said, counts):
    assert when(said, arrived=3.0) == counts


def test_an_optimal_plan_is_its_own_bound(run):
    plan = run("is-sure").plan
    assert (plan.status, plan.lower_bound, plan.bound_origin) == ("optimal", 3, "is-sure")


def test_junk_on_the_pipe_names_the_planner(run):
    report = run("babbles")
    assert report.outcome == "crashed"
    assert report.reason.startswith("planner 'babbles' wrote to the pipe on which its run speaks")


def test_a_planner_that_prints_disturbs_nothing(run):
    report = run("shouts")
    assert report.outcome == "feasible"
    assert "more noise" in report.log


def test_what_a_planner_prints_counts(run, alive):
    report = run("prints-for-ever", memory=300)
    assert report.outcome == "memory"
    assert "printed and written to its scratch folder, the limit is 300" in report.reason
    assert not alive()


def test_a_killed_guardian_leaves_no_folder_and_no_process(run, alive, monkeypatch, tmp_path):
    noted = tmp_path / "scratch"
    monkeypatch.setenv("STARTS", str(noted))
    report = run("kills-its-guardian")
    assert (report.outcome, report.reason) == ("crashed", "the process that guards the run was killed")
    folder = noted.read_text()
    assert "smash-run-" in folder
    assert not os.path.exists(folder)
    assert not alive()


def test_a_hang_is_stopped_and_keeps_its_plan(run, alive):
    report = run("hangs-with-plan", budget=1.0)
    assert (report.outcome, report.plan.status, report.exit_code) == ("over-budget", "feasible", 0)
    assert not alive()


@pytest.mark.timing
def test_a_hang_is_stopped_when_its_grace_is_over(run):
    assert 0.3 + 0.5 <= run("hangs-with-plan", budget=0.3).wall_seconds < 0.3 + 0.5 + 1.0


@pytest.mark.parametrize(("topple", "status", "cost"), [(True, "feasible", 5), (False, "unknown", None)])
def test_a_hang_keeps_the_best_bound_that_it_had_proven(run, tower_file, topple, status, cost):
    report = run("hangs-with-bounds", budget=1.0, topple=topple)
    filed = plan_from_document(json.loads(plan_text(report.plan)))
    assert report.outcome == "over-budget"
    assert (filed.status, filed.cost) == (status, cost)
    assert (filed.lower_bound, filed.bound_origin) == (3, "proof of 3")


def test_a_hang_whose_plan_meets_its_bound_is_proven_all_the_same(run):
    report = run("hangs-proven", budget=1.0)
    assert (report.outcome, report.plan.status, report.plan.lower_bound, report.exit_code) == (
        "over-budget",
        "optimal",
        5,
        0,
    )


def test_a_streamed_bound_above_a_legal_plan_is_refused(run):
    report = run("hangs-after-boasting", budget=1.0)
    assert report.outcome == "refused"
    assert "lower bound 6" in report.reason
    assert report.plan.lower_bound is None


def test_an_interrupted_run_keeps_its_bound(run, alive):
    stop = Event()
    report = run("hangs-with-bounds", budget=60, stop=stop, on_incumbent=lambda *_: stop.set())
    assert (report.outcome, report.plan.status, report.exit_code) == ("interrupted", "feasible", 130)
    assert (report.plan.lower_bound, report.plan.bound_origin) == (3, "proof of 3")
    assert not alive()


def test_a_busy_hang_without_a_plan_is_budget_spent(run):
    report = run("hangs", budget=0.2)
    assert (report.outcome, report.plan.status, report.exit_code) == ("over-budget", "unknown", 4)


@pytest.mark.parametrize("planner", ["eats-memory", "eats-memory-in-a-child"])
def test_memory_is_watched_over_the_whole_tree(run, planner, alive):
    report = run(planner, memory=300)
    assert report.outcome == "memory"
    assert report.memory_mib > 300
    assert not alive()


def shared_memory():
    named = {name for name in os.listdir(PLACE) if name.startswith(("psm_", "smash-run-"))}
    return {*named, *segments()}


@pytest.mark.parametrize("planner", ["eats-shared-memory", "eats-memory-files"])  # the others: test_misbehaving.py
def test_shared_memory_counts_and_is_cleared_away(run, planner, alive):
    before = shared_memory()
    report = run(planner, memory=200)
    assert (report.outcome, report.reason.endswith("MiB used, the limit is 200")) == ("memory", True)
    assert shared_memory() <= before
    assert not alive()


def test_a_planner_may_use_shared_memory_within_its_limit_and_leaves_none(run):
    before = shared_memory()
    assert run("leaves-shared-memory").outcome == "feasible"
    assert shared_memory() <= before


def test_children_in_sessions_of_their_own_end_with_the_run(run, alive):
    assert run("leaves-children", budget=0.5).outcome == "over-budget"
    assert not alive()


def test_stopping_a_run_keeps_its_plan_and_leaves_no_process(run, alive):
    stop = Event()
    report = run("leaves-children", budget=60, stop=stop, on_incumbent=lambda *_: stop.set())
    assert (report.outcome, report.plan.status, len(report.plan.actions)) == ("interrupted", "feasible", 5)
    assert not alive()


def wait_until(condition, seconds=100.0):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return False


def said_all(processes):
    """Whether the process that a planner starts once it has streamed all is there."""
    for process in processes:
        with suppress(psutil.Error):
            if process.cmdline() == SAID_ALL:
                return True
    return False


def test_nothing_survives_a_caller_killed_with_sigkill(alive, tower_file):
    caller = subprocess.Popen(
        [sys.executable, "-m", "smash", "plan", str(tower_file), "--planner", "leaves-children", "--budget", "60"]
    )
    assert wait_until(lambda: said_all(alive()))
    caller.kill()
    caller.wait()
    assert wait_until(lambda: not alive())


def test_nothing_survives_a_guardian_killed_with_sigkill(alive, tower_file):
    caller = subprocess.Popen(
        [sys.executable, "-m", "smash", "plan", str(tower_file), "--planner", "leaves-children", "--budget", "60"],
        stderr=subprocess.PIPE,
    )
    assert wait_until(lambda: said_all(alive()))
    (server,) = psutil.Process(caller.pid).children()
    server.children()[0].kill()
    assert caller.wait(100) == 7
    assert not alive()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_plan_command_writes_what_was_found(alive, tower_file, tmp_path, number):
    out = tmp_path / "plan.json"
    command = [sys.executable, "-m", "smash", "plan", tower_file, "--planner", "leaves-children", "--out", out]
    caller = subprocess.Popen(list(map(str, command)), stderr=subprocess.PIPE, text=True)
    assert wait_until(lambda: said_all(alive()))
    caller.send_signal(number)
    _, said = caller.communicate(timeout=100)
    assert caller.returncode == 130
    assert said.count("\n") == 1
    assert '"cost": 5' in out.read_text()
    assert not alive()


def test_an_interrupted_plan_command_without_a_plan_writes_its_bound(alive, tower_file, tmp_path):
    out = tmp_path / "plan.json"
    command = [sys.executable, "-m", "smash", "plan", tower_file, "--planner", "hangs-with-bounds", "--no-topple"]
    caller = subprocess.Popen([*map(str, command), "--out", str(out)], stderr=subprocess.PIPE, text=True)
    assert wait_until(lambda: said_all(alive()))
    caller.send_signal(signal.SIGINT)
    _, said = caller.communicate(timeout=100)
    assert caller.returncode == 130
    assert "without a plan; none is cheaper than 3" in said
    document = json.loads(out.read_text())
    assert (document["status"], document["lower_bound"], document["actions"]) == ("unknown", 3, None)
    assert not alive()


def test_an_unknown_warm_start_is_a_wrong_flag(tower_file):
    job = Job("smash-layered", problem(tower_file), Settings(warm_start="nobody"), 5.0)
    with pytest.raises(SmashError, match="no planner is called 'nobody'"):
        run_isolated(job)
