"""Files: what is refused, with one line that says where and what is allowed; what is written is read back."""

import copy
import json
import os
from pathlib import Path
from typing import Literal

import msgspec
import pytest
from hypothesis import given, settings

from smash.cli.plan_files import read_plan_file
from smash.execution.scene.scene_file import read_scene
from smash.experiments.sweeps.experiment import read_experiment
from smash.motion.robots.files import read_robot_file
from smash.problem import MalformedFile, read_instance, read_plan, write_instance
from smash.problem.blocksworld.problem_file import read_blocksworld
from smash.problem.files.documents import MOST_BYTES, convert, replacing
from smash.problem.files.instances import instance_document, instance_from_document
from smash.problem.files.plans import plan_document, plan_from_document
from smash.problem.sets.suites import SUITES, generated_names, made_again, read_suite
from tests.strategies import instances

INSTANCE = {
    "format": "smash-instance/1",
    "name": "x",
    "blocks": ["b1", "b2", "b3"],
    "stacks": ["s1", "s2", "s3"],
    "buffers": ["u1"],
    "start": {"s1": ["b3", "b1"], "s2": ["b2"]},
    "goal": {"kind": "stacks", "stacks": {"s2": ["b1", "b2", "b3"]}},
}
PLAN = {
    "format": "smash-plan/1",
    "instance": "x",
    "planner": "smash",
    "topple": True,
    "max_topple": None,
    "status": "optimal",
    "cost": 1,
    "lower_bound": 1,
    "bound_origin": "precedence",
    "incumbents": [[0.5, 1, "greedy"]],
    "actions": [["topple", "s1", 2]],
}


def positions(**wanted):
    return {"goal": {"kind": "positions", "positions": wanted}}


def on(wanted, **more):
    return {"goal": {"kind": "on", "on": wanted, **more}}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"extra": 1}, "unknown field `extra`; allowed: format, name"),
        ({"format": "smash-instance/9"}, "'smash-instance/1' and 'smash-instance/2' are"),
        ({"name": 3}, "Expected `str`, got `int` - at `name`"),
        ({"blocks": "b1"}, "at `blocks`"),
        ({"blocks": ["b1", "b2", "b3", "b3"]}, "`blocks`: 'b3' stands twice"),
        ({"blocks": ["b1", "b2"]}, "'b3' is not one of `blocks` ('b1', 'b2')"),
        ({"start": {"s1": ["b3"], "s2": ["b2"]}}, "block 'b1' is nowhere"),
        ({"start": {"s9": ["b3", "b1"], "s2": ["b2"]}}, "'s9' is not a location"),
        ({"table": ["b1"]}, "'b1' stands twice"),
        ({"stacks": []}, "at least one location"),
        ({"stacks": ["table", "s1", "s2"]}, "names the table region"),
        ({"buffers": ["s1"]}, "'s1' stands twice"),
        ({"goal": 3}, "at `goal`"),
        ({"goal": {}}, "one of stacks, positions, on"),
        ({"goal": {"kind": ["on"]}}, "one of stacks, positions, on"),
        ({"goal": {"kind": "stacks", "stacks": {}, "on": {}}}, "unknown key 'on'; allowed: kind, stacks"),
        ({"goal": {"kind": "stacks", "stacks": {"u1": ["b1", "b2", "b3"]}}}, "'u1' is not a location of stacks"),
        ({"goal": {"kind": "stacks", "stacks": {"s2": ["b1", "b2"]}}}, "block 'b3' is nowhere"),
        (positions(b1=["s1", 2]), "height 2 of 's1' floats"),
        (positions(b1=["s1", 0]), "1 is the bottom"),
        (positions(b1=["s1", True]), "Expected `int`, got `bool`"),
        (positions(b1=["s1", 1.5]), "Expected `int`, got `float`"),
        (positions(b1=["s1", 1], b2=["s1", 1]), "is also the goal of 'b1'"),
        (positions(b9=["s1", 1]), "'b9' is not one of `blocks`"),
    ],
)
def test_a_malformed_instance_is_refused_in_one_line(change, words):
    document = copy.deepcopy(INSTANCE) | change
    with pytest.raises(MalformedFile) as caught:
        instance_from_document(document, "file.json")
    message = str(caught.value)
    assert message.startswith("file.json: ")
    assert words in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"format": "smash-instance/1"}, "'smash-plan/1' and 'smash-plan/2' are"),
        ({"extra": 1}, "unknown field"),
        ({"status": "great"}, "not one of optimal, feasible"),
        ({"actions": [["fly", "b1"]]}, "is no action; allowed"),
        ({"actions": [["topple", "s1", True]]}, "got `bool`"),
        ({"actions": [["topple", "s1", "2"]]}, "is no action"),
        ({"actions": None}, "both null or both given"),
        ({"actions": None, "cost": None}, "needs a plan"),
        ({"status": "unknown"}, "has no plan"),
        ({"max_topple": 0}, "null or 1 and more"),
    ],
)
def test_a_malformed_plan_is_refused_in_one_line(change, words):
    with pytest.raises(MalformedFile) as caught:
        plan_from_document(copy.deepcopy(PLAN) | change, "plan.json")
    assert words in str(caught.value)


def test_a_plan_is_written_as_it_was_read():
    assert plan_document(plan_from_document(PLAN)) == PLAN


@settings(max_examples=100, deadline=None)
@given(instances(odd_names=True))
def test_an_instance_is_written_as_it_was_read(instance):
    document = json.loads(json.dumps(instance_document(instance)))
    again = instance_from_document(document)
    assert instance_document(again) == document
    assert again.start == instance.start


@pytest.mark.parametrize(
    "text", ["", "{", '{"a": 1, "a": 2}', "[" * 100_000, "\ud800".encode("utf-8", "surrogatepass"), "null", "[]"]
)
def test_what_is_no_json_object_is_refused_in_one_line(tmp_path, text):
    file = tmp_path / "x.json"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(MalformedFile):
        read_instance(file)


@pytest.mark.parametrize("suite", generated_names())
def test_the_committed_sets_are_made_again_byte_for_byte(suite, tmp_path):
    made = list(made_again(suite))
    for instance in made:
        write_instance(instance, tmp_path / "again.json")
        assert (tmp_path / "again.json").read_bytes() == (SUITES / suite / f"{instance.name}.json").read_bytes()
    assert [i.name for i in read_suite(suite)] == [i.name for i in made]


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ({"inner": {"wrong": 1}}, "unknown field `wrong` - at `inner`; allowed: word"),
        ({"inner": {"word": "c"}}, "Invalid enum value 'c' - at `inner.word`; allowed: a, b"),
        ({"many": [{"word": "c"}]}, "Invalid enum value 'c' - at `many[0].word`; allowed: a, b"),
        ({"other": 1}, "unknown field `other`; allowed: inner, many"),
    ],
)
def test_a_refusal_says_what_is_allowed_where_it_is_wrong(document, words):
    with pytest.raises(MalformedFile) as refusal:
        convert(document, _Outer, "file")
    assert str(refusal.value) == f"file: {words}"


class _Inner(msgspec.Struct, forbid_unknown_fields=True):
    word: Literal["a", "b"] = "a"


class _Outer(msgspec.Struct, forbid_unknown_fields=True):
    inner: _Inner | None = None
    many: list[_Inner] = []


def test_what_is_replaced_is_whole_or_as_it_was(tmp_path):
    path = tmp_path / "film.mp4"
    path.write_text("old")

    def interrupted():
        with replacing(path) as temporary:
            temporary.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert path.read_text() == "old"
    with replacing(path) as temporary:
        assert temporary.suffix == ".mp4"
        temporary.write_text("new")
    assert [entry.name for entry in tmp_path.iterdir()] == ["film.mp4"]
    assert path.read_text() == "new"


@pytest.mark.parametrize("size", [MOST_BYTES + 1, 20 * 2**20, None], ids=["a byte", "MiB", "endless"])
@pytest.mark.parametrize(
    ("kind", "read"),
    [
        ("instance files", read_instance),
        ("plan files", read_plan),
        ("plan files", lambda path: read_plan_file(path, instance_from_document(INSTANCE), None, None)),
        ("PDDL files", read_blocksworld),
        ("scene files", read_scene),
        ("robot files", read_robot_file),
        ("experiment files", read_experiment),
    ],
)
def test_files_that_are_too_long_are_refused_unread(tmp_path, kind, read, size):
    path = Path("/dev/zero")
    if size is not None:
        path = tmp_path / "long"
        with path.open("wb") as file:
            os.truncate(file.fileno(), size)
    with pytest.raises(MalformedFile, match=f"MiB are too much; {kind} of up to 16 MiB are read$"):
        read(path)
