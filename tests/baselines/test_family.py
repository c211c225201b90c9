"""Carriers, lifts and costs in PDDL: the same plans, the same costs and the same answers as the law."""

import json

import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from smash_baselines.encodings import DOMAINS, family_encoding
from smash_baselines.engine import beyond_integers
from smash_baselines.facts import named_blocks, trim_buffers
from smash_baselines.parts.registry import PARTS
from smash_baselines.planners import Aries, Enhsp, FdLama, FdLamaConditional, FdOpt, FdOptIpdb, SymkOpt
from smash_baselines.steps import actions_of, steps_of
from smash_baselines.task import compile_instance

from smash.cli.export_pddl import command
from smash.planners.protocol import Settings, SolveOptions, plan_options, why_refused
from smash.problem import (
    TABLE,
    Carrier,
    Carry,
    Costs,
    Law,
    Lift,
    OnGoal,
    PlanOptions,
    PositionsGoal,
    Topple,
    make_instance,
    write_instance,
)
from smash.problem.blocksworld.sexpr import parse_expression
from smash.problem.files.instances import instance_from_document
from smash.problem.problem import Problem
from tests.baselines.test_encodings import random_walk
from tests.cheapest import cheapest_plan
from tests.family_strategies import family_instances, family_options
from tests.problem.test_family import SCOOPED, scoop

FEW = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
installed = pytest.mark.skipif(FdOpt().missing() is not None, reason="Fast Downward is not installed")


def stated_cost(steps, task) -> int:
    """Sum up the costs of a PDDL plan as a PDDL planner does: from the domain's text and the problem's values."""
    _, _, *forms = parse_expression(task.domain_text, "domain")
    values, total = dict(task.facts.costs), 0
    for name, *arguments in steps:
        parts = next(form for form in forms if form[:2] == [":action", name])
        variables = [word for word in parts[parts.index(":parameters") + 1] if word.startswith("?")]
        *_, (_, _, cost) = parts[parts.index(":effect") + 1]
        bound = dict(zip(variables, arguments, strict=True))
        total += int(cost) if isinstance(cost, str) else values[tuple(bound.get(word, word) for word in cost)]
    return total


@FEW
@given(family_instances(max_blocks=5, odd_names=True), family_options(), st.integers(0, 99))
def test_every_legal_plan_can_be_said_and_read_back_at_the_same_cost(instance, options, seed):
    if Problem(instance, options).plain:
        return
    task = compile_instance(instance, options, "chain")
    actions = random_walk(instance, options, 15, seed)
    steps = steps_of(actions, task)
    price = Law(instance, options).price(actions)
    assert stated_cost(steps, task) == price
    read = actions_of(steps, task)
    assert [type(action) for action in read] == [type(action) for action in actions]
    assert Law(instance, options).price(read) == price


@pytest.mark.parametrize("file", ["scoop", "lift"])
def test_the_domains_to_be_read_are_those_of_the_compiler(file):
    instance = scoop(capacities={}) if file == "scoop" else scoop(carriers=[], costs=Costs())
    text = (DOMAINS / f"{file}.pddl").read_text()
    assert parse_expression(text, file) == parse_expression(family_encoding(instance, PlanOptions()).text, "compiler")


def test_unified_planning_reads_the_domains_and_accepts_a_plan():
    pytest.importorskip("unified_planning")
    from smash_baselines.up_problem import up_accepts

    assert up_accepts(SCOOPED, compile_instance(scoop(capacities={}), PlanOptions(), "chain"))
    goal = PositionsGoal({"a": ("g1", 1), "b": ("g1", 2)})
    lifted = scoop(carriers=[], goal=goal, costs=Costs({"lift": 3}))
    assert up_accepts([Lift("s1", 1, "g1")], compile_instance(lifted, PlanOptions(), "chain"))
    assert not up_accepts([Lift("s1", 2, "g1")], compile_instance(lifted, PlanOptions(), "chain"))


@pytest.mark.slow
@settings(max_examples=10, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(family_instances(max_blocks=3), family_options(), st.integers(0, 99))
def test_unified_planning_simulates_what_the_law_does(instance, options, seed):
    pytest.importorskip("unified_planning")
    from smash_baselines.up_problem import problem_of_task, up_plan
    from unified_planning.engines import UPSequentialSimulator

    if Problem(instance, options).plain:
        return
    task = compile_instance(instance, options, "chain")
    problem = problem_of_task(task)
    simulator = UPSequentialSimulator(problem)
    state = simulator.get_initial_state()
    actions = random_walk(instance, options, 8, seed)
    for step in steps_of(actions, task):
        [grounded] = up_plan([step], problem).actions
        state = simulator.apply(state, grounded)
        assert state is not None, step
    *_, last = Law(instance, options).states(actions)
    assert simulator.is_goal(state) == (Law(instance, options).goal_shortfall(last) is None)


def test_a_lift_is_a_chain_whose_landing_pays():
    task = compile_instance(scoop(carriers=[], costs=Costs()), PlanOptions(), "chain")
    assert steps_of([Lift("s1", 1, "s2")], task) == [
        ("lift-begin", "b02", "r01", "n01"),
        ("lift-down", "b02", "b01", "r01", "n01", "n00"),
        ("lift-off-base", "b01", "s01", "r01", "p01", "n00"),
        ("lift-onto", "b01", "b04", "r01", "p01", "p01"),
        ("lift-end", "b02", "r01"),
    ]


def test_a_lift_back_to_where_it_was_is_no_action():
    task = compile_instance(scoop(carriers=[], costs=Costs()), PlanOptions(), "chain")
    there_and_back = [
        ("lift-begin", "b02", "r01", "n01"),
        ("lift-off", "b02", "b01", "r01", "p01", "n01"),
        ("lift-onto", "b02", "b01", "r01", "p01", "p01"),
        ("lift-end", "b02", "r01"),
    ]
    assert actions_of(there_and_back, task) == []


def test_what_counts_one_and_gathers_by_topple_alone_keeps_its_domain():
    plain = scoop(carriers=[], capacities={}, costs=Costs())
    assert compile_instance(plain, PlanOptions(), "chain").encoding.name == "topple-chain"
    without = PlanOptions(without=("carry", "lift"))
    assert compile_instance(scoop(costs=Costs()), without, "conditional").encoding.name == "topple-conditional"
    assert compile_instance(scoop(), without, "chain").encoding.name == "costs-topple"


def test_buffers_are_counted_where_no_way_tells_them_apart():
    many = {"buffers": [f"u{number}" for number in range(9)], "carriers": []}
    places = {f"u{number}": (0.5, float(number % 2)) for number in range(9)}
    costs = Costs(travel=1.0, positions={**dict.fromkeys(("s1", "s2", "g1", "g2", TABLE), (0.0, 0.0)), **places})
    assert len(trim_buffers(scoop(**many, costs=Costs({"pick": 2}))).buffers) == 4
    trimmed = trim_buffers(scoop(**many, costs=costs))
    assert len(trimmed.buffers) == 8
    task = compile_instance(trimmed, PlanOptions(), "chain")
    assert len(task.facts.objects["region"]) == 3
    assert [fact for fact in task.facts.start if fact[0] == "free"] == [("free", "r02", "n04"), ("free", "r03", "n04")]


def test_engines_leave_what_the_goal_does_not_name_on_the_table_and_exports_do_not():
    wanted = {("wanted", "b01"), ("wanted", "b03")}
    every = compile_instance(scoop(), PlanOptions(), "chain").facts.start
    named = compile_instance(scoop(), PlanOptions(), "chain", named_blocks(scoop())).facts.start
    assert {fact for fact in named if fact[0] == "wanted"} == wanted
    assert len([fact for fact in every if fact[0] == "wanted"]) == 4
    assert named_blocks(scoop(goal=OnGoal({"a": "b"}, ("d",)))) == {"a", "b", "d"}


def test_planners_say_what_they_take():
    assert why_refused(FdLama(), Problem(scoop(), PlanOptions()), Settings()) is None
    assert "chain" in why_refused(FdLamaConditional(), Problem(scoop(), PlanOptions()), Settings())
    assert why_refused(FdOpt().with_encoding("chain"), Problem(scoop(), PlanOptions()), Settings()) is None
    assert "carry" in why_refused(Aries(), Problem(scoop(), PlanOptions()), Settings())
    assert "costs are in ms" in why_refused(
        Aries(), Problem(scoop(capacities={}), PlanOptions(without=("carry",))), Settings()
    )
    assert {part.kind for part in PARTS} >= {"topple", "carry", "lift"}


def assert_proven(planner, instance, options, budget=60.0):
    solve_options = SolveOptions(options.topple, options.max_topple, without=options.without)
    assert why_refused(planner, Problem(instance, plan_options(solve_options)), Settings()) is None
    try:
        best = cheapest_plan(instance, options, 30_000)
    except MemoryError:
        return
    result = planner.solve(instance, solve_options, budget)
    assert not result.details.get("refused")
    assert (result.status, result.cost) == (("infeasible", None) if best is None else ("optimal", best[0]))
    assert best is None or result.lower_bound == best[0]


@installed
@pytest.mark.parametrize(
    "options",
    [
        PlanOptions(),
        pytest.param(PlanOptions(False), marks=pytest.mark.slow),
        pytest.param(PlanOptions(True, 1, without=("lift",)), marks=pytest.mark.slow),
    ],
)
def test_the_scoop_is_proven_at_the_cheapest_cost(options):
    assert_proven(FdOptIpdb(), scoop(), options)


@installed
def test_blocks_are_picked_from_a_carrier_that_may_not_be_carried():
    held = scoop(start={"s2": ["c", "d"]}, carriers=[Carrier("tray", ("left", "right"), "left", 3, ("a", "b"))])
    assert_proven(FdOpt(), held, PlanOptions(True, None, without=("carry", "lift")))


@installed
@settings(max_examples=5, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(family_instances(max_blocks=2, min_blocks=1), family_options())
def test_landmark_cut_proves_the_cheapest_cost(instance, options):
    assert_proven(FdOpt(), instance, options)


@installed
@pytest.mark.slow
@pytest.mark.parametrize("planner", [FdOpt, FdOptIpdb, SymkOpt])
@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(family_instances(max_blocks=4, min_blocks=1, odd_names=True), family_options())
def test_every_prover_finds_the_cheapest_cost(planner, instance, options):
    assert_proven(planner(), instance, options)


@installed
@pytest.mark.slow
@pytest.mark.parametrize("planner", [FdLama, Enhsp])
def test_who_does_not_prove_finds_legal_plans(planner):
    if planner().missing():
        pytest.skip(str(planner().missing()))
    result = planner().solve(scoop(), SolveOptions(), 20.0)
    assert not result.details.get("refused")
    assert result.cost >= cheapest_plan(scoop())[0]
    assert result.lower_bound is None


FOUR = ["a1", "a2", "a3", "a4"], ["b1", "b2", "b3", "b4"]


def demonstration():
    """The paper's scoop: two stacks of four, whose bottom blocks have to go far to the right; a tray for two."""
    left, right = FOUR
    return make_instance(
        name="demonstration",
        blocks=[*left, *right],
        stacks=["l1", "l2", "r1", "r2"],
        start={"l1": left, "l2": right},
        goal=PositionsGoal({"a1": ("r1", 1), "b1": ("r2", 1)}),
        carriers=[Carrier("tray", ("near", "far"), "near", 2)],
        costs=Costs(
            {"pick": 10, "place": 10, "topple": 20, "carry": 20},
            100.0,
            {"l1": (0, 0), "l2": (0, 0.1), "r1": (2, 0), "r2": (2, 0.1), TABLE: (0, -0.2), "near": (0, 0.05)}
            | {"far": (2, 0.05)},
            "ds",
        ),
    )


@installed
@pytest.mark.slow
def test_the_papers_scoop_demonstration_is_proven():
    costs = {}
    for without in ((), ("carry",)):
        result = FdOptIpdb().solve(demonstration(), SolveOptions(without=without), 120.0)
        assert result.status == "optimal"
        costs[without] = result.cost
        kinds = {type(action) for action in result.actions}
        assert Topple in kinds
        assert (Carry in kinds) == (not without)
    assert costs[()] < costs[("carry",)]


def test_export_writes_what_is_left_without_an_action(tmp_path):
    file = tmp_path / "scoop.json"
    write_instance(scoop(name="odd ; name"), file)
    out = tmp_path / "pddl"
    result = CliRunner().invoke(command, [str(file), "--without", "lift", "--out", str(out)])
    assert result.exit_code == 0, result.output
    domain, problem = (out / "domain.pddl").read_text(), (out / "problem.pddl").read_text()
    assert "lift" not in domain
    assert "(:action carry" in domain
    assert json.loads(problem.splitlines()[0].split(": ", 1)[1])["carriers"] == {"c01": "tray"}


@pytest.mark.parametrize(("metre", "fits"), [(1_000.0, True), (1_000_000.0, False)])
def test_costs_whose_sums_pass_an_engine_s_integers_are_refused_before_it_starts(metre, fits):
    places = {"s0": [-700.0, 0], "s1": [-700.0, 0], "g": [700.0, 0], "table": [0, 0]}
    document = {
        "format": "smash-instance/2",
        "name": "far",
        "blocks": ["a", "b"],
        "stacks": ["s0", "s1", "g"],
        "start": {"s0": ["a"], "s1": ["b"]},
        "goal": {"kind": "stacks", "stacks": {"g": ["a", "b"]}},
        "costs": {"travel": metre, "positions": places},
    }
    reason = beyond_integers(instance_from_document(document))
    assert (reason is None) == fits
    assert fits or "engines count to 2,147,483,647" in reason
