"""`smash plan`: exit codes, one line on stderr, and when the plan is written."""

import json
import subprocess
import sys

import pytest

pytestmark = pytest.mark.usefixtures("third_party")


@pytest.fixture
def plan(tower_file, tmp_path):
    def call(planner, *arguments):
        out = tmp_path / "plan.json"
        command = [sys.executable, "-m", "smash", "plan", tower_file, "--planner", planner, "--out", out, *arguments]
        ended = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=110)
        return ended, json.loads(out.read_text()) if out.exists() else None

    return call


def test_infeasible_is_written_where_the_law_bears_it_out(plan, tower_file):
    place = {"format": "smash-instance/1", "name": "one", "blocks": ["a", "b"], "stacks": ["s"], "buffers": []}
    order = {"start": {"s": ["a", "b"]}, "goal": {"kind": "stacks", "stacks": {"s": ["b", "a"]}}}
    tower_file.write_text(json.dumps(place | order))
    ended, written = plan("gives-up", "--no-topple")
    assert (ended.returncode, written["status"]) == (3, "infeasible")
    assert ended.stderr.endswith("proven infeasible\n")


@pytest.mark.parametrize(
    ("planner", "arguments", "code", "status"),
    [
        ("sound", [], 0, "optimal"),
        ("bare", [], 0, "feasible"),
        ("hangs-with-plan", ["--budget", 0.2], 0, "feasible"),
        ("gives-up", ["--no-topple"], 7, None),
        ("gives-up", [], 4, "unknown"),
        ("hangs", ["--budget", 0.2], 4, "unknown"),
        ("nobody", [], 2, None),
        ("declines", [], 6, None),
        ("lacks", [], 6, None),
        ("raises", [], 7, None),
        ("segfaults", [], 7, None),
        ("cheats", [], 7, None),
        ("eats-memory", ["--memory", 200], 7, None),
        ("sound", ["--budget", "nan"], 2, None),
        ("sound", ["--budget", "inf"], 2, None),
    ],
)
def test_exit_code_and_file(plan, planner, arguments, code, status):
    ended, written = plan(planner, *arguments)
    assert ended.returncode == code
    assert (written and written["status"]) == status
    assert ended.stdout == ""
    quiet = code == 0 and planner != "hangs-with-plan"
    assert ended.stderr.count("\n") == (0 if quiet else 1)


def test_a_plan_that_breaks_the_law_is_named_with_its_step(plan):
    ended, _ = plan("cheats")
    assert "refused at step 1" in ended.stderr


def test_out_in_a_missing_directory_is_refused_before_planning(plan):
    ended, _ = plan("hangs", "--out", "no/such/place.json")
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1


def test_a_planner_that_gives_up_early_has_not_spent_its_budget(plan):
    assert "gave up after" in plan("gives-up")[0].stderr


def test_without_out_the_plan_is_printed(tower_file):
    command = [sys.executable, "-m", "smash", "plan", str(tower_file), "--planner", "bare"]
    assert json.loads(subprocess.run(command, capture_output=True, text=True).stdout)["cost"] == 3


@pytest.mark.parametrize(
    ("trusted", "arguments", "topple", "cap"),
    [(2, [], True, 2), (2, ["--max-topple", 1], True, 1), (1, ["--max-topple", 3], True, 1), (0, [], False, None)],
)
def test_estimates_of_execution_cap_the_topples(plan, tmp_path, trusted, arguments, topple, cap):
    rates = {str(size): {"successes": 9 * (size <= trusted), "trials": 9} for size in (1, 2, 3)}
    document = {"format": "smash-topple-estimates/1", "scene": "s", "by_cut_and_size": {"1": rates}}
    (tmp_path / "estimates.json").write_text(json.dumps(document))
    _, written = plan("greedy", "--estimates", tmp_path / "estimates.json", *arguments)
    assert (written["topple"], written["max_topple"]) == (topple, cap)
