"""Classical plans come in and go out: their spellings, where a block is put down, what is refused and why."""

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from smash import check, make_instance, plan
from smash.problem import MalformedFile, OnGoal, Pick, Place, SmashError, Topple
from smash.problem.blocksworld.plan_text import parse_plan, plan_lines
from smash.problem.blocksworld.plans import exported, imported, in_words_of
from smash.problem.blocksworld.steps import USUAL_READING
from smash.problem.errors import RefusedPlan, Unsupported
from smash.problem.model import StacksGoal
from tests.relations import related

STEPS = (("unstack", "b", "a"), ("put-down", "b"), ("pick-up", "a"), ("stack", "a", "b"))


def pair(stacks=("s1", "s2"), buffers=(), goal=None):
    start = {"s1": ["a", "b"], **{at: [] for at in stacks[1:]}}
    return make_instance(start, goal or OnGoal({"a": "b"}), stacks=stacks, buffers=buffers)


def come_in(instance, text):
    return imported(instance, parse_plan(text, "plan"), USUAL_READING)


@pytest.mark.parametrize(
    "text",
    [
        "(unstack b a)\n(put-down b)\n(pick-up a)\n(stack a b)\n; cost = 4 (unit cost)\n",
        "; found by somebody\n\n(UNSTACK B A)\r\n(put-down  b )\r(pick-up a) ; now\n( stack a b )",
        "0: (unstack b a) [1]\n1: (put-down b) [1]\n2: (pick-up a)[1]\n3: (stack a b)[1.0]",
        "0.000: (unstack b a) [0.001]\n0.001: (put-down b) [0.001]\n0.002: (pick-up a) [1]\n0.003: (stack a b)",
        "3: (stack a b)\n0: (unstack b a)\n1: (put-down b)\n2: (pick-up a)",
        "SequentialPlan:\n    unstack(b, a)\n    put-down(b)\n    pick-up(a)\n    stack(a, b)\n",
        "SequentialPlan([unstack(b, a), put-down(b), pick-up(a), stack(a, b)])",
        "[unstack(b, a), put-down(b), pick-up(a), stack(a, b)]\n",
        "unstack(b,a)\nput_down(b)\npickup( a )\nstack( a , b )",
    ],
)
def test_the_spellings_of_other_planners_are_read(text):
    spelt = [
        (name.replace("_", "-").replace("pickup", "pick-up"), *rest) for name, *rest in parse_plan(text, "plan").steps
    ]
    assert tuple(spelt) == STEPS
    assert check(pair(), come_in(pair(), text).actions).accepted


@pytest.mark.parametrize(
    "text",
    ["(unstack b a", "unstack b a", "(unstack b a) (put-down b)", "nonsense", "()", "(a (b))", "x: (a b)", "[a(b), c"],
)
def test_what_is_no_step_is_malformed_with_its_line(text):
    with pytest.raises(MalformedFile, match=r"line 2: .* is no step"):
        parse_plan(f"(pick-up c)\n{text}\n", "plan")


def test_what_is_put_down_goes_to_the_first_empty_location_stacks_before_buffers():
    assert come_in(pair(), "(unstack b a)\n(put-down b)\n(pick-up a)\n(stack a b)").actions[1] == Place("b", "s2")
    only_buffer = pair(stacks=("s1",), buffers=("u1", "u2"))
    assert come_in(only_buffer, "(unstack b a)\n(put-down b)\n(pick-up a)\n(stack a b)").actions[1] == Place("b", "u1")
    text = (
        "(unstack b a)\n(stack b a)\n(unstack b a)\n(put-down b)\n(pick-up a)\n(put-down a)\n(pick-up a)\n(stack a b)"
    )
    assert come_in(pair(), text).actions[5] == Place("a", "s1")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("(unstack b a)\n(put-down b)", "step 2: (put-down b): no location is empty"),
        ("(unstack a b)", "step 1: (unstack a b): (on a b) does not hold"),
        ("(pick-up b)", "step 1: (pick-up b): (ontable b) does not hold"),
        ("(pick-up a)", "step 1: (pick-up a): (clear a) does not hold"),
        ("(unstack b a)\n(pick-up a)", "step 2: (pick-up a): (handempty) does not hold: (holding b)"),
        ("(stack b a)", "step 1: (stack b a): (holding b) does not hold"),
        ("(unstack b a)\n(stack b b)", "step 2: (stack b b): (clear b) does not hold"),
        ("(fly b)", "step 1: (fly b): no action is called 'fly'"),
        ("(unstack b)", "'unstack' takes 2 arguments, not 1"),
        ("(unstack b q)", "'q' is no block of the instance"),
        ("(unstack b a)\n(stack b a)", "goal not reached: (on a b) does not hold at the end"),
        ("(unstack b a)\n(stack b a)\n; cost = 3 (unit cost)", "its cost says 3, its length is 2"),
    ],
)
def test_a_wrong_plan_is_refused_with_the_step_and_the_reason(text, words):
    with pytest.raises(RefusedPlan) as refused:
        come_in(pair(stacks=("s1",)), text)
    assert words in str(refused.value)
    assert refused.value.exit_code == 3


def test_a_plan_that_ends_with_a_full_hand_gets_one_place():
    found = come_in(pair(goal=OnGoal({}, clear=("a",))), "(unstack b a)")
    assert found.actions == (Pick("b", "s1"), Place("b", "s2"))
    assert found.placed == "b"


def test_a_goal_that_only_the_last_place_would_reach_is_not_reached():
    with pytest.raises(RefusedPlan, match=r"\(on a b\) does not hold at the end"):
        come_in(pair(), "(unstack b a)\n(put-down b)\n(pick-up a)")
    with pytest.raises(RefusedPlan, match="here the hand ends empty"):
        come_in(pair(stacks=("s1",), goal=OnGoal({}, clear=("a",))), "(unstack b a)")


def test_moves_cost_a_pick_and_a_place_each():
    found = come_in(pair(), "(move-b-to-t b a)\n(move-t-to-b a b)")
    assert found.actions == (Pick("b", "s1"), Place("b", "s2"), Pick("a", "s1"), Place("a", "s2"))
    assert found.moves == 2


def test_blocks_of_the_table_region_are_picked_up_from_it():
    instance = make_instance({"s1": ["a"]}, OnGoal({"b": "a"}), table=["b"])
    assert come_in(instance, "(pick-up b)\n(stack b a)").actions[0] == Pick("b", "table")


def test_names_of_instances_are_matched_in_any_case():
    instance = make_instance({"s1": ["A", "B"], "s2": []}, OnGoal({"A": "B"}))
    assert come_in(instance, "(unstack b a)\n(put-down b)\n(pick-up a)\n(stack a b)").actions[0] == Pick("B", "s1")
    twins = make_instance({"s1": ["A", "a"], "s2": []}, OnGoal({"A": "a"}))
    with pytest.raises(Unsupported, match="differ in it alone"):
        come_in(twins, "(pick-up a)")


@pytest.mark.parametrize(
    ("instance", "actions", "moves", "words"),
    [
        (pair(goal=StacksGoal({"s1": ("a", "b")})), [], False, "only plans for `on` goals"),
        (pair(), [Topple("s1", 1)], False, "with a topple"),
        (
            make_instance({"s1": ["a b"]}, OnGoal({}, ontable=("a b",))),
            [Pick("a b", "s1"), Place("a b", "s1")],
            False,
            "cannot write",
        ),
        (make_instance({"s1": []}, OnGoal({}), hand="a"), [Place("a", "s1")], True, "a block in the hand"),
    ],
)
def test_what_has_no_classical_form_is_not_supported(instance, actions, moves, words):
    with pytest.raises(Unsupported, match=words):
        exported(instance, actions, in_words_of(USUAL_READING, moves=moves), moves=moves)


def test_moves_from_table_to_table_are_left_out():
    actions = [Pick("b", "s1"), Place("b", "s2"), Pick("b", "s2"), Place("b", "s3"), Pick("a", "s1"), Place("a", "s3")]
    found = exported(pair(stacks=("s1", "s2", "s3")), actions, in_words_of(USUAL_READING, moves=True), moves=True)
    assert found.steps == (("move-b-to-t", "b", "a"), ("move-t-to-b", "a", "b"))
    assert found.left_out == 1


def test_a_plan_goes_out_and_comes_back_with_the_same_steps_at_the_same_cost():
    came_back = 0
    for seed in range(80):
        instance = related(seed, topple=False, contradictory=0).instance
        answer = plan(instance, planner="astar", topple=False, budget=10)
        if answer.actions is None or instance.table:
            continue  # the classical table has no region of its own
        first = exported(instance, answer.actions, USUAL_READING, moves=False).steps
        text = plan_lines(first, len(first), unit=True)
        if "no location is empty" in said_of(instance, text):
            continue
        found = come_in(instance, text)
        assert check(instance, found.actions).accepted
        assert len(found.actions) == answer.cost
        assert exported(instance, found.actions, USUAL_READING, moves=False).steps == first
        came_back += 1
    assert came_back > 20


def said_of(instance, text):
    """What is said of a plan that is refused; nothing of one that comes in."""
    try:
        come_in(instance, text)
    except RefusedPlan as refused:
        return str(refused)
    return ""


WORDS = st.sampled_from(
    [
        "(",
        ")",
        "stack",
        "a",
        "b",
        ",",
        ":",
        "0",
        "[1]",
        ";",
        "cost",
        "=",
        "\n",
        " ",
        "unstack",
        "put-down",
        "(unstack b a)\n",
    ]
)


@settings(max_examples=200, deadline=None)
@given(st.lists(WORDS, max_size=30))
def test_any_text_is_a_plan_or_one_line(words):
    try:
        said = str(come_in(pair(), "".join(words)).moves)
    except SmashError as error:
        said = str(error)
    assert "\n" not in said


def test_long_plans_are_followed_in_linear_time():
    """A quadratic walk over 4,000 blocks would take minutes."""
    blocks = [f"b{number}" for number in range(4_000)]
    instance = make_instance({"s1": blocks, **{f"p{n}": [] for n in range(4_000)}}, OnGoal({}, ontable=("b1",)))
    steps = [
        step for under, upper in itertools.pairwise(blocks) for step in (("put-down", upper), ("unstack", upper, under))
    ][::-1]
    assert len(come_in(instance, plan_lines(steps, len(steps), unit=True)).actions) == 7_998
