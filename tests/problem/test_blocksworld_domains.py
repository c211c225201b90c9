"""A blocks world is recognised by what its actions do, whatever they are called and however they are written."""

import pytest

from smash import check, make_instance, plan
from smash.problem import OnGoal, SmashError
from smash.problem.blocksworld.domain import domain_from
from smash.problem.blocksworld.placing import placed
from smash.problem.blocksworld.plan_text import PlanText, parse_plan, plan_lines
from smash.problem.blocksworld.plans import exported, imported
from smash.problem.blocksworld.problem import blocks_problem
from smash.problem.blocksworld.roles import Recognizer
from smash.problem.blocksworld.sections import problem_from
from smash.problem.blocksworld.sexpr import parse_expression
from smash.problem.errors import Unsupported
from tests.pddl_replay import World, replay
from tests.pddl_worlds import FOUR, KINDS, Dress, dresses

TOWERS = (("a", "b"), ("c",), ("d",))


def recognizer(domain):
    return Recognizer(domain_from(parse_expression(domain, "d.pddl"), "d.pddl"))


def read(domain, problem):
    return blocks_problem(problem_from(parse_expression(problem, "p.pddl"), "p.pddl"), recognizer(domain))


@pytest.mark.parametrize("dress", list(dresses()), ids=str)
def test_every_kind_in_every_spelling_comes_in_and_its_plan_goes_out_again(dress):
    grounded = ["b"] if dress.kind != "no-ontable" else []
    goal = dress.goal(on=[("a", "c"), ("d", "a")], ontable=grounded)
    domain, problem = dress.domain(), dress.problem(TOWERS, goal)
    found = read(domain, problem)
    assert set(found.start.towers()) == set(TOWERS)
    assert found.reading.hand == dress.hand
    instance = placed(found).instance
    assert instance.goal == OnGoal({"a": "c", "d": "a"}, (), tuple(grounded))

    answer = plan(instance, planner="greedy", topple=False, budget=20)
    moves = not dress.hand
    steps = exported(instance, answer.actions, found.reading, moves=moves).steps
    assert replay(domain.lower(), problem.lower(), plan_lines(steps, len(steps), unit=True).splitlines())
    back = imported(instance, PlanText(steps), found.reading)
    assert len(back.actions) == answer.cost
    assert exported(instance, back.actions, found.reading, moves=moves).steps == steps
    assert check(instance, back.actions).accepted
    assert back.moves == (len(steps) if moves else None)


@pytest.mark.parametrize("dress", list(dresses()), ids=str)
def test_the_first_wrong_step_is_the_one_that_the_domain_itself_refuses(dress):
    domain, problem = dress.domain().lower(), dress.problem(TOWERS, dress.goal(on=[("a", "c")])).lower()
    found = read(domain, problem)
    instance = placed(found).instance
    answer = plan(instance, planner="greedy", topple=False, budget=20)
    steps = exported(instance, answer.actions, found.reading, moves=not dress.hand).steps
    for wrong in (steps[1:], steps[:1] + steps[:1] + steps[1:], (*steps, steps[-1])):
        world, refused = World(domain, problem), None
        for number, step in enumerate(wrong, start=1):
            try:
                world.do(*step)
            except AssertionError:
                refused = number
                break
        with pytest.raises(SmashError) as caught:
            imported(instance, PlanText(wrong), found.reading)
        assert (f"refused at step {refused}: ({' '.join(wrong[refused - 1])})" in str(caught.value)) == (
            refused is not None
        )


@pytest.mark.parametrize("kind", ["four", "four-reversed", "quantified", "derived", "hand-table", "no-ontable"])
def test_a_start_with_a_block_in_the_hand_comes_in(kind):
    dress = Dress(kind, "random")
    found = read(dress.domain(), dress.problem((("a", "b"),), dress.goal(on=[("c", "b")]), held="c"))
    assert found.start.held == "c"
    assert placed(found).instance.hand == "c"


def test_a_rule_s_predicate_can_be_a_goal():
    dress = Dress("derived", "crates")
    assert read(dress.domain(), dress.problem(TOWERS, dress.goal(clear=["a"]))).goal == OnGoal({}, clear=("a",))


def test_a_problem_without_a_name_in_common_is_said_in_one_line():
    found = read(Dress("four", "mystery").domain(), Dress("four", "mystery").problem(TOWERS, "(and)"))
    assert found.reading.said().startswith("on = holding, ontable = clear, clear = on, holding = ontable")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("(clear ?x) (handempty{H}) {empty} (ontable ?x)", "(clear ?x) (handempty{H})", "no blocks world"),
        ("(not (handempty{H})) {full} (not (on {XY}))", "(not (handempty{H}))", "takes a block from another block"),
        ("(holding ?x) (clear ?y) {S})", "(holding ?x) {S})", "'stack' does what no step"),
        ("(:action stack", "(:durative-action stack", "durative actions"),
        ("(ontable ?x)))", "(ontable ?x) (increase (fuel) 2)))", "the numeric effect (increase (fuel) 2)"),
        ("(and (holding ?x) (clear ?y) {S})", "(and (holding ?x) (clear ?y) (> (size ?x) 1))", "numeric condition"),
        ("(ontable ?x)))", "(oneof (ontable ?x) (holding ?x))))", "an effect of chance"),
        ("(and (holding ?x) {S})", "(and (holding ?x) (allowed ?x))", "puts the block in the hand on the table"),
        ("", "(:action swap :parameters (?x ?y) :precondition (on ?x ?y) :effect (clear ?y))", "'swap' does what"),
    ],
)  # fmt: skip
def test_what_is_no_blocks_world_is_said_with_what_does_not_fit(old, new, words):
    assert old in FOUR
    from tests import pddl_worlds

    dress = Dress("four")
    problem = dress.problem(TOWERS, "(and)")
    kept = pddl_worlds.KINDS["four"]
    pddl_worlds.KINDS["four"] = FOUR.replace(old, new) if old else FOUR + new
    try:
        domain = dress.domain()
    finally:
        pddl_worlds.KINDS["four"] = kept
    with pytest.raises(Unsupported) as refused:
        read(domain, problem)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_actions_that_some_blocks_are_not_given_are_no_blocks_world():
    dress = Dress("four", extras=frozenset({"static"}))
    problem = dress.problem(TOWERS, "(and)").replace("(movable c)", "")
    with pytest.raises(Unsupported, match="no blocks world"):
        read(dress.domain(), problem)


def test_an_action_for_blocks_of_one_type_alone_is_not_supported():
    dress = Dress("four")
    domain = dress.domain().replace("(:predicates", "(:types red blue) (:predicates", 1)
    domain = domain.replace("(:action pick-up :parameters (?x )", "(:action pick-up :parameters (?x - red)", 1)
    assert "?x - red" in domain
    problem = dress.problem(TOWERS, "(and)").replace("(:objects a b c d", "(:objects a c d - red b - blue", 1)
    assert "b - blue" in problem
    with pytest.raises(Unsupported, match="does not take 'b', by its type"):
        read(domain, problem)


def test_several_hands_are_named():
    dress = Dress("four", typed=True, extras=frozenset({"hand-object"}))
    problem = (
        dress.problem(TOWERS, "(and)")
        .replace("robby - arm", "robby lefty - arm")
        .replace("(handempty robby)", "(handempty robby) (handempty lefty)")
    )
    with pytest.raises(Unsupported, match=r"several hands \(robby, lefty\)"):
        read(dress.domain(), problem)


@pytest.mark.parametrize(
    "dress",
    [
        *(Dress(kind, "random") for kind in KINDS if kind != "no-ontable"),
        Dress("four", "mystery", typed=True, extras=frozenset({"hand-object", "static", "constants"})),
    ],
    ids=str,
)
def test_the_domain_alone_says_what_a_plan_means(dress):
    instance = make_instance({"s1": ["a", "b"], "s2": ["c"], "s3": ["d"], "s4": []}, OnGoal({"a": "c"}))
    reading = recognizer(dress.domain()).reading_of_blocks(["a", "b", "c", "d"])
    found = read(dress.domain(), dress.problem(TOWERS, dress.goal(on=[("a", "c")])))
    answer = plan(instance, planner="greedy", topple=False)
    steps = exported(instance, answer.actions, found.reading, moves=not dress.hand).steps
    assert imported(instance, parse_plan(plan_lines(steps, len(steps), unit=True), "p"), reading).actions
