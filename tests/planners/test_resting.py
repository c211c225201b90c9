"""`ontable` and `clear` goals and a full hand at the start: every word of every planner held to exhaustive search."""

import tracemalloc
from time import perf_counter

import pytest

from smash.planners.greedy.passes import greedy_plans
from smash.planners.precedence.bound import precedence_bound
from smash.planners.protocol import Settings, SolveLog, ask, why_refused
from smash.planners.protocol.first_place import plan_first_places
from smash.planners.registry import get_planner
from smash.problem import Law, OnGoal, PlanOptions, make_instance
from smash.problem.problem import Problem
from tests.oracle import optimal_cost
from tests.relations import related

NO_TOPPLE = PlanOptions(topple=False)


class Heard:
    """Collects what is reported while a planner works."""

    def __init__(self):
        self.plans, self.bounds = [], []

    def __call__(self, seconds, cost, actions):
        self.plans.append((cost, tuple(actions)))

    def bound(self, seconds, bound, origin):
        self.bounds.append(bound)


def hold_to(name, problem, budget=5.0, settings=None):
    """Have a planner plan, hold all that it says to exhaustive search; return its answer, None where it refuses."""
    planner, settings, heard = get_planner(name), settings or Settings(), Heard()
    if why_refused(planner, problem, settings) is not None:
        return None
    best = optimal_cost(problem.instance, problem.options)
    plan = ask(planner, problem, settings, budget, heard, name=name)
    if best is None:
        assert plan.status == "infeasible"
        return plan
    law = Law(problem.instance, problem.options)
    assert plan.actions is not None
    assert plan.status in ("optimal", "feasible")
    assert law.check(plan.actions).cost == plan.cost
    assert plan.cost == best if plan.status == "optimal" else plan.cost >= best
    assert plan.lower_bound is None or plan.lower_bound <= best
    for cost, actions in heard.plans:
        verdict = law.check(actions)
        assert verdict.accepted
        assert verdict.cost == cost >= best
    assert all(bound <= best for bound in heard.bounds)
    return plan


@pytest.mark.parametrize(
    ("name", "count", "exact"),
    [
        ("greedy", 250, False),
        ("precedence", 120, False),
        ("astar", 120, True),
        ("smash", 120, True),
        ("smash-layered", 60, False),
        ("smash-flow", 20, False),
    ],
)
def test_every_word_is_that_of_exhaustive_search(name, count, exact):
    for seed in range(count):
        plan = hold_to(name, related(seed, hand=0.35))
        assert not exact or plan is None or plan.status in ("optimal", "infeasible"), seed


@pytest.mark.slow
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("part", range(10))
@pytest.mark.parametrize(("name", "count"), [("greedy", 100), ("precedence", 100), ("astar", 100), ("smash", 100)])
def test_every_word_is_that_of_exhaustive_search_in_thousands_of_cases(name, count, part):
    for seed in range(count * part + 10_000, count * (part + 1) + 10_000):
        hold_to(name, related(seed, most_blocks=5, stacks=4, hand=0.3))


@pytest.mark.slow
@pytest.mark.timeout(1200)
@pytest.mark.parametrize(("name", "count"), [("smash-layered", 300), ("smash-flow", 100)])
def test_every_word_of_the_models_is_that_of_exhaustive_search_in_hundreds_of_cases(name, count):
    for seed in range(10_000, 10_000 + count):
        hold_to(name, related(seed, hand=0.4), budget=10.0)


@pytest.mark.parametrize("part", range(3))
def test_a_greedy_plan_exists_wherever_any_does_and_all_of_them_are_legal(part):
    for seed in range(300 * part, 300 * part + 300):
        problem = related(seed, most_blocks=8, stacks=6, hand=0.0)
        if problem.infeasible is not None:
            continue
        plans = list(greedy_plans(problem, perf_counter()))
        assert plans, seed
        assert all(problem.law.check(plan).accepted for plan in plans), seed


def test_one_topple_is_found_where_it_leaves_all_on_the_table():
    instance = make_instance({"s1": [*"pqrs"]}, OnGoal({}, ontable=("p", "q", "r", "s")), stacks=2)
    for name in ("smash", "astar", "precedence", "greedy"):
        assert hold_to(name, Problem(instance)).cost == 1
    assert hold_to("smash", Problem(instance, PlanOptions(max_topple=2))).cost == 2


def test_what_lies_on_a_buffer_falls_from_a_stack():
    instance = make_instance(
        {"s1": ["a"], "u1": [*"bcd"]}, OnGoal({}, bottom=("a",), ontable=("b", "c", "d")), stacks=["s1"], buffers=["u1"]
    )
    assert hold_to("greedy", Problem(instance)).cost == 5
    assert hold_to("smash", Problem(instance)).status == "optimal"


def test_planners_whose_argument_breaks_say_so_before_they_start():
    instance = make_instance({"s1": [*"pq"]}, OnGoal({}, ontable=("p", "q")), stacks=2)
    for name in ("smash-layered", "smash-flow"):
        assert "may bring about" in why_refused(get_planner(name), Problem(instance), Settings())
        assert hold_to(name, Problem(instance, NO_TOPPLE)).cost == 2
    left_out = ask(get_planner("smash"), Problem(instance), Settings(), 0.0).details.get("left_out", {})
    assert "layered" not in left_out or "may bring about" in left_out["layered"]


def test_a_schedule_of_the_precedence_graph_is_believed_only_where_the_law_takes_it():
    for seed in range(400):
        problem = related(seed, hand=0.0, contradictory=0.0)
        if problem.infeasible is None and not problem.solved:
            found = precedence_bound(problem, perf_counter() + 2.0)
            assert found.actions is None or problem.law.check(found.actions).accepted, seed


def _strided(stride):
    """Return an order of names: every so many-th, again from the second, and so on; backward for -1."""
    return lambda names: (
        [name for first in range(abs(stride)) for name in names[first::stride]] if stride > 0 else names[::stride]
    )


class TestFullHand:
    def wide(self, blocks, order):
        names = [f"b{number}" for number in range(1, blocks + 1)]
        piles = {f"s{at + 1}": names[4 * at : 4 * at + 4] for at in range((blocks - 1) // 4)}
        goal = OnGoal(dict(zip(order(names)[1:], order(names)[:-1], strict=True)))
        held = [name for name in names if all(name not in pile for pile in piles.values())]
        piles["s1"] = [*piles["s1"], *held[1:]]
        return make_instance(piles, goal, blocks=names, stacks=blocks, hand=held[0])

    def test_as_many_locations_as_blocks_are_proven_by_a_look_at_each(self):
        for order in (
            lambda names: names,
            _strided(-1),
            lambda names: names[::3] + names[1::3] + names[2::3],
        ):
            plan = ask(get_planner("smash"), Problem(self.wide(20, order)), Settings(), 60.0)
            assert plan.status == "optimal"

    @pytest.mark.parametrize("name", ["smash", "greedy", "astar"])
    def test_without_time_there_is_a_plan_and_no_false_word(self, name):
        for seed in range(20):
            problem = related(seed, hand=1.0)
            if problem.infeasible is None:
                hold_to(name, problem, budget=0.0)

    def test_the_greedy_planner_ends_when_every_place_was_looked_at(self):
        began = perf_counter()
        problem = Problem(self.wide(6, _strided(-1)))
        plan = ask(get_planner("greedy"), problem, Settings(), 600.0)
        assert problem.law.check(plan.actions).accepted
        assert perf_counter() - began < 300.0
        assert plan.lower_bound is None or plan.status == "optimal"
        assert {incumbent.origin for incumbent in plan.incumbents} == {"greedy"}

    def test_bounds_are_told_while_it_plans(self):
        heard = Heard()
        plan = ask(get_planner("smash"), Problem(self.wide(8, _strided(-1))), Settings(), 10.0, heard)
        assert heard.bounds[-1] == plan.lower_bound
        assert heard.bounds == sorted(heard.bounds)

    def test_a_warm_start_serves_every_first_place(self):
        problem = Problem(make_instance({"s1": [*"ab"]}, {"s2": [*"bac"]}, stacks=2, buffers=1, hand="c"))
        plan = hold_to("smash-layered", problem, 10.0, Settings(warm_start="greedy"))
        assert plan.status == "optimal"
        assert plan.incumbents[0].origin == "greedy"


def test_what_is_left_after_each_of_many_first_places_is_not_held_at_once():
    blocks = [f"b{number}" for number in range(1000)]
    start = {f"s{number}": [block] for number, block in enumerate(blocks[1:])}
    log = SolveLog(Problem(make_instance(start, OnGoal({blocks[0]: blocks[1]}), hand=blocks[0])))
    tracemalloc.start()
    plan_first_places(log, perf_counter(), lambda rest, until: None)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 10_000_000  # bytes; 1,000 starts of 1,000 locations are four times as much
