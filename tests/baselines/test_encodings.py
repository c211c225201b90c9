import random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from smash_baselines.encodings import DOMAINS, ENCODINGS, TOPPLE_ENCODINGS, unsupported_reason
from smash_baselines.facts import trim_buffers
from smash_baselines.read_problem import read_problem_text
from smash_baselines.steps import actions_of, steps_of
from smash_baselines.task import compile_instance

from smash.problem import (
    IllegalAction,
    Instance,
    Law,
    MalformedFile,
    Pick,
    Place,
    PlanOptions,
    State,
    Topple,
    Unsupported,
    make_instance,
)
from smash.problem.files.instances import instance_document
from smash.problem.model import PositionsGoal, StacksGoal
from smash.problem.problem import Problem
from tests.strategies import instances, plan_options

FEW = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])


def random_walk(instance: Instance, options: PlanOptions, steps: int, seed: int):
    draw = random.Random(seed)
    law, state, actions = Law(instance, options), State.start_of(instance), []
    for _ in range(steps):
        legal = list(law.legal_actions(state))
        if not legal:
            break
        action = draw.choice(legal)
        law.apply(state, action)
        actions.append(action)
    return actions


def cost(steps) -> int:
    free = ("topple-drop", "topple-drop-base", "topple-end")
    return sum(step[0] not in free for step in steps)


@FEW
@given(instances(max_blocks=5, odd_names=True), plan_options(), st.sampled_from(TOPPLE_ENCODINGS), st.integers(0, 99))
def test_every_legal_plan_can_be_said_and_read_back_at_the_same_cost(instance, options, wanted, seed):
    if unsupported_reason(Problem(instance, options), wanted):
        return
    task = compile_instance(instance, options, wanted)
    actions = random_walk(instance, options, 20, seed)
    steps = steps_of(actions, task)
    assert cost(steps) == len(actions)
    read = actions_of(steps, task)
    assert [type(a) for a in read] == [type(a) for a in actions]
    assert Law(instance, options).states(read) is not None
    assert cost(steps_of(read, task)) == len(actions)


@FEW
@given(instances(max_blocks=5, odd_names=True), plan_options(), st.sampled_from(TOPPLE_ENCODINGS))
def test_a_problem_reads_back_as_its_instance(instance, options, wanted):
    if unsupported_reason(Problem(instance, options), wanted):
        return
    read = read_problem_text(compile_instance(instance, options, wanted).problem_text)
    assert instance_document(read.instance) == instance_document(instance)
    assert read.options.topple == options.topple
    if options.topple and options.max_topple is not None and options.max_topple < len(instance.blocks):
        assert read.options.max_topple == options.max_topple


def test_a_problem_without_the_line_of_names_reads_back_with_its_object_names():
    instance = make_instance(
        name="i",
        blocks=["x", "y", "z"],
        stacks=["p", "q"],
        buffers=["u1", "u2"],
        start={"p": ["x", "y"], "u2": ["z"]},
        goal=StacksGoal({"q": ("x", "y", "z")}),
    )
    text = compile_instance(instance, PlanOptions(), "chain").problem_text
    read = read_problem_text("\n".join(text.splitlines()[1:]).upper()).instance
    assert read.blocks == ("b01", "b02", "b03")
    assert len(read.buffers) == 2
    assert read.start["s01"] == ("b01", "b02")
    assert read.goal == StacksGoal({"s02": ("b01", "b02", "b03")})


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "balanced"),
        ("(define (problem p) (:domain other))", "none of ours"),
        ("(define (problem p)) )", "never opened"),
        ("(define (problem p) (:domain smash-topple-chain) (:init) (:goal (and)))", "hand"),
        ("(define (problem p) (:domain smash-topple-chain) (:init (hand-empty) (idle)) (:goal (and)))", "free-buffers"),
        (
            "(define (problem p) (:domain smash-topple-chain) (:objects l - location n - count)"
            "(:init (hand-empty) (idle) (free-buffers n) (base x l)) (:goal (and)))",
            "no object",
        ),
        (
            "(define (problem p) (:domain smash-topple-chain) (:objects l - location n - count)"
            "(:init (hand-empty) (idle) (free-buffers n)) (:goal (and (holding b))))",
            "goal",
        ),
    ],
)
def test_a_text_that_is_no_problem_of_ours_is_refused_in_one_line(text, word):
    with pytest.raises(MalformedFile, match=word) as error:
        read_problem_text(text)
    assert "\n" not in str(error.value)


def test_a_topple_becomes_one_action_or_a_chain_that_costs_one():
    instance = make_instance(
        name="i",
        blocks=["x", "y", "z"],
        stacks=["p"],
        start={"p": ["x", "y", "z"]},
        goal=StacksGoal({"p": ("z", "y", "x")}),
    )
    conditional = compile_instance(instance, PlanOptions(), "conditional")
    chain = compile_instance(instance, PlanOptions(), "chain")
    assert steps_of([Topple("p", 2)], conditional) == [("topple", "b02", "b01")]
    assert steps_of([Topple("p", 1)], conditional) == [("topple-base", "b01", "s01")]
    assert steps_of([Topple("p", 2)], chain) == [
        ("topple-begin", "b03", "b02"),
        ("topple-drop", "b02", "b01"),
        ("topple-end", "b01"),
    ]
    assert steps_of([Topple("p", 1)], chain)[-1] == ("topple-drop-base", "b01", "s01")


def test_the_capped_chain_counts_down():
    instance = make_instance(
        name="i",
        blocks=["x", "y", "z"],
        stacks=["p"],
        start={"p": ["x", "y", "z"]},
        goal=StacksGoal({"p": ("z", "y", "x")}),
    )
    capped = compile_instance(instance, PlanOptions(True, 2), "chain")
    assert steps_of([Topple("p", 2)], capped) == [
        ("topple-begin", "b03", "b02", "n01"),
        ("topple-drop", "b02", "b01", "n01", "n00"),
        ("topple-end", "b01", "n00"),
    ]
    with pytest.raises(Unsupported, match="count"):
        compile_instance(instance, PlanOptions(True, 2), "conditional")
    assert compile_instance(instance, PlanOptions(True, 3), "conditional").encoding is ENCODINGS["conditional"]


def test_steps_that_do_not_fit_are_refused_with_the_step():
    instance = make_instance(
        name="i", blocks=["x"], stacks=["p", "q"], start={"p": ["x"]}, goal=PositionsGoal({"x": ("q", 1)})
    )
    task = compile_instance(instance, PlanOptions(), "chain")
    for step in [("fly", "b01"), ("pick", "b99", "b01"), ("pick",), ("place-on-buffer", "b01", "n00", "n00")]:
        with pytest.raises(IllegalAction, match=step[0]):
            actions_of([step], task)
    with pytest.raises(IllegalAction):
        actions_of([("place-base", "b01", "s02")], task)
    assert actions_of([("pick-base", "b01", "s01"), ("place-base", "b01", "s02")], task) == [
        Pick("x", "p"),
        Place("x", "q"),
    ]


@FEW
@given(instances(max_blocks=4, max_buffers=6))
def test_trimming_keeps_the_used_buffers_and_enough_free_ones(instance):
    trimmed = trim_buffers(instance)
    used = {at for at in instance.buffers if instance.start[at]}
    assert used <= set(trimmed.buffers)
    assert len(trimmed.buffers) == min(len(instance.buffers), max(len(instance.blocks), len(used)))


def test_every_domain_file_is_an_encoding():
    assert {path.stem for path in DOMAINS.glob("*.pddl")} >= {encoding.name for encoding in ENCODINGS.values()}
