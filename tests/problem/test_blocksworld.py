"""Blocks-world problems from outside become instances with the classical costs, or one clear line."""

import itertools
import random
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from smash import plan
from smash.cli.import_blocks import command
from smash.planners.precedence import PrecedencePlanner
from smash.planners.protocol import SolveOptions
from smash.problem import MalformedFile, OnGoal, SmashError, read_instance
from smash.problem.blocksworld.problem_file import blocksworld_instance, read_blocksworld
from smash.problem.errors import Infeasible, Unsupported

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


def test_ontable_goals_may_end_in_the_table_region():
    assert read_blocksworld(FILES / "sussman.pddl").goal == OnGoal({"a": "b", "b": "c"}, (), ("c",), ("a",))


def problem(objects="a b", init="(ontable a) (on b a) (clear b) (handempty)", goal="(on a b)", more=""):
    return f"(define (problem p) (:domain blocks) (:objects {objects}) (:init {init}) (:goal {goal}) {more})"


@pytest.mark.parametrize(
    "empty", ["handempty", "hand-empty", "HAND_EMPTY", "arm_empty", "armEmpty", "emptyhand", "empty-hand"]
)
@pytest.mark.parametrize("table", ["ontable", "on-table", "on_table", "onTable"])
@pytest.mark.parametrize("held", [False, True])
def test_the_usual_spellings_are_read_in_any_case_and_order(empty, table, held):
    facts = [
        f"({table} a)",
        "(CLEAR B)",
        "(On b a)",
        "(holding c)" if held else f"({empty})",
        "" if held else f"({table} c) (clear c)",
    ]
    random.Random(empty + table).shuffle(facts)
    found = blocksworld_instance(problem("a b c", " ".join(facts)))
    assert found.start["p1"] == ("a", "b")
    assert found.hand == ("c" if held else None)


def test_variants_of_other_collections_are_read():
    robot = problem(
        "a b - block r - robot", "(and (ontable a) (on b a) (clear b) (handempty r) (pickup a) (stack a b))"
    )
    assert blocksworld_instance(robot).blocks == ("a", "b")
    assert blocksworld_instance(problem("a b - (either block cube)")).blocks == ("a", "b")
    assert blocksworld_instance(problem(goal="(and)")).goal == OnGoal({}, ())
    assert blocksworld_instance(problem(objects="", init="(handempty)", goal="(and)")).stacks == ("p1",)
    floor = problem("a b floor", "(on a floor) (on b a) (clear b) (clear floor) (handempty)", "(on a floor)")
    assert blocksworld_instance(floor).goal == OnGoal({}, ontable=("a",))


def test_what_says_nothing_is_passed_over():
    facts = "(ontable a) (on b a) (clear b) (handempty) (not (clear a)) (not (holding a)) (= (total-cost) 0) (block a)"
    assert blocksworld_instance(problem(init=facts)) == blocksworld_instance(problem())
    more = "(:metric minimize (total-cost)) (:requirements :strips)"
    assert blocksworld_instance(problem(more=more)) == blocksworld_instance(problem())


@pytest.mark.parametrize(
    ("goal", "meant"),
    [
        ("(and (and (on a b)) (and) (clear a))", OnGoal({"a": "b"}, clear=("a",))),
        ("(forall (?x - block) (ontable ?x))", OnGoal({}, ontable=("a", "b"))),
        ("(forall (?x) (and (ontable ?x) (clear ?x)))", OnGoal({}, ontable=("a", "b"), clear=("a", "b"))),
        ("(and (handempty) (ontable b) (ontable b))", OnGoal({}, ontable=("b",))),
        ("(and (on a b) (on b a))", OnGoal({"a": "b", "b": "a"})),
        ("(and (on a b) (clear b) (= a a) (not (= a b)))", OnGoal({"a": "b"}, clear=("b",))),
        ("(clear a)", OnGoal({}, clear=("a",))),
    ],
)
def test_conjunctions_in_any_dress_are_goals(goal, meant):
    assert blocksworld_instance(problem(goal=goal)).goal == meant


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
        (problem(more="(:nonsense)"), "not known"),
        (problem(more="junk"), "is no section"),
        (problem(objects="a A b"), "'a' stands twice"),
        (problem(objects="a (b)"), "is no name"),
        (problem(objects="a b - (either)"), "(either) stands after `-`"),
        (problem(objects="a b -"), "nothing stands after `-`"),
        (problem(goal="(on a b) (on b a)"), "one atom"),
        (problem(goal="(on a q)"), "'q' is not one of"),
        (problem(goal="(on a)"), "another number of arguments"),
        (problem(init="(ontable a) (on b a) (clear b) (handempty) (on a)"), "another number of arguments"),
        (problem(init="(ontable a) (holding b)"), "nothing lies on 'a'"),
        (problem(init="(ontable a) (clear a) (handempty)"), "'b' does not stand"),
        (problem(init="(on a b) (on b a)"), "'a' does not stand"),
        (problem(init="(on a a) (ontable b) (clear b) (handempty)"), "'a' does not stand"),
        (problem(init="(ontable a) (ontable b) (on b a)"), "and on the table"),
        (problem(init="(ontable a) (on b a) (clear a)"), "'a' is clear, but 'b' is on it"),
        (
            problem(init="(ontable a) (ontable b) (clear a) (handempty)"),
            "nothing lies on 'b', but (clear b) is not said",
        ),
        (problem("a b c", "(ontable a) (on b a) (on c a)"), "both on 'a'"),
        (problem("a b c", "(ontable a) (on b a) (on b c)"), "'b' is on 'a' and on 'c'"),
        (problem(init="(ontable a) (clear a) (holding b) (handempty)"), "(handempty), but the hand holds 'b'"),
        (problem(init="(holding a) (holding b)"), "the hand holds 'a' and 'b'"),
        (problem(init="(on b a) (holding a) (clear b)"), "which the hand holds"),
        (problem(init="(ontable a) (ontable b) (clear a) (clear b) (holding b)"), "'b', which lies on something"),
        (problem(init="(ontable a) (on b a) (clear b) (handempty) (not (clear b))"), "is said, and denied too"),
        (problem(init="(ontable a) (on b a) (clear b) (handempty ghost)"), "'ghost' is not one of"),
        (problem(init="(ontable a) (on b a) (clear b) (handempty) (red phantom)"), "'phantom' is not one of"),
        (problem(init="(ontable a) (on b a) (clear b) (handempty) (not (red phantom))"), "'phantom' is not one of"),
        (problem(init="(ontable a) (on b a) (clear b) (handempty) (= (size phantom) 2)"), "'phantom' is not one of"),
        (problem(init="(ontable oak) (on b oak) (clear b) (handempty)"), "known with --domain alone"),
        (problem(init="(base a) (over b a) (clear b) (handempty)"), "give it with --domain"),
        (problem(goal="(and a)"), "is no goal"),
        (problem(init="(ontable a) (on b a) (clear b) (handempty) ((a))"), "is no fact"),
    ],
)
def test_what_is_malformed_gets_one_line(text, words):
    with pytest.raises(MalformedFile) as refusal:
        blocksworld_instance(text, "x.pddl")
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert refusal.value.exit_code == 2


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (problem("a b c", "(ontable a) (ontable b) (ontable c) (clear a) (clear b) (clear c) (handempty)",
                 "(and (on a b) (on a c))"), "(on a b) and (on a c) never hold together"),
        (problem(init="(ontable a) (on b a) (handempty)"), "no action applies"),
        (problem(goal="(= a b)"), "never holds"),
        (problem("a b table", "(on a table) (on b a) (clear b) (handempty)", "(on table a)"), "(on table a) never"),
    ],
)  # fmt: skip
def test_what_no_arrangement_fulfils_and_no_format_holds_is_infeasible(text, words):
    with pytest.raises(Infeasible) as refusal:
        blocksworld_instance(text, "x.pddl")
    assert words in str(refusal.value)
    assert refusal.value.exit_code == 3


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (problem(goal="(or (on a b) (on b a))"), "a disjunction, (or (on a b) (on b a))"),
        (problem(goal="(exists (?x) (on ?x a))"), "an existential quantifier"),
        (problem(goal="(not (on a b))"), "a negative goal, (not (on a b))"),
        (problem(goal="(forall (?x) (not (clear ?x)))"), "a negative goal"),
        (problem(goal="(imply (on a b) (clear a))"), "an implication"),
        (problem(goal="(and (holding a))"), "a block in the hand at the end, (holding a)"),
        (problem(goal="(> (size a) 2)"), "a condition on numbers"),
        (problem(goal="(preference p (on a b))"), "a preference"),
        (problem(goal="(sometime (on a b))"), "a trajectory constraint"),
        (problem(goal="(red a)"), "(red a) is not known without its domain"),
        (problem(more="(:constraints (always (clear a)))"), "constraints"),
        (problem(more="(:metric minimize (total-time))"), "a metric of total-time"),
        (problem(more="(:metric maximize (total-cost))"), "as large as can be"),
        (problem(init="(ontable a) (on b a) (clear b) (handempty) (at 3 (clear a))"), "a fact of a later time"),
        (problem(init="(ontable a) (on b a) (clear b) (handempty) (= (where a) b)"), "whose value is an object"),
        (problem(init="(ontable a) (on b a) (clear b) (oneof (handempty) (holding a))"), "a start that is not known"),
        (problem("a b l r - arm", "(ontable a) (on b a) (clear b) (handempty l) (handempty r)"), "several hands"),
        (problem("a b l r", "(ontable a) (on b a) (clear b) (handempty l) (handempty r)"), "several hands (l, r)"),
    ],
)
def test_what_is_not_supported_is_named(text, words):
    with pytest.raises(Unsupported) as refusal:
        blocksworld_instance(text, "x.pddl")
    assert words in str(refusal.value)
    assert refusal.value.exit_code == 6


def test_contradictory_goals_come_in_where_the_format_holds_them_and_are_infeasible():
    text = problem(
        "a b c", "(ontable a) (on b a) (ontable c) (clear b) (clear c) (handempty)", "(and (on a c) (on b c))"
    )
    for goal in (
        text,
        problem(goal="(and (on a b) (on b a))"),
        problem(goal="(on a a)"),
        problem(goal="(and (on a b) (clear b))"),
    ):
        result = PrecedencePlanner().solve(blocksworld_instance(goal), SolveOptions(), 5.0)
        assert result.status == "infeasible"


@pytest.mark.parametrize(
    ("text", "topple", "without"),
    [
        # uncover one block; a tower that is to lie on the table; a start with a full hand; facts that say nothing new
        (problem("a b c", "(ontable a) (on b a) (on c b) (clear c) (handempty)", "(clear b)"), 1, 2),
        (problem("a b c d", "(ontable a) (on b a) (on c b) (on d c) (clear d) (handempty)",
                 "(and (ontable a) (ontable b) (ontable c) (ontable d))"), 1, 6),
        (problem("a b c", "(ontable a) (on b a) (on c b) (clear c) (handempty)", "(forall (?x) (ontable ?x))"), 1, 4),
        (problem("a b", "(holding b) (ontable a) (clear a)", "(on b a)"), 1, 1),
        (problem(init="(ontable a) (on b a) (clear b) (handempty) (not (clear a)) (not (holding b))",
                 goal="(and (ontable a) (ontable b))"), 1, 2),
        (problem(init="(on-table a) (on b a) (clear b)"), 4, 4),
        (problem(init="(ontable a) (on b a) (clear b) (handempty) (blue a) (= (price a) 7) (same b b)"), 4, 4),
    ],
)  # fmt: skip
def test_problems_in_other_words_have_the_right_optimum(text, topple, without):
    instance = blocksworld_instance(text)
    for allowed, cost in ((True, topple), (False, without)):
        answer = plan(instance, planner="astar", topple=allowed, budget=20)
        assert (answer.status, answer.cost) == ("optimal", cost)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_every_usual_encoding_and_end_of_line_is_read(tmp_path, encoding, end):
    path = tmp_path / "p.pddl"
    path.write_bytes(f"; Klötze{end}; page\fand \v, still the comment (:domain{end}{problem()}{end}".encode(encoding))
    assert read_blocksworld(path) == blocksworld_instance(problem())


def test_files_that_are_no_text_are_refused(tmp_path):
    path = tmp_path / "p.pddl"
    path.write_bytes(b"(define (problem p)\0)")
    with pytest.raises(MalformedFile, match="no text"):
        read_blocksworld(path)


def test_ten_thousand_blocks_are_read():
    blocks = [f"b{number}" for number in range(10_000)]
    towers = [blocks[at : at + 100] for at in range(0, len(blocks), 100)]
    facts = [f"(on {upper} {under})" for tower in towers for under, upper in itertools.pairwise(tower)]
    facts += [f"(ontable {tower[0]}) (clear {tower[-1]})" for tower in towers]
    goal = "(and " + " ".join(f"(on {under} {upper})" for under, upper in itertools.pairwise(blocks)) + ")"
    found = blocksworld_instance(problem(" ".join(blocks), "(handempty) " + " ".join(facts), goal))
    assert len(found.goal.on) == 9_999
    assert found.start["p100"] == tuple(towers[-1])


WORDS = st.sampled_from(
    ["(", ")", "(", ")", "define", "problem", "p", ":objects", ":init", ":goal", "a", "b", "-", "block", "on", "clear",
     "ontable", "and", "not", "=", "forall", "?x", "either", "or", "1", "table", "handempty", "holding", "\0", ";"]
)  # fmt: skip


@settings(max_examples=150, deadline=None)
@given(st.lists(WORDS, max_size=60), st.integers(0, 300), st.integers(0, 40))
def test_any_text_is_an_instance_or_one_line(words, at, length):
    whole = problem(
        "a b - block", "(ontable a) (on b a) (clear b) (handempty)", "(and (on a b) (forall (?x) (clear ?x)))"
    )
    for text in (" ".join(words), whole[:at] + " ".join(words) + whole[at + length :]):
        try:
            said = str(blocksworld_instance(text).stacks)
        except SmashError as error:
            said = str(error)
        assert "\n" not in said


def test_the_command_writes_an_instance(tmp_path):
    out = tmp_path / "sussman.json"
    ended = CliRunner().invoke(command, [str(FILES / "sussman.pddl"), "--out", str(out)])
    assert ended.exit_code == 0
    assert read_instance(out) == read_blocksworld(FILES / "sussman.pddl")
