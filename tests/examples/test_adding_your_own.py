"""Every example of `docs/adding-your-own.md` does what the page says, from outside of the package."""

import csv
import json
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from smash_baselines.engines.configurations import FAST_DOWNWARD

from smash.planners.protocol import SolveOptions
from smash.problem import Law, PlanOptions
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples" / "extend"
FIGURE_1 = ROOT / "examples" / "figure1.json"


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The environment of a process in which the example package is installed."""
    site = tmp_path_factory.mktemp("site")
    project = tomllib.loads((EXAMPLES / "pyproject.toml").read_text())["project"]
    info = site / "smash_examples-0.1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n")
    lines = []
    for group, entries in project["entry-points"].items():
        lines += [f"[{group}]", *(f"{name} = {target}" for name, target in entries.items()), ""]
    (info / "entry_points.txt").write_text("\n".join(lines))
    shutil.copytree(EXAMPLES / "smash_examples", site / "smash_examples")
    return {**os.environ, "PYTHONPATH": f"{site}:{ROOT}"}


def run(command, environment, folder):
    return subprocess.run(
        [sys.executable, *map(str, command)], env=environment, cwd=folder, capture_output=True, text=True, timeout=100
    )


def plan(planner, environment, folder, *more):
    return run(["-m", "smash", "plan", FIGURE_1, "--planner", planner, *more], environment, folder)


@pytest.fixture
def best_first(monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLES))
    from smash_examples.planner import BestFirst

    return BestFirst()


def test_the_planner_is_known_by_its_name(installed, tmp_path):
    answer = json.loads(plan("best-first", installed, tmp_path).stdout)
    assert (answer["status"], answer["cost"]) == ("optimal", 3)
    assert "best-first" in run(["-m", "smash", "planners"], installed, tmp_path).stdout


@settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
@given(instance=instances(max_blocks=4), options=plan_options())
def test_the_planner_finds_and_proves_the_optimum(best_first, instance, options):
    answer = best_first.solve(instance, SolveOptions(options.topple, options.max_topple), 20.0)
    assert answer.cost == optimal_cost(instance, PlanOptions(options.topple, options.max_topple))
    assert answer.status == ("infeasible" if answer.cost is None else "optimal")
    assert answer.actions is None or Law(instance, options).check(answer.actions).accepted


@pytest.mark.skipif(FAST_DOWNWARD.root is None, reason="Fast Downward is not installed")
def test_the_encoding_serves_the_planners_that_take_axioms(installed, tmp_path):
    answer = json.loads(plan("fd-lama:axioms", installed, tmp_path).stdout)
    assert (answer["planner"], answer["cost"]) == ("fd-lama:axioms", 3)
    refused = plan("fd-opt:axioms", installed, tmp_path)
    assert refused.returncode == 6
    assert "no conditional effects" in refused.stderr
    assert plan("fd-lama:axioms", installed, tmp_path, "--max-topple", 2).returncode == 6


def test_the_encoding_is_written_for_planners_outside(installed, tmp_path):
    command = ["-m", "smash", "export-pddl", FIGURE_1, "--encoding", "axioms", "--out", tmp_path]
    assert run(command, installed, tmp_path).returncode == 0
    assert ":derived (over" in (tmp_path / "domain.pddl").read_text()
    assert "smash-topple-axioms" in (tmp_path / "problem.pddl").read_text()


@pytest.mark.parametrize("name", ["fd-lama:nobody", "greedy:chain", "nobody:chain", "fd-lama:"])
def test_an_encoding_that_is_none_is_one_line(name, installed, tmp_path):
    ended = plan(name, installed, tmp_path)
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1
    assert "known:" in ended.stderr


def test_the_instance_set_the_experiment_and_the_metric_meet_in_one_table(installed, tmp_path):
    for file in ("instance_set.py", "experiment.toml"):
        shutil.copy(EXAMPLES / file, tmp_path)
    assert run(["instance_set.py", "towers"], installed, tmp_path).returncode == 0
    swept = run(["-m", "smash", "sweep", "experiment.toml"], installed, tmp_path)
    assert "12 runs recorded" in swept.stdout, swept.stderr
    assert run(["-m", "smash_analysis.comparison", "runs/towers"], installed, tmp_path).returncode == 0
    with (tmp_path / "runs" / "towers" / "comparison" / "comparison.csv").open() as rows:
        table = list(csv.DictReader(rows))
    of_smash = {row["variant"]: row for row in table if row["planner"] == "smash" and row["blocks"] == "6"}
    assert of_smash["topple"]["handling"].startswith("1.00")
    assert float(of_smash["no-topple"]["handling"].split()[0]) > 1


@pytest.mark.slow
def test_the_instance_set_is_a_suite_of_compare(installed, tmp_path):
    assert run([EXAMPLES / "instance_set.py", "towers"], installed, tmp_path).returncode == 0
    command = ["compare", "towers", "--planner", "greedy", "--instances", 1, "--variant", "topple", "--budget", 1]
    ended = run(["-m", "smash", *command], installed, tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert "handling" in ended.stdout


@pytest.mark.slow
def test_the_package_installs(tmp_path):
    command = ["-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation", "--target", tmp_path, EXAMPLES]
    assert run(command, dict(os.environ), tmp_path).returncode == 0
    environment = {**os.environ, "PYTHONPATH": f"{tmp_path}:{ROOT}"}
    assert json.loads(plan("best-first", environment, tmp_path).stdout)["cost"] == 3


@pytest.fixture
def far(tmp_path):
    """A file of an instance where pouring out a tray pays."""
    places = {"s1": [0, 0], "s2": [0, 0], "g1": [9, 0], "g2": [9, 0], "table": [0, 2], "left": [0, 1], "right": [9, 1]}
    instance = {
        "format": "smash-instance/2",
        "name": "far",
        "blocks": ["a", "b", "x"],
        "stacks": ["s1", "s2", "g1", "g2"],
        "start": {"s1": ["a"], "s2": ["b"]},
        "goal": {"kind": "positions", "positions": {"a": ["g1", 1], "b": ["g2", 1]}},
        "carriers": [{"name": "tray", "stations": ["left", "right"], "at": "left", "capacity": 2, "holds": ["x"]}],
        "costs": {"actions": {"pour": 2, "carry": 5, "pick": 20, "place": 20}, "travel": 100, "positions": places},
    }
    (tmp_path / "far.json").write_text(json.dumps(instance))
    return tmp_path / "far.json"


def test_the_aggregating_action_is_planned_with_where_it_pays(installed, far, tmp_path):
    planned = run(["-m", "smash", "plan", "far.json", "--out", "plan.json"], installed, tmp_path)
    assert planned.returncode == 0, planned.stderr
    document = json.loads((tmp_path / "plan.json").read_text())
    assert document["status"] == "optimal"
    assert document["actions"][0] == ["pour", "tray"]
    assert run(["-m", "smash", "validate", "far.json", "plan.json"], installed, tmp_path).returncode == 0
    without = run(["-m", "smash", "plan", "far.json", "--without", "pour"], installed, tmp_path)
    assert json.loads(without.stdout)["cost"] > document["cost"]
    unknown = run(
        ["-m", "smash", "validate", "far.json", "plan.json"], {**installed, "PYTHONPATH": str(ROOT)}, tmp_path
    )
    assert (unknown.returncode, unknown.stderr.count("\n")) == (2, 1)


@pytest.mark.skipif(FAST_DOWNWARD.root is None, reason="Fast Downward is not installed")
def test_the_aggregating_actions_part_of_pddl_is_planned_with_at_the_same_cost(installed, far, tmp_path):
    costs = []
    for planner in ("astar", "fd-opt"):
        answer = json.loads(run(["-m", "smash", "plan", far, "--planner", planner], installed, tmp_path).stdout)
        assert (answer["status"], answer["actions"][0]) == ("optimal", ["pour", "tray"])
        costs.append(answer["cost"])
    assert costs[0] == costs[1]


ON_THE_GADGET = """
from smash.gadget.decode import decode
from smash.gadget.encode import encode
from smash.gadget.motion import motion_fault
from smash.problem import Law, read_instance, read_plan

instance = read_instance("far.json")
plan = read_plan("plan.json")
motion = encode(instance, plan.actions)
assert motion_fault(motion) is None, motion_fault(motion)
again = decode(motion, Law(instance))
assert Law(instance).check(again).accepted
print(motion.cost, Law(instance).check(again).cost)
"""


def test_the_aggregating_actions_part_of_the_gadget_encodes_and_decodes_plans_with_it(installed, far, tmp_path):
    assert run(["-m", "smash", "plan", far, "--out", "plan.json"], installed, tmp_path).returncode == 0
    answer = run(["-c", ON_THE_GADGET], installed, tmp_path)
    assert answer.returncode == 0, answer.stderr
    cost = json.loads((tmp_path / "plan.json").read_text())["cost"]
    assert answer.stdout.split() == [str(cost), str(cost)]
    drawn = run(["-m", "smash", "draw", "gadget", far, "--no-topple", "--out", "gadget.png"], installed, tmp_path)
    assert drawn.returncode == 0, drawn.stderr


@pytest.mark.slow
def test_the_papers_claim_holds_with_the_aggregating_action_too(installed):
    """Random plans with it are motions, and random motions with it are plans, at their costs."""
    ended = run(["-m", "pytest", "-p", "no:cacheprovider", "tests/gadget/test_claim.py"], installed, ROOT)
    assert ended.returncode == 0, ended.stdout


GROUPS = ("smash.aggregating", "smash.gadget_parts", "smash.pddl_parts", "smash.motions")
REGISTRIES = """
import smash.gadget.parts.registry
import smash.problem.actions.registry
import smash_baselines.parts.registry
print("known", *smash.problem.actions.registry.FAMILY, *smash.gadget.parts.registry.PARTS)
"""


@pytest.mark.parametrize("group", GROUPS)
@pytest.mark.parametrize(
    ("module", "reason"),
    [
        ("raise RuntimeError('two\\nlines')", "two lines"),
        ("Thing = int", "int is no "),
        ("import nowhere_at_all", "nowhere_at_all"),
        ("", "Thing"),
    ],
)
def test_a_faulty_addition_is_named_in_one_line_and_left_out(group, module, reason, tmp_path):
    code = REGISTRIES
    if group == "smash.motions":
        pytest.importorskip("ompl")
        code += "import smash.execution.actions.registry"
    info = tmp_path / "faulty-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: faulty\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[{group}]\nfaulty = faulty:Thing\n")
    (tmp_path / "faulty.py").write_text(module)
    path = os.pathsep.join([str(tmp_path), str(ROOT), str(ROOT / "baselines")])
    ended = run(["-c", code], {**os.environ, "PYTHONPATH": path}, tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.split() == ["known", "topple", "carry", "lift", "topple", "carry", "lift"]
    assert ended.stderr.startswith(f"smash: {group} 'faulty' of another package cannot be loaded: ")
    assert reason in ended.stderr
    assert ended.stderr.count("\n") == 1
