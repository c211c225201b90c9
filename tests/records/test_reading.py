"""The one reader: whole typed records, every other line with its number and the reason, nothing lost on the way."""

import json
import math
from pathlib import Path

import msgspec
import pytest

from smash.problem.errors import MalformedFile
from smash.problem.files.plans import plan_document
from smash.records.believing import believed_runs
from smash.records.episodes import EpisodeRecord
from smash.records.files import EPISODES, RUNS, TRIALS
from smash.records.reading import NoRecords, finished, read
from smash.records.runs import PLAN_FIELDS, RunRecord, plan_fields
from tests.analysis.made_up import record, write

ROOT = Path(__file__).parents[2]
KINDS = (RUNS, EPISODES, TRIALS)
COMMITTED = [(file.parent, kind) for kind in KINDS for file in sorted((ROOT / "results").rglob(kind.name))]
PLAN = [["topple", "s1", 2], ["pick", "b1", "table"], ["place", "b1", "s2"]]


@pytest.mark.parametrize(("directory", "kind"), COMMITTED, ids=lambda part: getattr(part, "name", ""))
def test_committed_records_are_read_whole_and_say_what_they_said(directory, kind):
    reading = read(directory, kind)
    assert reading.damaged == []
    documents = [json.loads(line) for line in kind.path(directory).read_text().splitlines()]
    assert [one.document for one in reading.records] == documents
    assert all(one.further == {} for one in reading.records)


def test_a_field_of_a_later_version_is_kept(tmp_path):
    later = record(0, [(0.1, 3)]).document | {"disturbed": True, "engine": {"name": "e"}}
    (tmp_path / RUNS.name).write_text(json.dumps(later) + "\n")
    (one,) = read(tmp_path, RUNS).records
    assert one.further == {"disturbed": True, "engine": {"name": "e"}}
    assert one.document == later


def test_a_field_that_is_optional_may_be_missing(tmp_path):
    older = record().document
    del older["without"]
    (tmp_path / RUNS.name).write_text(json.dumps(older) + "\n")
    (one,) = read(tmp_path, RUNS).records
    assert one.without == []
    assert "without" not in one.document


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("", "no JSON"),
        ('{"format": "smash-run/1"', "no JSON"),
        ("\xff", "no JSON"),
        ("[1]", "no smash-run/1 object: Expected `object`"),
        ("{}", "no smash-run/1 object: Object missing required field"),
        (json.dumps(record().document | {"format": "smash-run/2"}), "no smash-run/1 object: Invalid enum value"),
        (json.dumps(record().document | {"details": {"share": math.nan}}), "no JSON: NaN is no number of JSON"),
        (json.dumps(record().document | {"wall_seconds": -math.inf}), "no JSON: -Infinity is no number of JSON"),
        (
            json.dumps(record().document | {"wall_seconds": 9}).replace(": 9,", ": 1e999,"),
            "no JSON: 1e999 is no number",
        ),
        (json.dumps(record().document | {"wall_seconds": -1.0}), "no smash-run/1 object: Expected `float` >= 0"),
        (json.dumps(record().document | {"cost": 10**30}), "no smash-run/1 object: "),
        ("[" * 100_000 + "]" * 100_000, "no JSON: nested too deeply"),
        (json.dumps(record().document | {"cost": "five"}), "no smash-run/1 object: Expected `int | null`"),
    ],
)
def test_a_line_that_is_no_record_is_named_and_hides_no_other(tmp_path, line, reason):
    whole = json.dumps(record().document).encode()
    (tmp_path / RUNS.name).write_bytes(b"\n".join([whole, line.encode("latin-1"), whole, b""]))
    reading = read(tmp_path, RUNS)
    assert [one.number for one in reading.lines] == [1, 3]
    (damaged,) = reading.damaged
    assert (damaged.number, damaged.last) == (2, False)
    assert damaged.reason.startswith(reason)
    said, twice = reading.notes()
    assert said.startswith(f"{tmp_path / RUNS.name}:2: {reason}")
    assert twice.endswith(":3: has the key of line 1; counted once")
    assert reading.records == [reading.lines[0].record]


def test_a_half_written_last_line_is_a_kill_s_trace(tmp_path):
    write(tmp_path, [record(0), record(1)])
    with open(tmp_path / RUNS.name, "a") as file:
        file.write('{"format": "smash-ru')
    reading = read(tmp_path, RUNS)
    assert [(one.number, one.last) for one in reading.damaged] == [(3, True)]
    assert believed_runs(tmp_path).records == reading.records


def test_without_a_whole_record_there_is_one_line(tmp_path):
    with pytest.raises(MalformedFile, match="cannot be read"):
        read(tmp_path, RUNS)
    for content, kind in (("", RUNS), ("{", EPISODES)):
        kind.path(tmp_path).write_text(content)
        with pytest.raises(NoRecords, match=f"no finished {kind.one}"):
            finished(tmp_path, kind)
    write(tmp_path, [record(0)])
    with pytest.raises(NoRecords, match="no finished run"):
        believed_runs(tmp_path, {"another"})


def test_what_python_writes_and_strict_json_does_not_have_is_read(tmp_path):
    odd = record(0, instance="\ud800", details={"states": 10**30})
    write(tmp_path, [odd])
    (one,) = read(tmp_path, RUNS).records
    assert one.instance == "\ud800"
    assert one.details["states"] == 10**30
    assert one.further == {}


def test_a_record_is_a_plan_and_how_it_ended():
    run = record(0, [(0.1, 3)], actions=PLAN, cost=3, without=["lift"])
    plan = run.plan
    assert plan_document(plan)["actions"] == PLAN
    assert plan.options.without == ("lift",)
    assert plan_fields(plan) == {name: json.loads(json.dumps(run.document[name])) for name in PLAN_FIELDS}
    changed = msgspec.structs.replace(run, actions=[["fly"]])
    with pytest.raises(MalformedFile, match="is no action"):
        _ = changed.plan


def test_a_refused_answer_leaves_no_trace():
    assert record(0, [(0.1, 3)]).trace == [(0.1, 3)]
    assert record(0, [(0.1, 3)], outcome="refused").trace == []


def test_what_was_made_here_and_what_was_read_are_equal(tmp_path):
    made = record(0, [(0.1, 3)], actions=PLAN)
    (one,) = read(write(tmp_path, [made]), RUNS).records
    assert one == made
    assert one.document == made.document
    assert isinstance(one, RunRecord)
    assert EPISODES.record is EpisodeRecord


def test_runs_of_several_solvers_under_one_label_are_refused(tmp_path):
    runs = [record(0, [(1.0, 5)], solver="cpsat"), record(1, [(1.0, 5)])]
    with pytest.raises(MalformedFile, match="labelled 'p' are of the solvers cpsat and highs"):
        believed_runs(write(tmp_path, runs))
    apart = [record(0, [(1.0, 5)], solver="cpsat", label="q"), record(1, [(1.0, 5)])]
    assert [run.solver for run in believed_runs(write(tmp_path, apart)).records] == ["cpsat", "highs"]
