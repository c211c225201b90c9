"""Classical blocks worlds through the unified-planning engine, and its plans and engines as ours."""

import functools
import itertools
import random
import re
from collections import deque

import pytest

pytest.importorskip("unified_planning")

import unified_planning.engines
from smash_baselines.engines.configurations import FAST_DOWNWARD
from smash_baselines.read_up import reading_of
from smash_baselines.task import compile_instance
from smash_baselines.up_classical import Classical
from smash_baselines.up_engine import SmashEngine
from smash_baselines.up_planner import planner_of_up_engine
from smash_baselines.up_problem import plan_of_up_plan, problem_of_task, up_plan
from unified_planning.engines import PlanGenerationResultStatus as Status
from unified_planning.engines import SequentialPlanValidator
from unified_planning.exceptions import UPUsageError
from unified_planning.io import PDDLReader
from unified_planning.plans import ActionInstance, PartialOrderPlan
from unified_planning.shortcuts import (
    Always,
    MinimizeMakespan,
    MinimizeSequentialPlanLength,
    Problem,
    get_environment,
)

import smash
from smash.planners.protocol import SolveOptions
from smash.problem import (
    IllegalAction,
    Law,
    MalformedFile,
    OnGoal,
    PlanOptions,
    PositionsGoal,
    Unsupported,
    make_instance,
)
from smash.problem.blocksworld.domain import domain_from
from smash.problem.blocksworld.sections import problem_from
from smash.problem.blocksworld.sexpr import parse_expression
from tests.baselines.test_planners import figure_1
from tests.oracle import optimal_cost
from tests.pddl_worlds import KINDS, Dress

needs_engine = pytest.mark.skipif(FAST_DOWNWARD.root is None, reason="Fast Downward is not installed")

DOMAIN = """(define (domain blocks) (:requirements :strips{requirements}) {types}
  (:predicates (on ?x ?y{block}) (ontable ?x{block}) (clear ?x{block}) (handempty) (holding ?x{block}) (red ?x{block}))
  (:action pick-up :parameters (?x{block})
    :precondition (and (clear ?x) (ontable ?x) (handempty))
    :effect (and (not (ontable ?x)) (not (clear ?x)) (not (handempty)) (holding ?x)))
  (:action put-down :parameters (?x{block})
    :precondition (holding ?x)
    :effect (and (not (holding ?x)) (clear ?x) (handempty) (ontable ?x)))
  (:action stack :parameters (?x ?y{block})
    :precondition (and (holding ?x) (clear ?y))
    :effect (and (not (holding ?x)) (not (clear ?y)) (clear ?x) (handempty) (on ?x ?y)))
  (:action unstack :parameters (?x ?y{block})
    :precondition (and (on ?x ?y) (clear ?x) (handempty))
    :effect (and (holding ?x) (clear ?y) (not (clear ?x)) (not (handempty)) (not (on ?x ?y)))))
"""
UNTYPED = DOMAIN.format(requirements="", types="", block="")
TYPED = DOMAIN.format(requirements=" :typing", types="(:types brick)", block=" - brick")


OBFUSCATED = """(define (domain d) (:predicates (f1 ?p ?q) (f2 ?p) (f3) (f4 ?p) (f5 ?p))
  (:action o1 :parameters (?p) :precondition (f5 ?p) :effect (and (not (f5 ?p)) (f4 ?p) (f3) (f2 ?p)))
  (:action o2 :parameters (?q ?p) :precondition (and (f1 ?q ?p) (f4 ?p) (f3))
    :effect (and (f5 ?p) (f4 ?q) (not (f4 ?p)) (not (f3)) (not (f1 ?q ?p))))
  (:action o3 :parameters (?p ?q) :precondition (and (f5 ?p) (f4 ?q))
    :effect (and (not (f5 ?p)) (not (f4 ?q)) (f4 ?p) (f3) (f1 ?q ?p)))
  (:action o4 :parameters (?p) :precondition (and (f2 ?p) (f4 ?p) (f3))
    :effect (and (not (f2 ?p)) (not (f4 ?p)) (not (f3)) (f5 ?p))))
"""
"""The same world under names that say nothing; its `on` names the lower block first, and its `unstack` too."""


def problem(
    objects="a b c", start="(ontable a) (on b a) (on c b) (clear c) (handempty)", goal="(on a c)", domain=UNTYPED
):
    kind = " - brick" if "brick" in domain else ""
    text = f"(define (problem p) (:domain blocks) (:objects {objects}{kind}) (:init {start}) (:goal (and {goal})))"
    return PDDLReader().parse_problem_string(domain, text)


def answers(asked, planner="fd-opt-ipdb", timeout=100):
    return list(SmashEngine(planner).get_solutions(asked, timeout=timeout))


def shortest(asked):
    """Return the length of the shortest plan, by breadth-first search with the library's own simulator."""
    from unified_planning.engines import UPSequentialSimulator

    simulator = UPSequentialSimulator(asked)
    facts = list(asked.initial_values)
    start = simulator.get_initial_state()
    queue, seen = deque([(start, 0)]), set()
    while queue:
        state, depth = queue.popleft()
        key = tuple(str(state.get_value(fact)) for fact in facts)
        if key in seen:
            continue
        seen.add(key)
        if simulator.is_goal(state):
            return depth
        for action, parameters in simulator.get_applicable_actions(state):
            queue.append((simulator.apply(state, action, parameters), depth + 1))
    return None


@needs_engine
@pytest.mark.parametrize("domain", [UNTYPED, TYPED], ids=["untyped", "typed"])
def test_a_blocks_world_is_planned_without_topple(domain):
    asked = problem(domain=domain)
    reading = reading_of(asked)
    assert isinstance(reading, Classical)
    assert (len(reading.instance.stacks), reading.options) == (3, PlanOptions(topple=False))
    result = answers(asked)[-1]
    assert (result.status, len(result.plan.actions)) == (Status.SOLVED_OPTIMALLY, 6)
    assert SequentialPlanValidator().validate(asked, result.plan)


@needs_engine
def test_it_is_known_by_what_its_actions_do():
    text = "(define (problem p) (:domain d) (:objects a b) (:init (f2 a) (f1 a b) (f4 b) (f3)) (:goal (f1 b a)))"
    asked = PDDLReader().parse_problem_string(OBFUSCATED, text)
    told = reading_of(asked).reading.said()
    assert told == "on = f1 (reversed), ontable = f2, clear = f4, holding = f5, handempty = f3"
    result = answers(asked)[-1]
    assert (result.status, len(result.plan.actions)) == (Status.SOLVED_OPTIMALLY, 4)
    assert plan_of_up_plan(result.plan, asked).cost == 4


@needs_engine
@pytest.mark.parametrize(
    ("goal", "status", "steps"),
    [
        ("(clear a)", Status.SOLVED_OPTIMALLY, 3),
        ("(clear a) (handempty)", Status.SOLVED_OPTIMALLY, 4),
        ("(ontable b)", Status.SOLVED_OPTIMALLY, 4),
        ("(on c b)", Status.SOLVED_OPTIMALLY, 0),
    ],
)
def test_a_plan_may_end_with_a_full_hand_where_the_goal_does_not_mind(goal, status, steps):
    asked = problem(goal=goal)
    result = answers(asked)[-1]
    assert shortest(asked) == steps
    assert (result.status, len(result.plan.actions)) == (status, steps)


@needs_engine
def test_a_block_in_the_hand_at_the_start():
    asked = problem("a b", "(ontable a) (clear a) (holding b)", "(on b a)")
    result = answers(asked)[-1]
    assert (result.status, [str(action) for action in result.plan.actions]) == (
        Status.SOLVED_OPTIMALLY,
        ["stack(b, a)"],
    )


@needs_engine
@pytest.mark.parametrize("seed", [*range(4), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(4, 40))])
def test_what_is_called_optimal_is_the_shortest(seed):
    draw = random.Random(seed)
    blocks = "abcd"[: draw.randint(2, 4)]
    piles = [[] for _ in blocks]
    for block in draw.sample(blocks, len(blocks)):
        draw.choice(piles).append(block)
    held = piles[-1].pop() if piles[-1] and draw.random() < 0.3 else None
    start = [f"(holding {held})" if held else "(handempty)"]
    for pile in filter(None, piles):
        start += [f"(ontable {pile[0]})", f"(clear {pile[-1]})"]
        start += [f"(on {upper} {under})" for under, upper in itertools.pairwise(pile)]
    order = draw.sample(blocks, len(blocks))
    goal = [f"(on {upper} {under})" for under, upper in itertools.pairwise(order) if draw.random() < 0.4]
    goal += [f"({word} {draw.choice(blocks)})" for word in ("clear", "ontable") if draw.random() < 0.6]
    asked = problem(" ".join(blocks), " ".join(start), " ".join(goal))
    result, best = answers(asked)[-1], shortest(asked)
    if best is None:
        assert result.status in (Status.UNSOLVABLE_PROVEN, Status.UNSUPPORTED_PROBLEM)
        return
    assert SequentialPlanValidator().validate(asked, result.plan)
    assert result.status in (Status.SOLVED_OPTIMALLY, Status.SOLVED_SATISFICING)
    if result.status == Status.SOLVED_OPTIMALLY:
        assert len(result.plan.actions) == best
    assert int(result.metrics.get("lower_bound", 0)) <= best


def dressed(dress, towers, goal, more=""):
    """Return a problem in a dress; that library wants all predicates declared, and knows no derived ones."""
    domain, text = dress.domain().lower(), dress.problem(towers, goal).lower()
    text = re.sub(r"\(= \(size.*?\).*?\)", "", text)  # its validator wants a number for every block
    actions = domain_from(parse_expression(domain, "d"), "d").actions
    atoms = [atom for action in actions for atom in action.atoms]
    atoms += problem_from(parse_expression(text, "p"), "p").facts
    listed = " ".join(f"({name} {' '.join(f'?a{at}' for at in range(len(rest)))})" for name, *rest in atoms)
    functions = "(:functions (total-cost))" if "total-cost" in domain else ""
    start = domain.index("(:action")
    listed = " ".join(dict.fromkeys(f"({part}" for part in listed[1:].split(" (")))
    domain = f"{domain[:start]}(:predicates {listed}) {functions} {more} {domain[start:]}"
    return PDDLReader().parse_problem_string(domain, text)


TRAITS = ("constants", "static", "static-negative", "costs", "upper-case")
WORN = [Dress(kind, "random") for kind in KINDS if kind != "derived"]
WORN += [Dress("four", "mystery", typed=True), Dress("three", "crates", typed=True)]
WORN += [Dress(kind, "usual", extras=frozenset({trait})) for kind in ("four", "three") for trait in TRAITS]
WORN += [Dress("four", "underscores", typed=True, extras=frozenset({"hand-object", "full"}))]


@pytest.mark.parametrize("dress", WORN, ids=str)
def test_every_kind_that_the_reader_knows_is_taken(dress):
    asked = dressed(dress, (("a", "b"), ("c",), ("d",)), dress.goal(on=[("a", "c"), ("d", "a")]))
    assert SmashEngine.supports(asked.kind)
    reading = reading_of(asked)
    assert (set(reading.instance.blocks), len(reading.instance.stacks)) == (set("abcd"), 4)
    own = smash.plan(reading.instance, planner="precedence", topple=False, budget=20)
    plan = up_plan(reading.steps(own.actions), asked)
    assert SequentialPlanValidator().validate(asked, plan)
    assert plan_of_up_plan(plan, asked).cost == own.cost
    assert len(plan.actions) == (own.cost if dress.hand else own.cost // 2)


@needs_engine
@pytest.mark.parametrize("seed", [*range(2), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 20))])
@pytest.mark.parametrize("kind", ["three", "three-table", "one-move", "hand-table", "quantified"])
def test_what_is_called_optimal_is_the_shortest_of_every_kind(kind, seed):
    draw = random.Random(seed)
    dress, piles = Dress(kind, "random"), [[] for _ in "abc"]
    for block in "abc":
        draw.choice(piles).append(block)
    order = draw.sample("abc", 3)
    goal = dress.goal(
        on=list(itertools.pairwise(order))[: draw.randint(1, 2)], clear=order[:1] if kind != "quantified" else []
    )
    asked = dressed(dress, tuple(map(tuple, filter(None, piles))), goal)
    result, best = answers(asked)[-1], shortest(asked)
    assert (result.status, len(result.plan.actions)) == (Status.SOLVED_OPTIMALLY, best) or (
        result.status == Status.SOLVED_SATISFICING and dress.hand
    )
    assert int(result.metrics["lower_bound"]) <= best <= len(result.plan.actions)


def test_what_a_domain_says_of_its_table_is_no_contradiction():
    dress = Dress("three-table")
    asked = dressed(dress, (("a", "b"), ("c",)), "(and (clear slab))")
    assert shortest(asked) == 1
    assert answers(asked, "precedence")[-1].status == Status.UNSUPPORTED_PROBLEM


def test_where_an_action_is_worth_two_nothing_is_called_optimal():
    jump = """(:action jump :parameters (?x ?y) :precondition (and (clear ?x) (ontable ?x) (clear ?y) (handempty))
     :effect (and (on ?x ?y) (not (ontable ?x)) (not (clear ?y))))"""
    dress = Dress("four")
    asked = dressed(dress, (("a", "b"), ("c",)), dress.goal(on=[("c", "b")]), jump)
    assert shortest(asked) == 1
    result = answers(asked, "precedence")[-1]
    assert (result.status, len(result.plan.actions)) == (Status.SOLVED_SATISFICING, 2)
    assert int(result.metrics["lower_bound"]) <= 1
    assert plan_of_up_plan(up_plan([("jump", "c", "b")], asked), asked).cost == 2


@pytest.mark.parametrize("objects", [("A", "Block 2", "b)"), ("a", "A", "when")])
def test_plans_are_in_the_names_of_the_problem_whatever_they_are(objects):
    asked = problem("x y z", "(ontable x) (on y x) (on z y) (clear z) (handempty)", "(on x z)")
    named = Problem("Übung 1", asked.environment)
    named.add_fluents(asked.fluents)
    named.add_actions(asked.actions)
    things = [named.add_object(name, asked.actions[0].parameters[0].type) for name in objects]
    low, middle, high = things
    for fluent, args in (("ontable", (low,)), ("on", (middle, low)), ("on", (high, middle)), ("clear", (high,))):
        named.set_initial_value(asked.fluent(fluent)(*args), True)
    for fluent in asked.fluents:
        for args in itertools.product(things, repeat=fluent.arity):
            if fluent(*args) not in named.explicit_initial_values:
                named.set_initial_value(fluent(*args), fluent.name == "handempty")
    named.add_goal(asked.fluent("on")(low, high))
    reading = reading_of(named)
    assert (reading.instance.name, reading.instance.blocks) == ("Übung 1", objects)
    result = answers(named, "precedence")[-1]
    assert (result.status, len(result.plan.actions)) == (Status.SOLVED_OPTIMALLY, 6)
    assert {action.block for action in plan_of_up_plan(result.plan, named).actions} == set(objects)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"start": "(ontable a) (on b a) (on c b) (handempty)"}, "'c', but (clear c) is not said"),
        ({"start": "(ontable a) (on b a) (on c b) (clear c) (clear a) (handempty)"}, "'a' is clear, but 'b' is on it"),
        ({"start": "(ontable a) (on b a) (on c b) (clear c)"}, "(handempty) is not said"),
        ({"start": "(ontable a) (on b a) (on c a) (clear c) (clear b) (handempty)"}, "'b' and 'c' are both on 'a'"),
        ({"goal": "(on a a)"}, "on itself"),
        ({"goal": "(holding a)"}, "a block in the hand at the end"),
        ({"goal": "(not (on a b))"}, "a negative goal"),
        ({"goal": "(or (on a b) (on b a))"}, "a disjunction"),
        ({"domain": UNTYPED.replace("(and (clear ?x) (ontable ?x)", "(and (red ?x) (ontable ?x)")}, "blocks world"),
        ({"domain": UNTYPED.replace("(handempty) (ontable ?x))", "(handempty))")}, "blocks world"),
    ],
)
def test_what_is_no_blocks_world_is_refused_in_words(given, words):
    asked = problem(**given)
    with pytest.raises((Unsupported, MalformedFile)) as caught:
        reading_of(asked)
    assert words in str(caught.value)
    if not SmashEngine.supports(asked.kind):
        return
    [result] = answers(asked)
    assert result.status == Status.UNSUPPORTED_PROBLEM
    assert words in result.log_messages[0].message


@pytest.mark.parametrize("goal", ["(on a b) (on c b)", "(on a b) (on a c)", "(on a b) (on b a)", "(red a)"])
def test_contradictions_are_unsolvable(goal):
    asked = problem(goal=goal)
    assert shortest(asked) is None
    assert answers(asked, "precedence")[-1].status == Status.UNSOLVABLE_PROVEN


@pytest.mark.parametrize(
    "goal", ["(base x left) (base z left)", "(on x z) (on y z)", "(on x y) (on y x)", "(on x y) (bottom x)"]
)
def test_contradictory_goals_of_our_domains_are_never_solved(goal):
    text = f"""(define (problem p) (:domain smash-topple-chain)
      (:objects x y z - block left right - location k0 k1 - count)
      (:init (hand-empty) (idle) (base x left) (on y x) (on z y) (top z stacks) (bottom x) (empty right)
             (free-buffers k1) (next k0 k1) (= (total-cost) 0))
      (:goal (and {goal})) (:metric minimize (total-cost)))"""
    domain = compile_instance(figure_1(), PlanOptions(), "chain").domain_text
    result = answers(PDDLReader().parse_problem_string(domain, text), "smash")[-1]
    assert result.status in (Status.UNSOLVABLE_PROVEN, Status.UNSUPPORTED_PROBLEM)
    assert result.plan is None


def own(options=None, wanted="conditional", metric=True):
    task = compile_instance(figure_1(), options or PlanOptions(), wanted)
    text = task.problem_text if metric else task.problem_text.replace("(:metric minimize (total-cost))", "")
    return PDDLReader().parse_problem_string(task.domain_text, text)


@pytest.mark.parametrize(
    ("wanted", "options", "status"),
    [
        ("conditional", PlanOptions(), Status.SOLVED_OPTIMALLY),
        ("chain", PlanOptions(topple=False), Status.SOLVED_OPTIMALLY),
        ("chain", PlanOptions(), Status.SOLVED_SATISFICING),
    ],
)
def test_without_a_metric_every_step_counts_one(wanted, options, status):
    """A topple that is told in several steps is then no longer one action: nothing is proven of it."""
    asked = own(options, wanted, metric=False)
    [*_, result] = answers(asked, "precedence")
    assert result.status == status
    assert SequentialPlanValidator().validate(asked, result.plan)
    asked.add_quality_metric(MinimizeSequentialPlanLength())
    assert answers(asked, "precedence")[-1].status == status


def test_constraints_on_the_way_and_other_metrics_are_refused():
    asked = own()
    asked.add_trajectory_constraint(Always(asked.fluent("hand-empty")()))
    with pytest.raises(Unsupported, match="constraints on the way"):
        reading_of(asked)
    assert not SmashEngine.supports(asked.kind)
    other = own(metric=False)
    other.add_quality_metric(MinimizeMakespan())
    with pytest.raises(Unsupported, match="metric"):
        reading_of(other)


@pytest.mark.parametrize("fact", ["top", "empty", "bottom"])
def test_a_fact_that_is_missing_or_too_much_is_refused(fact):
    asked = own(wanted="chain")
    present = next(
        f for f, value in asked.explicit_initial_values.items() if f.fluent().name == fact and value.is_true()
    )
    asked.set_initial_value(present, False)
    with pytest.raises(MalformedFile, match=f"does not say \\({fact}"):
        reading_of(asked)
    asked = own(wanted="chain")
    absent = next(f for f, value in asked.initial_values.items() if f.fluent().name == fact and not value.is_true())
    asked.set_initial_value(absent, True)
    with pytest.raises(MalformedFile, match=f"says \\({fact}"):
        reading_of(asked)


@pytest.mark.parametrize("timeout", [-1, 0, float("nan"), float("inf")])
def test_a_timeout_that_is_no_span_of_time_is_an_error(timeout):
    with pytest.raises(UPUsageError, match="timeout"):
        SmashEngine().solve(own(), timeout=timeout)


@pytest.mark.usefixtures("third_party")
def test_closing_the_generator_stops_the_solver():
    import psutil

    before = set(psutil.Process().children(recursive=True))
    tower = make_instance({"s1": ["b1", "b2"]}, PositionsGoal({"b1": ("s2", 1)}), stacks=2)
    task = compile_instance(tower, PlanOptions(), "conditional")
    text = task.problem_text.replace("b0", "b").replace("s0", "s")
    asked = PDDLReader().parse_problem_string(task.domain_text, text)
    solutions = SmashEngine("hangs-with-plan").get_solutions(asked, timeout=1000)
    assert next(solutions).status == Status.INTERMEDIATE
    solutions.close()
    assert set(psutil.Process().children(recursive=True)) <= before


def test_every_plan_is_judged_by_the_librarys_validator(monkeypatch):
    class Refuses(SequentialPlanValidator):
        def validate(self, problem, plan):
            result = super().validate(problem, plan)
            return unified_planning.engines.results.ValidationResult(
                unified_planning.engines.results.ValidationResultStatus.INVALID, result.engine_name
            )

    monkeypatch.setattr("smash_baselines.up_engine.SequentialPlanValidator", Refuses)
    result = answers(own(), "precedence")[-1]
    assert (result.status, result.plan) == (Status.INTERNAL_ERROR, None)
    assert "validator" in result.log_messages[0].message


class TestAsOurs:
    def test_a_plan_comes_back_in_the_names_of_the_instance(self):
        instance = make_instance({"left side": ["größe", ")"]}, OnGoal({"größe": ")"}), stacks=3)
        task = compile_instance(instance, PlanOptions(), "chain")
        asked = problem_of_task(task)
        result = answers(asked, "precedence")[-1]
        plan = plan_of_up_plan(result.plan, asked, task)
        assert Law(instance).check(plan.actions).accepted
        assert (plan.instance, plan.status, plan.cost) == (instance.name, "feasible", optimal_cost(instance))

    def test_a_plan_of_a_classical_problem_becomes_ours(self):
        asked = problem(goal="(on a c) (clear b)")
        steps = [("unstack", "c", "b"), ("put-down", "c"), ("unstack", "b", "a"), ("put-down", "b")]
        steps += [("pick-up", "a"), ("stack", "a", "c")]
        plan = plan_of_up_plan(up_plan(steps, asked), asked)
        assert (plan.cost, plan.options.topple) == (6, False)
        with pytest.raises(IllegalAction, match="goal not reached"):
            plan_of_up_plan(up_plan(steps[:4], asked), asked)

    def test_a_partial_order_becomes_a_sequence(self):
        asked = problem("a b", "(ontable a) (ontable b) (clear a) (clear b) (handempty)", "(on a b)")
        first, second = up_plan([("pick-up", "a"), ("stack", "a", "b")], asked).actions
        assert plan_of_up_plan(PartialOrderPlan({first: [second]}), asked).cost == 2
        assert isinstance(first, ActionInstance)

    @needs_engine
    @pytest.mark.parametrize(
        ("encoding", "options"), [("chain", SolveOptions()), ("pick-and-place", SolveOptions(topple=False))]
    )
    def test_an_engine_becomes_a_planner(self, encoding, options):
        planner = planner_of_up_engine("fast-downward", encoding)
        assert planner.missing() is None
        answer = planner.solve(figure_1(), options, 60.0)
        assert (answer.status, answer.lower_bound) == ("feasible", None)
        assert answer.cost >= optimal_cost(figure_1(), PlanOptions(options.topple))
        assert functools.partial(planner_of_up_engine, "aries")().name == "up:aries"


@pytest.fixture(autouse=True, scope="module")
def quiet():
    get_environment().credits_stream = None
