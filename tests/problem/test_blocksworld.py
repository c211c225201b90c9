"""Blocks-world problems from outside become instances with the classical costs, or one clear line."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from smash.cli.import_blocks import command
from smash.planners.precedence import PrecedencePlanner
from smash.planners.protocol import SolveOptions
from smash.problem import MalformedFile, OnGoal, read_instance
from smash.problem.blocksworld.problem_file import blocksworld_instance, read_blocksworld

FILES = Path(__file__).parent / "blocksworld"


def optimum(instance, topple):
    result = PrecedencePlanner().solve(instance, SolveOptions(topple=topple), 10.0)
    assert result.status == "optimal"
    return result.cost


@pytest.mark.parametrize(
    ("name", "blocks", "classical", "with_topple"),
    [("line-up", 4, 6, 6), ("sussman", 3, 6, 6), ("table-object", 2, 4, 4)],
)
def test_classical_costs_are_reproduced(name, blocks, classical, with_topple):
    instance = read_blocksworld(FILES / f"{name}.pddl")
    assert len(instance.blocks) == len(instance.stacks) == blocks
    assert instance.buffers == ()
    assert optimum(instance, topple=False) == classical
    assert optimum(instance, topple=True) == with_topple


def test_names_are_read_in_any_case_and_relations_kept():
    instance = read_blocksworld(FILES / "line-up.pddl")
    assert instance.name == "line-up"
    assert instance.goal == OnGoal({"w": "x", "x": "y", "y": "z"}, ())


def test_ontable_goals_become_bottoms():
    assert read_blocksworld(FILES / "sussman.pddl").goal == OnGoal({"a": "b", "b": "c"}, ("c",))


def problem(objects="a b", init="(ontable a) (on b a) (clear b) (handempty)", goal="(on a b)", more=""):
    return f"(define (problem p) (:domain blocks) (:objects {objects}) (:init {init}) (:goal {goal}) {more})"


def test_variants_of_other_collections_are_read():
    robot = problem(
        "a b - block r - robot", "(and (ontable a) (on b a) (clear b) (handempty r) (pickup a) (stack a b))"
    )
    assert blocksworld_instance(robot).blocks == ("a", "b")
    assert blocksworld_instance(problem(goal="(and)")).goal == OnGoal({}, ())
    assert blocksworld_instance(problem(objects="", init="(handempty)", goal="(and)")).stacks == ("p1",)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "0 expressions"),
        ("(define", "never closed"),
        ("(define))", "without its"),
        ("define", "outside of parentheses"),
        ("(" * 3000, "nested deeper"),
        ("(define (domain blocks))", "a PDDL domain"),
        ("(problem p)", "no PDDL problem"),
        ("(define (problem p) (:init (handempty)))", "`:goal` is missing"),
        (problem(more="(:init)"), "stands twice"),
        (problem(more="(:constraints)"), "not known"),
        (problem(more="junk"), "is no section"),
        (problem(objects="a A b"), "'a' stands twice"),
        (problem(objects="a (b)"), "is no name"),
        (problem(goal="(on a b) (on b a)"), "one atom"),
        (problem(goal="(not (on a b))"), "(not (on a b)) is not known"),
        (problem(goal="(on a q)"), "'q' is not one of"),
        (problem(goal="(holding a)"), "the hand holds 'a'"),
        (problem(goal="(clear a)"), "only where the goal places every block"),
        (problem(init="(ontable a) (holding b)"), "the hand holds 'b'"),
        (problem(init="(ontable a) (handempty)"), "'b' does not stand"),
        (problem(init="(on a b) (on b a)"), "'a' does not stand"),
        (problem(init="(ontable a) (ontable b) (on b a)"), "and on the table"),
        (problem(init="(ontable a) (on b a) (clear a)"), "'a' is clear, but 'b' is on it"),
        (problem("a b c", "(ontable a) (on b a) (on c a)"), "both on 'a'"),
        (problem("a b c", "(ontable a) (on b a) (on b c)"), "'b' is on 'a' and on 'c'"),
    ],
)
def test_what_is_no_blocks_world_gets_one_line(text, words):
    with pytest.raises(MalformedFile) as refusal:
        blocksworld_instance(text, "x.pddl")
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_the_command_writes_an_instance(tmp_path):
    out = tmp_path / "sussman.json"
    ended = CliRunner().invoke(command, [str(FILES / "sussman.pddl"), "--out", str(out)])
    assert ended.exit_code == 0
    assert read_instance(out) == read_blocksworld(FILES / "sussman.pddl")
