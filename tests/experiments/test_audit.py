"""The audit of records: each thing that can be wrong with them is found and named."""

import json
from dataclasses import replace
from datetime import UTC, datetime

import msgspec
import pytest
from click.testing import CliRunner

from smash.cli import smash
from smash.experiments.isolation.job import Report
from smash.experiments.sweeps.audit import audit
from smash.experiments.sweeps.experiment import experiment_runs, read_experiment
from smash.experiments.sweeps.sweep import record_of
from smash.planners.protocol import Settings, ask
from smash.planners.registry import get_planner
from smash.problem.plan import Incumbent
from smash.records.runs import RunRecord

EXPERIMENT = 'name = "few"\nsuites = ["multi-4"]\ninstances = 2\nbudgets = [1]\n[[planners]]\nname = "greedy"\n'


def finished(run):
    """The record of a run as a sweep makes it, planned in this process."""
    plan = ask(get_planner("greedy"), run.job.problem, Settings(), 1.0, name="greedy")
    plan = replace(plan, incumbents=(Incumbent(0.01, plan.cost, "greedy"),))
    verdict = run.job.problem.law.check(plan.actions)
    report = Report("feasible", plan, verdict=verdict, wall_seconds=0.1, cpu_seconds=0.1, memory_mib=50.0)
    record = record_of(run, report, datetime.now(UTC), 0.0)
    return record.document | {"commit": {"hash": "c" * 40, "dirty": False}}


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    file = tmp_path_factory.mktemp("sound") / "few.toml"
    file.write_text(EXPERIMENT)
    return [finished(run) for run in experiment_runs(read_experiment(file))]


@pytest.fixture
def check(tmp_path):
    """Write records and a line as it is; return the exit code and the findings of `smash records check`."""

    def ask(records, last=""):
        (tmp_path / "experiment.toml").write_text(EXPERIMENT)
        (tmp_path / "runs.jsonl").write_text("".join(json.dumps(record) + "\n" for record in records) + last)
        ended = CliRunner().invoke(smash, ["records", "check", str(tmp_path)])
        assert ended.stdout.count("┃") > 2
        return ended.exit_code, ended.stderr.splitlines()

    return ask


def changed(records, **fields):
    """The records, the first of them changed."""
    return [records[0] | fields, *records[1:]]


def test_sound_records_are_well(check, sound):
    assert check(sound) == (0, [])


@pytest.mark.parametrize(
    ("fields", "finding"),
    [
        ({"commit": {"hash": "d" * 40, "dirty": False}}, "mixed commits: cccccccccccc (3 runs), dddddddddddd (1 runs)"),
        ({"commit": {"hash": "c" * 40, "dirty": True}}, "changed files: 1 of 4 runs"),
        ({"versions": {"python": "2.7"}}, "mixed versions: python"),
        ({"outcome": "crashed"}, "unexplained: line 1 (greedy on multi-4/multi-4-000, topple, 12 buffers): crashed"),
        ({"outcome": "interrupted"}, "unexplained: line 1 "),
        ({"outcome": "refused", "reason": "refused at step 1: no"}, "refused: line 1 "),
        ({"instance_hash": "0"}, "refused now: line 1 "),
        ({"lower_bound": 1000}, "refused now: line 1 "),
        ({"cost": "five"}, "damaged: line 1: no smash-run/1 object: Expected `int | null`"),
        ({"format": "smash-run/2"}, "damaged: line 1: "),
    ],
)
def test_what_is_wrong_is_one_line_each(check, sound, fields, finding):
    code, found = check(changed(sound, **fields))
    found = [line for line in found if not line.startswith("missing")]
    assert code == 3
    assert len(found) == 1
    assert found[0].startswith(finding)


def test_a_recorded_plan_that_the_law_refuses_is_found_whatever_its_verdict_says(check, sound):
    code, found = check(changed(sound, actions=sound[0]["actions"][:-2], cost=sound[0]["cost"] - 2))
    assert (code, len(found)) == (3, 1)
    assert found[0].startswith("refused now: line 1 ")


def test_missing_runs_are_counted_by_setting(check, sound):
    assert check(sound[:-1]) == (3, ["missing: greedy on multi-4, no-topple, anytime 1 s: 1 of 2 runs"])


def test_no_record_at_all_is_no_damage(check):
    code, found = check([])
    assert (code, len(found)) == (3, 2)
    assert all(line.startswith("missing: ") for line in found)


def test_records_of_other_settings_and_repeated_ones_are_found(check, sound):
    stranger = sound[0] | {"key": "another", "label": "other"}
    code, found = check([*sound, stranger, sound[0]])
    assert code == 3
    assert found[0] == "not planned: other on multi-4, topple, anytime 1 s: 1 runs"
    assert found[1].startswith("twice: line 1 (greedy")
    assert found[1].endswith("again in line 6")


def test_a_half_written_last_line_is_found_and_its_run_is_missing(check, sound):
    code, found = check(sound[:-1], last=json.dumps(sound[-1])[:200])
    assert code == 3
    assert [line.split(":")[0] for line in found] == ["damaged", "missing"]


def test_a_damaged_line_in_the_middle_hides_none_after_it(check, sound):
    whole = [json.dumps(record) + "\n" for record in sound]
    code, (found,) = check([], last=whole[0] + "broken\n" + "".join(whole[1:]))
    assert code == 3
    assert found.startswith("damaged: line 2: no JSON: ")
    assert found.endswith("; start the sweep again: it is set aside, its run done")


def test_contradictions_are_found_without_the_planners_that_were_run(check, sound):
    sure = {"status": "optimal", "outcome": "optimal", "planner": "gone", "label": "gone", "key": "another"}
    cost = sound[0]["cost"] + 2
    top = sound[0]["actions"][-1]
    wasted = [["pick", top[1], top[2]], top]
    liar = sound[0] | sure | {"cost": cost, "incumbents": [[0.1, cost, "x"]]}
    code, found = check([*sound, liar | {"actions": sound[0]["actions"] + wasted}])
    assert code == 3
    (said,) = [line for line in found if line.startswith("contradiction")]
    assert f"gone says that no plan is cheaper than {cost}, greedy has a plan of {cost - 2}" in said


def test_an_experiment_of_planners_that_are_not_here_is_read(tmp_path, sound):
    (tmp_path / "experiment.toml").write_text(EXPERIMENT + '[[planners]]\nname = "gone"\n')
    (tmp_path / "runs.jsonl").write_text("".join(json.dumps(record) + "\n" for record in sound))
    ended = CliRunner().invoke(smash, ["records", "check", str(tmp_path)])
    assert ended.exit_code == 3
    assert all(line.startswith("missing: gone on multi-4") for line in ended.stderr.splitlines())


def test_without_an_experiment_completeness_is_left_open(tmp_path, sound):
    (tmp_path / "runs.jsonl").write_text(json.dumps(sound[0]) + "\n")
    answers = {check.question: check.answer for check in audit(tmp_path, lambda records: "no file")}
    assert answers["complete"] == "not known: no file"
    ended = CliRunner().invoke(smash, ["records", "check", str(tmp_path)])
    assert ended.exit_code == 0
    assert "--experiment FILE" in ended.stdout


def test_a_record_fits_the_schema_to_the_last_field(sound):
    assert set(sound[0]) == {field.name for field in msgspec.structs.fields(RunRecord)}
    assert msgspec.convert(sound[0], RunRecord).cost == sound[0]["cost"]


@pytest.mark.parametrize("name", ["check", "export"])
def test_help_has_examples(name):
    shown = CliRunner().invoke(smash, ["records", name, "--help"]).output
    assert f"smash records {name} runs/ablation" in shown
    assert "\\b" not in shown
