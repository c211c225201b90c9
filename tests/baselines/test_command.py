"""Any PDDL planner by its command line: where its plans are found, what becomes of whatever else it does."""

import json
import os
import shlex
import shutil
import sys
import time
from pathlib import Path

import psutil
import pytest
from click.testing import CliRunner
from smash_baselines.encodings import BY_DOMAIN, PICK_AND_PLACE, action_names, unsupported_reason
from smash_baselines.engines.command import CommandPlanner
from smash_baselines.engines.command_line import CommandLine
from smash_baselines.engines.configurations import FAST_DOWNWARD
from smash_baselines.engines.plan_text import plans_in, step_in, steps_in
from smash_baselines.read_problem import read_problem_text
from smash_baselines.task import compile_instance

from smash.cli import smash
from smash.experiments.isolation.caller import run_isolated
from smash.experiments.isolation.job import Job
from smash.experiments.sweeps.experiment import Experiment, PlannerEntry, check_experiment, experiment_runs
from smash.experiments.sweeps.sweep import execute
from smash.planners.protocol import Settings, why_refused
from smash.problem import (
    Law,
    MalformedFile,
    OnGoal,
    PlannerCrashed,
    PlanOptions,
    SmashError,
    Unsupported,
    make_instance,
    write_instance,
)
from smash.problem.problem import Problem
from tests.baselines.test_planners import Enough, figure_1
from tests.problem.test_family import scoop

PYPERPLAN = shutil.which("pyperplan", path=os.pathsep.join([os.environ["PATH"], os.path.dirname(sys.executable)]))
needs_pyperplan = pytest.mark.skipif(PYPERPLAN is None, reason="pyperplan is not installed")
ACTIONS = {"pick", "place", "pick-base", "finish"}

MOVE = "(pick-base b01 s01)\n(place-base b01 s02)\n"
"""One block moved from the first stack to the second, in the chain."""
DETOUR = "(pick-base b01 s01)\n(place-base b01 s03)\n(pick-base b01 s03)\n(place-base b01 s02)\n"


def move():
    """One block that has to go to the second of three stacks: 2 actions."""
    return make_instance({"s1": ["a"]}, {"s2": ["a"]}, name="move", stacks=3)


def program(folder, body):
    """Write a planner: Python code that is handed `domain`, `problem` and the rest of its arguments."""
    file = folder / "program.py"
    file.write_text(
        "import pathlib, sys, time\n"
        "domain, problem, *rest = map(pathlib.Path, sys.argv[1:])\n"
        f"MOVE, DETOUR = {MOVE!r}, {DETOUR!r}\n{body}\n"
    )
    return f"{shlex.quote(sys.executable)} {shlex.quote(str(file))} {{domain}} {{problem}}"


def planned(command, instance=None, *, budget=20.0, options=None, encoding=None, found=None):
    settings = Settings(command=command, encoding=encoding)
    problem = Problem(instance or move(), options or PlanOptions())
    assert why_refused(CommandPlanner(), problem, settings) is None
    return CommandPlanner().plan(problem, settings, budget, found)


@pytest.mark.parametrize(
    ("body", "further"),
    [
        ("rest[0].write_text(MOVE)", " {plan}"),
        ("rest[0].with_name(rest[0].name + '.1').write_text(MOVE)", " {plan}"),
        ("pathlib.Path(str(problem) + '.soln').write_text(MOVE)", ""),
        ("pathlib.Path('sas_plan').write_text('; a plan\\n' + MOVE.upper() + '; cost = 2 (unit cost)')", ""),
        ("pathlib.Path('sas_plan.1').write_text(DETOUR); pathlib.Path('sas_plan.2').write_text(MOVE)", ""),
        ("print('found it', MOVE, 'the end', sep='\\n')", ""),
        ("print('pick-base b01 s01 (1)', 'place-base b01 s02 (1)', 'Plan length: 2 step(s).', sep='\\n')", ""),
        ("pathlib.Path('sas_plan').touch(); time.sleep(0.5); print(MOVE)", ""),
        ("print('0: (pick-base b01 s01) [1]', '1.0: (place-base b01 s02)', sep='\\n')", ""),
    ],
)
def test_plans_are_found_where_planners_leave_them(tmp_path, body, further):
    answer = planned(program(tmp_path, body) + further)
    assert (answer.status, answer.cost, answer.lower_bound) == ("feasible", 2, None)
    assert Law(move()).check(answer.actions).accepted


def test_the_place_that_comes_first_counts(tmp_path):
    body = """
pathlib.Path('sas_plan').write_text(MOVE)
pathlib.Path(str(problem) + '.soln').write_text(DETOUR)
print(MOVE)
"""
    assert planned(program(tmp_path, body)).cost == 4
    assert planned(program(tmp_path, body) + " {plan}").status == "unknown"


def test_numbered_plans_give_a_trace_as_they_appear(tmp_path):
    body = """
pathlib.Path('sas_plan.1').write_text(DETOUR)
time.sleep(1.5)
pathlib.Path('sas_plan.2').write_text(MOVE)
time.sleep(60)
"""
    found = []

    def stop_at_the_best(seconds, cost, actions):
        found.append((seconds, cost))
        if cost == 2:
            raise Enough

    with pytest.raises(Enough):
        planned(program(tmp_path, body), budget=100.0, found=stop_at_the_best)
    assert [cost for _, cost in found] == [4, 2]
    assert found[1][0] - found[0][0] > 1


def test_a_file_that_is_half_written_is_read_again(tmp_path):
    body = """
with open('sas_plan', 'w') as file:
    file.write(MOVE[:9])
    file.flush()
    time.sleep(1)
    file.write(MOVE[9:])
"""
    answer = planned(program(tmp_path, body))
    assert answer.cost == 2
    assert "refused" not in answer.details


def test_a_plan_that_the_law_refuses_is_no_plan(tmp_path):
    answer = planned(program(tmp_path, "pathlib.Path('sas_plan').write_text('(pick-base b01 s01)\\n')"))
    assert (answer.status, answer.actions) == ("unknown", None)
    assert "the hand still holds 'a'" in answer.details["refused"][0]


@pytest.mark.parametrize(("body", "words"), [("sys.exit(1)", "exit code 1"), ("1 / 0", "ZeroDivisionError")])
def test_a_program_that_fails_has_crashed_and_its_last_words_are_said(tmp_path, body, words):
    with pytest.raises(PlannerCrashed, match=words):
        planned(program(tmp_path, body))


@pytest.mark.parametrize("code", [0, 11, 12])
def test_a_program_that_gives_up_has_proven_nothing(tmp_path, code):
    answer = planned(program(tmp_path, f"print('Completely explored state space'); sys.exit({code})"))
    assert (answer.status, answer.lower_bound) == ("unknown", None)
    assert "no proof" in answer.details["outcome"]


def test_a_program_that_claims_an_optimum_has_proven_nothing(tmp_path):
    body = "print('[t=0.1s, 9 KB] f = 2', 'Solution found!'); pathlib.Path('sas_plan').write_text(MOVE)"
    answer = planned(program(tmp_path, body))
    assert (answer.status, answer.lower_bound, answer.bound_origin) == ("feasible", None, None)


def test_nothing_of_a_program_outlives_its_budget(tmp_path):
    body = """
import subprocess
pathlib.Path('sas_plan').write_text(MOVE)
subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(99)'])
time.sleep(99)
"""
    before = set(psutil.Process().children(recursive=True))
    answer = planned(program(tmp_path, body), budget=3.0)
    assert (answer.cost, answer.details["outcome"]) == (2, "budget spent")
    assert set(psutil.Process().children(recursive=True)) <= before


def test_a_child_that_keeps_the_output_open_does_not_hold_up_the_answer(tmp_path):
    body = """
import subprocess
pathlib.Path('sas_plan').write_text(MOVE)
subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(300)'])
"""
    started = time.monotonic()
    assert planned(program(tmp_path, body), budget=200.0).details["outcome"] == "solved"
    assert time.monotonic() - started < 150


def test_no_shell_reads_the_command_line(tmp_path):
    body = "said = [str(word) for word in rest]\n"
    body += "pathlib.Path('sas_plan').write_text(MOVE if said == ['$HOME', '*', 'a b', ';'] else '')"
    assert planned(program(tmp_path, body) + " '$HOME' * 'a b' ;").cost == 2


def test_relative_files_are_those_of_where_one_is(tmp_path, monkeypatch):
    program(tmp_path, "pathlib.Path('sas_plan').write_text(MOVE)")
    monkeypatch.chdir(tmp_path)
    assert planned(f"{sys.executable} program.py {{domain}} {{problem}}").cost == 2
    os.symlink(sys.executable, tmp_path / "python-here")
    assert CommandLine.parse("./python-here {problem}").missing() is None


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("", "names no program"),
        ("{domain} {problem}", "names no program"),
        ("planner {domain}", "no place for the {problem}"),
        ("planner '{problem}", "No closing quotation"),
    ],
)
def test_a_command_line_that_is_none_is_refused_in_one_line(line, words):
    with pytest.raises(SmashError) as caught:
        CommandLine.parse(line)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_program_that_is_not_there_is_not_installed():
    with pytest.raises(Unsupported, match="not installed"):
        why_refused(CommandPlanner(), Problem(move()), Settings(command="no-such-planner {problem}"))


def test_steps_are_read_in_every_form():
    assert step_in("  (PICK b02 b01) ; cost", ACTIONS) == ("pick", "b02", "b01")
    assert step_in("0.003: (pick b02 b01) [1.000]", ACTIONS) == ("pick", "b02", "b01")
    assert step_in("pick b02 b01 (1)", ACTIONS) == ("pick", "b02", "b01")
    assert step_in("pick b02 b01", ACTIONS) is None
    assert step_in("(fly b02)", ACTIONS) is None
    assert steps_in("pick b02 b01\n; cost = 1\n", ACTIONS) == [("pick", "b02", "b01")]
    printed = ["plan:", "(pick a b)", "(place a c)", "", "better:", "(pick a c)"]
    assert [len(steps) for steps in plans_in(printed, ACTIONS)] == [2, 1]


class TestWithoutCosts:
    def test_the_domain_is_pick_and_place_without_costs(self):
        encoding = PICK_AND_PLACE.without_costs()
        assert action_names(encoding.text) == action_names(PICK_AND_PLACE.text)
        for text in (encoding.text, encoding.with_words().text):
            assert not any(word in text for word in ("action-costs", "total-cost", ":functions", "Cost"))
        assert BY_DOMAIN[encoding.domain].costs is False

    def test_the_problem_says_nothing_of_costs_and_reads_back(self):
        task = compile_instance(move(), PlanOptions(topple=False), "pick-and-place")
        assert "cost" not in task.problem_text.replace("no-costs", "")
        assert read_problem_text(task.problem_text).instance == move()

    def test_it_has_no_topple_and_nothing_of_the_family(self):
        assert "--no-topple" in unsupported_reason(Problem(move()), "pick-and-place")
        assert "chain encoding" in unsupported_reason(Problem(scoop()), "pick-and-place")
        settings = Settings(command="true {problem}", encoding="pick-and-place")
        assert why_refused(CommandPlanner(), Problem(move()), settings) is None

    @needs_pyperplan
    @pytest.mark.parametrize("options", [PlanOptions(), PlanOptions(topple=False)])
    def test_pyperplan_plans_in_it(self, options):
        command = f"{PYPERPLAN} -s astar -H hmax {{domain}} {{problem}}"
        answer = planned(command, figure_1(), options=options, encoding="pick-and-place")
        assert (answer.status, answer.cost, answer.options) == ("feasible", 8, options)

    @needs_pyperplan
    def test_pyperplan_judges_the_words_of_a_goal_and_takes_a_full_hand(self):
        goal = OnGoal({"a": "b"}, clear=("c",))
        instance = make_instance({"s1": ["c", "b"]}, goal, stacks=2, hand="a", table=["d"])
        answer = planned(f"{PYPERPLAN} {{domain}} {{problem}}", instance, encoding="pick-and-place")
        assert answer.status == "feasible"
        assert Law(instance).check(answer.actions).accepted


class TestCommandLineOfSmash:
    def run(self, tmp_path, *arguments):
        write_instance(move(), tmp_path / "move.json")
        return CliRunner().invoke(smash, ["plan", str(tmp_path / "move.json"), *arguments])

    @pytest.mark.parametrize(
        ("arguments", "words"),
        [
            (["--planner", "smash", "--command", "x {problem}"], "exclude each other"),
            (["--encoding", "chain"], "goes with --command"),
            (["--command", "x {problem}", "--encoding", "nonesuch"], "no encoding is called 'nonesuch'"),
            (["--command", "x"], "no place for the {problem}"),
        ],
    )
    def test_wrong_flags_are_said_in_one_line(self, tmp_path, arguments, words):
        result = self.run(tmp_path, *arguments)
        assert words in f"{result.output} {result.exception}"
        assert getattr(result.exception, "exit_code", result.exit_code) == 2

    def test_a_run_has_the_program_its_limits_and_the_tail_of_its_output_on_record(self, tmp_path):
        command = program(tmp_path, "print('said by it'); pathlib.Path('sas_plan').write_text(MOVE)")
        (tmp_path / "set").mkdir()
        write_instance(move(), tmp_path / "set" / "move.json")
        experiment = Experiment(
            name="outside",
            suites=[str(tmp_path / "set")],
            planners=[PlannerEntry("mine", command=command, encoding="chain")],
            budgets=[10.0],
            variants=["topple"],
        )
        check_experiment(experiment)
        [run] = experiment_runs(experiment)
        record = execute(run)
        assert (record.label, record.planner, record.command) == ("mine", "command", command)
        assert (record.outcome, record.cost, record.lower_bound) == ("feasible", 2, None)
        assert record.log == "said by it"
        assert record.details["encoding"] == "topple-chain"
        assert Job.from_document(json.loads(json.dumps(run.job.document()))) == run.job

    def test_a_run_whose_only_plan_the_law_refuses_says_so(self, tmp_path):
        command = program(tmp_path, "pathlib.Path('sas_plan').write_text('(fly b01)\\n')")
        report = run_isolated(Job("command", Problem(move()), Settings(command=command), 10.0))
        assert report.outcome == "refused"
        assert report.reason == "sas_plan: no line says a step of the domain: '(fly b01)' is the first"
        assert report.plan.status == "unknown"
        result = self.run(tmp_path, "--command", command)
        assert getattr(result.exception, "exit_code", result.exit_code) == 7

    def test_an_empty_file_is_no_plan_that_could_be_refused(self, tmp_path):
        command = program(tmp_path, "pathlib.Path('sas_plan').write_text('; nothing\\n')")
        assert run_isolated(Job("command", Problem(move()), Settings(command=command), 10.0)).outcome == "budget-spent"

    def test_a_guardian_ends_what_a_program_starts(self, tmp_path):
        body = "import subprocess\nsubprocess.Popen(['sleep', '98.7'], start_new_session=True)\ntime.sleep(99)"
        settings = Settings(command=program(tmp_path, body))
        report = run_isolated(Job("command", Problem(move()), settings, 2.0))
        assert report.outcome == "budget-spent"
        assert not [p for p in psutil.process_iter(["cmdline"]) if p.info["cmdline"] == ["sleep", "98.7"]]

    @pytest.mark.parametrize(
        ("entry", "words"),
        [
            (PlannerEntry("smash", command="x {problem}"), "a planner of its own"),
            (PlannerEntry("mine", command="x"), "no place for the {problem}"),
            (PlannerEntry("mine", command="x {problem}", encoding="nonesuch"), "no encoding is called"),
            (PlannerEntry("smash", encoding="chain"), "goes with a `command`"),
            (PlannerEntry("mine"), "no planner is called 'mine'"),
        ],
    )
    def test_an_experiment_file_is_checked_before_it_runs(self, entry, words):
        with pytest.raises(MalformedFile) as caught:
            check_experiment(Experiment(name="outside", suites=["multi-4"], planners=[entry]))
        assert words in str(caught.value)


@needs_pyperplan
@pytest.mark.skipif(FAST_DOWNWARD.root is None, reason="Fast Downward is not installed")
def test_programs_and_an_engine_of_unified_planning_stand_in_one_table_with_ours(tmp_path):
    """pyperplan, Fast Downward's own script and unified-planning's Fast Downward beside `smash`, by `smash compare`."""
    (tmp_path / "set").mkdir()
    write_instance(move(), tmp_path / "set" / "move.json")
    script = Path(FAST_DOWNWARD.root).parents[2] / "fast-downward.py"
    python = shlex.quote(sys.executable)
    arguments = [
        *("compare", str(tmp_path / "set"), "--planner", "smash", "--variant", "no-topple", "--budget", "30"),
        *("--encoding", "pick-and-place", "--out", str(tmp_path / "out")),
        *("--command", f"pyperplan={PYPERPLAN} {{domain}} {{problem}}"),
        *("--command", f"lama-first={python} {script} --plan-file {{plan}} --alias lama-first {{domain}} {{problem}}"),
        *(
            "--command",
            f"up={python} -m smash_baselines.engines.up_worker fast-downward {{domain}} {{problem}} {{plan}}",
        ),
    ]
    result = CliRunner().invoke(smash, arguments, catch_exceptions=False)
    assert result.exit_code == 0, result.output
    records = [json.loads(line) for line in (tmp_path / "out" / "runs.jsonl").read_text().splitlines()]
    assert {(r["label"], r["status"], r["cost"]) for r in records} == {
        ("smash", "optimal", 2),
        ("pyperplan", "feasible", 2),
        ("lama-first", "feasible", 2),
        ("up", "feasible", 2),
    }
    table = (tmp_path / "out" / "comparison" / "comparison.csv").read_text()
    assert all(name in table for name in ("smash", "pyperplan", "lama-first", "up"))
