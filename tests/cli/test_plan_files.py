"""`smash import-plan`, `export-plan` and `validate` on plans of both kinds."""

import json
import subprocess
import sys

import pytest
from click.testing import CliRunner

from smash import make_instance, plan, read_plan, write_instance
from smash.cli import export_plan, import_plan, validate
from smash.cli.import_blocks import command as import_blocks
from smash.problem import OnGoal
from smash.problem.errors import SmashError
from smash.problem.files.plans import write_plan
from tests.pddl_replay import replay
from tests.pddl_worlds import Dress

TOWERS = (("a", "b"), ("c",))
PAIR = {"s1": ["a", "b"], "s2": [], "s3": []}


def run(module, *arguments):
    """What a command says, and its exit code."""
    ended = CliRunner().invoke(module if not hasattr(module, "command") else module.command, list(map(str, arguments)))
    if isinstance(ended.exception, SmashError):
        return str(ended.exception), ended.exception.exit_code
    assert ended.exception is None or isinstance(ended.exception, SystemExit), ended.exception
    return ended.output, ended.exit_code


@pytest.fixture
def here(tmp_path):
    write_instance(make_instance(PAIR, OnGoal({"a": "b"})), tmp_path / "i.json")
    return tmp_path


@pytest.fixture(params=[Dress("four", "mystery"), Dress("three", "crates"), Dress("hand-table", "random")], ids=str)
def dressed(request, tmp_path):
    dress = request.param
    (tmp_path / "d.pddl").write_text(dress.domain())
    (tmp_path / "p.pddl").write_text(dress.problem(TOWERS, dress.goal(on=[("a", "c")])))
    said, code = run(import_blocks, tmp_path / "p.pddl", "--domain", tmp_path / "d.pddl", "--out", tmp_path / "i.json")
    assert code == 0, said
    return dress, tmp_path


def words(folder):
    return ["--problem", folder / "p.pddl", "--domain", folder / "d.pddl"]


def test_a_plan_goes_out_in_the_words_of_its_domain_is_replayed_by_it_and_comes_back(dressed):
    dress, folder = dressed
    write_plan(plan(folder / "i.json", planner="astar", topple=False), folder / "ours.json")
    form = "classical" if dress.hand else "moves"
    said, code = run(
        export_plan, folder / "i.json", folder / "ours.json", "--as", form, *words(folder), "--out", folder / "sas"
    )
    assert code == 0, said
    lines = (folder / "sas").read_text().splitlines()
    assert replay(dress.domain(), dress.problem(TOWERS, dress.goal(on=[("a", "c")])), lines)
    said, code = run(import_plan, folder / "i.json", folder / "sas", *words(folder), "--out", folder / "back.json")
    assert code == 0, said
    back = read_plan(folder / "back.json")
    assert (back.status, back.planner, back.cost) == ("feasible", "imported", read_plan(folder / "ours.json").cost)
    assert ("2 moves" in said) == (not dress.hand)
    for plan_file, options in (("sas", words(folder)), ("back.json", [])):
        assert run(validate, folder / "i.json", folder / plan_file, *options)[1] == 0
    assert run(import_plan, folder / "i.json", folder / "ours.json", "--out", folder / "x.json")[1] == 2
    other = "moves" if dress.hand else "classical"
    refused = run(
        export_plan, folder / "i.json", folder / "ours.json", "--as", other, *words(folder), "--out", folder / "x"
    )
    assert refused[1] == 6


def test_a_wrong_plan_is_refused_in_the_words_of_its_own_file(dressed):
    dress, folder = dressed
    (folder / "sas").write_text("(nonsense a b)\n")
    said, code = run(validate, folder / "i.json", folder / "sas", *words(folder))
    assert code == 3
    assert "step 1: (nonsense a b): no action is called 'nonsense'" in said
    first = {"four": "(stack a b)", "three": "(ground a b)", "hand-table": "(a4 a b)"}[dress.kind]
    fact = {"four": "(holding a b)", "three": "(rests a b)", "hand-table": "(q7x a b)"}[dress.kind]
    (folder / "sas").write_text(first)
    said, code = run(import_plan, folder / "i.json", folder / "sas", *words(folder), "--out", folder / "x.json")
    assert code == 3
    assert f"step 1: {first}: {fact} does not hold" in said
    assert not (folder / "x.json").exists()


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        ("(unstack b a)\n(put-down b)\n(pick-up a)\n(stack a b)\n", 0, "accepted: 4 actions"),
        ("(move-b-to-t b a)\n(move-t-to-b a b)\n", 0, "accepted: 4 actions, 2 moves"),
        ("(unstack b a)\n(put-down b)\n", 3, "goal not reached: (on a b)"),
        ("", 3, "goal not reached"),
        ("(unstack b a", 2, "line 1"),
        ("{", 2, "not JSON"),
        ("topple-begin(b, a)", 3, "refused at step 1"),
    ],
)
def test_validate_takes_both_kinds(here, text, code, said):
    (here / "plan").write_text(text)
    words, ended = run(validate, here / "i.json", here / "plan")
    assert ended == code
    assert said in words
    assert words.strip().count("\n") == 0


def test_a_plan_that_ends_holding_a_block_is_said_with_its_cost(here):
    write_instance(make_instance(PAIR, OnGoal({}, clear=("a",))), here / "i.json")
    (here / "plan").write_text("(unstack b a)\n")
    said, code = run(import_plan, here / "i.json", here / "plan", "--out", here / "o.json")
    assert code == 0
    assert "'b' in the hand; one place is added, and the cost is 2" in said
    assert json.loads((here / "o.json").read_text())["actions"] == [["pick", "b", "s1"], ["place", "b", "s2"]]


@pytest.mark.parametrize("form", ["chain", "conditional"])
@pytest.mark.parametrize("topple", [True, False])
def test_the_testbed_s_encodings_go_out_and_come_back_as_they_were(here, form, topple):
    start = {"s1": ["a", "b", "c"], "s2": ["d"], "s3": []}
    write_instance(make_instance(start, {"s1": ["c"], "s2": ["b", "a", "d"]}, buffers=1), here / "i.json")
    write_plan(plan(here / "i.json", planner="astar", topple=topple), here / "ours.json")
    assert run(export_plan, here / "i.json", here / "ours.json", "--as", form, "--out", here / "steps")[1] == 0
    assert f"; cost = {read_plan(here / 'ours.json').cost} (general cost)" in (here / "steps").read_text()
    said, code = run(import_plan, here / "i.json", here / "steps", "--out", here / "back.json")
    assert code == 0, said
    assert read_plan(here / "back.json").actions == read_plan(here / "ours.json").actions
    wrong = (here / "steps").read_text().splitlines()
    (here / "steps").write_text("\n".join(wrong[1:]))
    said, code = run(validate, here / "i.json", here / "steps")
    assert code == 3
    assert "refused" in said


def test_a_plan_with_a_topple_or_without_an_on_goal_has_no_classical_form(here):
    write_instance(make_instance({"s1": ["a", "b", "c"]}, OnGoal({}, ontable=("a", "b", "c"))), here / "i.json")
    write_plan(plan(here / "i.json", planner="astar"), here / "ours.json")
    for form in ("classical", "moves"):
        said, code = run(export_plan, here / "i.json", here / "ours.json", "--as", form, "--out", here / "x")
        assert code == 6
        assert "topple" in said
    write_instance(make_instance({"s1": ["a"], "s2": []}, {"s2": ["a"]}), here / "i.json")
    write_plan(plan(here / "i.json", planner="astar", topple=False), here / "ours.json")
    assert run(export_plan, here / "i.json", here / "ours.json", "--as", "moves", "--out", here / "x")[1] == 6


def test_another_problem_than_the_instance_s_is_refused(here):
    (here / "p.pddl").write_text(Dress("four").problem((("b", "a"),), "(on b a)"))
    (here / "plan").write_text("(unstack b a)")
    said, code = run(validate, here / "i.json", here / "plan", "--problem", here / "p.pddl")
    assert code == 2
    assert "starts from another arrangement" in said


def test_the_command_line_ends_with_the_same_codes(here):
    (here / "plan").write_text("(unstack a b)\n")
    call = [sys.executable, "-m", "smash", "validate", str(here / "i.json"), str(here / "plan")]
    ended = subprocess.run(call, capture_output=True, text=True, timeout=110)
    assert ended.returncode == 3
    assert ended.stderr.count("\n") == 1
    assert ended.stderr.startswith("smash: ")
