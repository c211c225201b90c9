"""`ontable` and `clear` goals and a start with a full hand in PDDL: the same answers as exhaustive search."""

import random

import pytest
from smash_baselines.encodings import ENCODINGS, TOPPLE_ENCODINGS, encoding_for, unsupported_reason
from smash_baselines.engines.configurations import FAST_DOWNWARD, Configuration
from smash_baselines.engines.downward import DownwardPlanner
from smash_baselines.facts import named_blocks, trim_buffers
from smash_baselines.goal_words import JUDGED, told
from smash_baselines.planners import FdLama, FdLamaChain, FdOpt, FdOptIpdb, SymkOpt
from smash_baselines.read_problem import read_problem_text
from smash_baselines.steps import actions_of, steps_of
from smash_baselines.task import compile_instance

from smash.planners.protocol import Settings, SolveOptions, why_refused
from smash.planners.registry import get_planner
from smash.problem import TABLE, Carrier, Costs, MalformedFile, OnGoal, Place, PlanOptions, Topple, make_instance
from smash.problem.files.instances import instance_document
from smash.problem.problem import Problem
from tests.baselines.test_encodings import cost, random_walk
from tests.baselines.test_family import stated_cost
from tests.cheapest import cheapest_plan
from tests.oracle import optimal_cost
from tests.relations import related

installed = pytest.mark.skipif(FdOpt().missing() is not None, reason="Fast Downward is not installed")


class Blind(DownwardPlanner):
    """Uniform-cost search on the conditional encoding, which no admissible heuristic of the baselines takes."""

    name = "blind"
    encoding = "conditional"
    configuration = Configuration(
        FAST_DOWNWARD, ("--search", "astar(blind())"), admissible=True, conditional_effects=True
    )


def tower(*blocks, goal, **more):
    return make_instance({"s1": blocks}, goal, **({"stacks": 3} | more))


def family(seed):
    """Draw a problem of `related` with carriers, lifts and costs beside it."""
    problem, draw = related(seed, most_blocks=3), random.Random(seed)
    instance = problem.instance
    start = {at: list(pile) for at, pile in instance.start.items()}
    full = [at for at, pile in start.items() if pile]
    holds = [start[draw.choice(full)].pop()] if full and draw.random() < 0.4 else []
    carriers = [Carrier("tray", ("left", "right"), "left", 2, tuple(holds))] if draw.random() < 0.6 else []
    places = [*instance.locations, TABLE, "left", "right"]
    positions = {place: (float(draw.randint(0, 2)), 0.0) for place in places[: len(places) if carriers else -2]}
    costs = Costs({"pick": 2, "topple": 3}, *((3.0, positions) if draw.random() < 0.6 else ()))
    if not carriers and not holds and draw.random() < 0.2:
        costs = Costs()
    made = make_instance(
        start if carriers or not holds else instance.start,
        instance.goal,
        name=instance.name,
        blocks=instance.blocks,
        stacks=instance.stacks,
        buffers=instance.buffers,
        table=instance.table,
        hand=instance.hand,
        carriers=carriers,
        capacities={"lift": 2} if draw.random() < 0.4 else {},
        costs=costs,
    )
    return Problem(made, problem.options)


def test_words_are_told_only_where_the_goal_leaves_something_open():
    loaded = tower("p", "q", "r", goal=OnGoal({"q": "p"}, ontable=("p",)))
    assert encoding_for(Problem(loaded), "chain") is ENCODINGS["chain"]
    assert ("bottom", "b01") in compile_instance(loaded, PlanOptions(), "chain").facts.goal
    lying = tower("p", "q", "r", goal=OnGoal({}, ontable=("q",)))
    assert encoding_for(Problem(lying), "chain").name == "topple-chain-words"
    assert encoding_for(Problem(lying, PlanOptions(topple=False)), "chain") is ENCODINGS["pick-and-place"]
    covered = tower("p", "q", "r", goal=OnGoal({}, clear=("q",)))
    assert encoding_for(Problem(covered, PlanOptions(topple=False)), "conditional").domain == (
        "smash-pick-and-place-words"
    )


def test_a_plan_ends_by_judging_the_words():
    instance = tower("p", "q", "r", goal=OnGoal({}, ontable=("p", "q"), clear=("p", "q")))
    chain = compile_instance(instance, PlanOptions(), "chain")
    assert steps_of([Topple("s1", 2)], chain)[3:] == [
        ("finish", "w00"),
        ("rests-at-bottom", "b01", "w00", "w01"),
        ("rests-in-region", "b02", "w01", "w02"),
        ("clear-on-top", "b01", "stacks", "w02", "w03"),
        ("clear-in-region", "b02", "w03", "w04"),
    ]
    assert steps_of([Topple("s1", 3)], chain)[-1][0] == "topple-end"


def test_nothing_moves_once_the_hand_is_finished():
    for wanted in TOPPLE_ENCODINGS:
        text = compile_instance(tower("p", "q", goal=OnGoal({}, clear=("p",))), PlanOptions(), wanted).domain_text
        actions = text.split("(:action ")[1:]
        moves = [action for action in actions if "(met " not in action]
        assert all(any(f"({word}" in action for word in ("hand-empty", "holding", "edge")) for action in moves)


def test_without_topple_what_rests_in_the_region_has_to_stay_there():
    """The cheapest plans leave it there anyway; a planner that proves nothing is told."""
    instance = tower("p", "q", goal=OnGoal({}, ontable=("t",), clear=("p",)), table=["t"])
    task = compile_instance(instance, PlanOptions(topple=False), "chain")
    assert ("rests", "w01", "b03") in task.facts.start


def test_a_held_block_is_told():
    instance = make_instance({"s1": ["q"]}, OnGoal({"p": "q"}), hand="p", stacks=2)
    for wanted in TOPPLE_ENCODINGS:
        task = compile_instance(instance, PlanOptions(), wanted)
        assert ("holding", "b02") in task.facts.start
        assert ("hand-empty",) not in task.facts.start
        assert ("hand-empty",) in task.facts.goal
        assert actions_of(steps_of([Place("p", "s1")], task), task) == [Place("p", "s1")]


def test_a_clear_or_resting_block_need_not_be_picked_from_the_region():
    instance = tower("p", "q", goal=OnGoal({"q": "p"}, ("p",), ("t",), ("u",)), table=["t", "u"])
    assert named_blocks(told(Problem(instance))) == {"p", "q"}


@pytest.mark.parametrize("wanted", TOPPLE_ENCODINGS)
def test_every_plan_can_be_said_and_every_problem_reads_back(wanted):
    for seed in range(80):
        problem = related(seed)
        instance, options = problem.instance, problem.options
        if unsupported_reason(problem, wanted):
            continue
        task = compile_instance(instance, options, wanted)
        actions = random_walk(instance, options, 12, seed)
        steps = steps_of(actions, task)
        assert cost(step for step in steps if step[0] not in JUDGED) == len(actions), seed
        assert [type(a) for a in actions_of(steps, task)] == [type(a) for a in actions], seed
        read = read_problem_text(task.problem_text)
        assert instance_document(read.instance) == instance_document(told(problem)), seed


def test_every_plan_of_the_family_can_be_said_at_its_cost():
    for seed in range(80):
        problem = family(seed)
        if problem.plain:
            continue
        task = compile_instance(problem.instance, problem.options, "chain")
        actions = random_walk(problem.instance, problem.options, 10, seed)
        steps = steps_of(actions, task)
        assert stated_cost(steps, task) == problem.law.price(actions), seed
        assert problem.law.price(actions_of(steps, task)) == problem.law.price(actions), seed


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("(holding b02)", ""), "holds one block"),
        (("(holding b02)", "(holding b02) (hand-empty)"), "holds one block"),
        (("(before w00 w01)", ""), "do not follow"),
        (("(opens w00)", ""), "do not follow"),
        (("(met w01)", ""), "w01 is none"),
        (("(bottom b01)", ""), "does not say (bottom b01)"),
        (("(top b01 stacks)", "(top b01 stacks) (top b01 buffers)"), "says (top b01 buffers)"),
        (("(empty s02)", ""), "does not say (empty s02)"),
    ],
)
def test_a_problem_that_is_not_whole_is_refused_by_the_fact(change, words):
    instance = make_instance({"s1": ["q"]}, OnGoal({}, ontable=("q",)), hand="p", stacks=2)
    text = compile_instance(instance, PlanOptions(), "chain").problem_text
    assert change[0] in text
    with pytest.raises(MalformedFile) as caught:
        read_problem_text(text.replace(*change))
    assert words in str(caught.value)


@pytest.mark.parametrize("name", ["fd-opt", "fd-lama", "symk-opt", "enhsp", "aries"])
def test_contradictions_are_answered_without_an_engine(name, monkeypatch):
    planner = get_planner(name)
    monkeypatch.setattr(type(planner), "run", None)
    instance = make_instance({"s1": ["a", "b", "c"]}, OnGoal({"a": "c", "b": "c"}), stacks=3)
    answer = planner.solve(instance, SolveOptions(), 20.0)
    assert (answer.status, answer.actions) == ("infeasible", None)


@pytest.mark.parametrize("name", ["fd-lama", "fd-lama:chain", "fd-opt", "fd-opt-ipdb", "symk-opt", "enhsp", "aries"])
def test_engines_take_open_goals_and_full_hands(name):
    for seed in range(40):
        problem = related(seed)
        reason = why_refused(get_planner(name), problem, Settings())
        assert reason is None or "max_topple" in reason


def assert_proven(planner, problem):
    if why_refused(planner, problem, Settings()) is not None:
        return
    best = optimal_cost(problem.instance, problem.options)
    answer = planner.plan(problem, Settings(), 60.0)
    assert not answer.details.get("refused")
    assert (answer.status, answer.cost) == (("infeasible", None) if best is None else ("optimal", best)), problem


@installed
@pytest.mark.parametrize("seed", [2, 5, 7, 11, 16, 21])
def test_ipdb_proves_what_exhaustive_search_finds(seed):
    assert_proven(FdOptIpdb(), related(seed, contradictory=0))


@installed
@pytest.mark.parametrize("seed", [3, 8])
def test_the_conditional_encoding_has_the_same_optima(seed):
    assert_proven(Blind(), related(seed, contradictory=0))


@installed
@pytest.mark.slow
@pytest.mark.parametrize("planner", [FdOpt, FdOptIpdb, SymkOpt, Blind])
@pytest.mark.parametrize("part", range(12))
def test_every_prover_finds_what_exhaustive_search_finds(planner, part):
    for seed in range(1000 + 20 * part, 1020 + 20 * part):
        assert_proven(planner(), related(seed, contradictory=0.05))


def assert_cheapest(planner, problem):
    best = cheapest_plan(problem.instance, problem.options, 30_000)
    answer = planner.plan(problem, Settings(), 60.0)
    assert not answer.details.get("refused")
    expected = ("infeasible", None) if best is None else ("optimal", best[0])
    assert (answer.status, answer.cost) == expected, problem


@installed
@pytest.mark.parametrize("seed", [1, 4, 9])
def test_the_family_is_proven_at_the_cheapest_cost(seed):
    assert_cheapest(FdOpt(), family(seed))


@installed
@pytest.mark.slow
@pytest.mark.parametrize("planner", [FdOpt, FdOptIpdb, SymkOpt])
@pytest.mark.parametrize("part", range(8))
def test_every_prover_finds_the_cheapest_cost_in_the_family(planner, part):
    for seed in range(2000 + 15 * part, 2015 + 15 * part):
        problem = family(seed)
        try:
            assert_cheapest(planner(), problem)
        except MemoryError:
            continue


@installed
@pytest.mark.slow
@pytest.mark.parametrize("planner", [FdLama, FdLamaChain])
def test_plans_of_lama_are_legal_and_never_beat_the_optimum(planner):
    for seed in range(3000, 3015):
        problem = related(seed, contradictory=0)
        if why_refused(planner(), problem, Settings()) is not None:
            continue
        answer = planner().plan(problem, Settings(), 3.0)
        best = optimal_cost(problem.instance, problem.options)
        assert not answer.details.get("refused"), seed
        assert answer.cost is None or answer.cost >= best, seed


def test_buffers_are_trimmed_as_ever():
    instance = tower("p", "q", goal=OnGoal({}, ontable=("p",)), buffers=9, hand="r")
    assert len(trim_buffers(instance).buffers) == 3
