"""The default planner: the optimum of exhaustive search, its parts merged under one budget."""

import dataclasses
import math
import random
from time import perf_counter

import pytest
from hypothesis import given, settings

from smash.planners.astar.planner import search_numbered_states
from smash.planners.greedy import greedy_plans
from smash.planners.portfolio import SmashPlanner, _Parts
from smash.planners.precedence import PrecedencePlanner
from smash.planners.protocol import Settings, SolveLog, SolveOptions
from smash.problem import Costs, Law, PlanOptions, make_instance
from smash.problem.model import StacksGoal
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.sets.open_instances import Shape, draw_instance
from smash.problem.sets.suites import read_suite
from tests.arrangements import wide
from tests.oracle import optimal_cost
from tests.strategies import EVERY_KIND, instances, plan_options


def with_buffers(instance, count):
    buffers = instance.buffers[:count]
    start = {location: instance.start[location] for location in (*instance.stacks, *buffers)}
    return dataclasses.replace(instance, buffers=buffers, start=start)


@settings(max_examples=150, deadline=None)
@given(instances(max_blocks=4, odd_names=True, kinds=EVERY_KIND, hand=True), plan_options())
def test_the_default_proves_the_optimum_or_that_there_is_no_plan(instance, options):
    best = optimal_cost(instance, options)
    result = SmashPlanner().solve(instance, SolveOptions(options.topple, options.max_topple), 20)
    assert result.cost == result.lower_bound == best
    assert result.status == ("infeasible" if best is None else "optimal")
    if best is not None:
        assert Law(instance, options).check(result.actions).accepted


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4, kinds=EVERY_KIND, hand=True), plan_options())
def test_the_precedence_bound_never_exceeds_the_optimum_of_the_search(instance, options):
    settings_ = SolveOptions(options.topple, options.max_topple)
    bounded = PrecedencePlanner().solve(instance, settings_, 10)
    solved = SmashPlanner().solve(instance, settings_, 10)
    if solved.cost is not None:
        assert bounded.lower_bound <= solved.cost


@pytest.mark.parametrize("topple", [True, False])
@pytest.mark.parametrize("suite", ["multi-4", "multi-6", "single-6", "single-9"])
def test_benchmark_instances_are_proven_with_every_number_of_buffers(suite, topple):
    for number, instance in enumerate(read_suite(suite)):
        result = SmashPlanner().solve(with_buffers(instance, number % 13), SolveOptions(topple), 30)
        assert result.status == "optimal"


@pytest.mark.slow
@pytest.mark.parametrize("topple", [True, False])
@pytest.mark.parametrize("buffers", range(13))
def test_nine_blocks_are_proven_with_every_number_of_buffers(buffers, topple):
    for instance in read_suite("multi-9"):
        assert SmashPlanner().solve(with_buffers(instance, buffers), SolveOptions(topple), 30).status == "optimal"


def test_incumbents_improve_and_are_reported_at_once():
    seen = []
    instance = generate("multi", 9, buffers=1, seed=5)[0]
    result = SmashPlanner().solve(
        instance, SolveOptions(topple=False), 10, lambda seconds, cost, plan: seen.append((seconds, cost, len(plan)))
    )
    assert [entry[:2] for entry in seen] == [tuple(entry[:2]) for entry in result.incumbents]
    assert all(cost == length for _, cost, length in seen)
    assert [cost for _, cost, _ in seen] == sorted((cost for _, cost, _ in seen), reverse=True)


@pytest.mark.parametrize("budget", [0.05, 0.5])
@pytest.mark.parametrize("blocks", [20, 150])
def test_a_short_budget_gives_a_plan_and_a_bound_at_every_size(blocks, budget):
    instance = generate("multi", blocks, buffers=0)[0]
    result = SmashPlanner().solve(instance, SolveOptions(topple=False), budget)
    assert result.lower_bound <= result.cost


def test_an_empty_problem_needs_no_action():
    instance = make_instance(name="none", blocks=[], stacks=["s1"], start={}, goal=StacksGoal({}))
    result = SmashPlanner().solve(instance, SolveOptions(), 1)
    assert (result.status, result.cost) == ("optimal", 0)


def test_two_locations_without_topple_are_refused_with_the_proof():
    goal = StacksGoal({"s1": ("b", "a")})
    instance = make_instance(name="swap", blocks=["a", "b"], stacks=["s1", "s2"], start={"s1": ["a", "b"]}, goal=goal)
    result = SmashPlanner().solve(instance, SolveOptions(topple=False), 1)
    assert (result.status, result.bound_origin) == ("infeasible", "feasibility")
    assert SmashPlanner().solve(instance, SolveOptions(), 1).cost == optimal_cost(instance, PlanOptions())


def test_what_the_beam_found_and_proved_is_reported_at_once():
    instance = generate("multi", 13, buffers=0, seed=4)[0]
    SmashPlanner().prepare()
    seen = []
    result = SmashPlanner().solve(
        instance, SolveOptions(topple=False), 4, lambda seconds, cost, plan: seen.append((cost, plan))
    )
    origins = {incumbent.origin for incumbent in result.incumbents}
    assert origins <= {"greedy", "exact", "milp", "beam", "lns"}
    assert [cost for cost, _ in seen] == [incumbent.cost for incumbent in result.incumbents]
    assert all(Law(instance, PlanOptions(topple=False)).check(plan).accepted for _, plan in seen)
    assert result.lower_bound <= result.cost


@pytest.mark.usefixtures("machine_code")
def test_a_beam_that_left_nothing_out_proves_the_plan_under_its_own_name(monkeypatch):
    for method in ("light_search", "search", "precedence", "layered", "neighbourhoods"):
        monkeypatch.setattr(f"smash.planners.portfolio._Parts.{method}", lambda *_: None)
    instance = generate("multi", 6, buffers=0, seed=4)[0]
    result = SmashPlanner().solve(instance, SolveOptions(topple=False), 60)
    assert (result.status, result.bound_origin) == ("optimal", "beam")
    assert result.cost == optimal_cost(instance, PlanOptions(topple=False))


@pytest.mark.parametrize(("blocks", "stacks", "buffers"), [(60, 4, 0), (90, 6, 2), (120, 10, 1)])
def test_with_the_time_for_it_no_plan_is_dearer_than_that_of_greedy_alone(blocks, stacks, buffers, monkeypatch):
    monkeypatch.setattr("smash.planners.portfolio.end_of", lambda until, share: math.inf)
    problem = Problem(wide(blocks, stacks, 3, buffers), PlanOptions(topple=False))
    alone = [len(actions) for actions in greedy_plans(problem, math.inf)]
    parts, log = _Parts(Settings()), SolveLog(problem)
    parts.greedy(problem, log, -math.inf)  # no time but for the first plan
    assert log.cost == alone[0]
    parts.greedy(problem, log, math.inf)
    assert log.cost == alone[-1]


def test_the_precedence_graph_leaves_greedy_passes_the_time_that_they_take(monkeypatch):
    monkeypatch.setattr("smash.planners.greedy.passes.GRACE", 60.0)
    problem = Problem(wide(60, 4, 3, 60), PlanOptions(topple=False))
    parts, log, ends = _Parts(Settings()), SolveLog(problem), []
    monkeypatch.setattr("smash.planners.precedence.bound.precedence_bound", lambda *given, **_: ends.append(given[1]))
    parts.greedy(problem, log, -math.inf)
    for seconds in (3.0, 1e6):
        monkeypatch.setattr("smash.planners.greedy.GreedyRun.seconds_left", lambda run, seconds=seconds: seconds)
        parts.precedence(problem, log, perf_counter() + 6.0)  # six tenths of ten seconds
    assert ends[0] - perf_counter() == pytest.approx(6.0, abs=1.0)
    assert ends[1] - perf_counter() == pytest.approx(1.0, abs=1.0)


def sized(blocks, *, is_plain=True):
    """Return a problem of so many blocks, plain or with another cost."""
    costs = Costs() if is_plain else Costs({"pick": 3})
    return Problem(dataclasses.replace(generate("multi", blocks, buffers=2)[0], costs=costs))


def rows(problem):
    """Return (name, share, most seconds) of each method that takes a problem, in their order."""
    methods = [method for method in SmashPlanner().methods(problem, Settings()) if method.takes(problem) is None]
    return [(m.name, m.share() if callable(m.share) else m.share, m.most) for m in methods]


FIRST = [("greedy", 0.1, math.inf), ("light search", 1.0, 0.12)]
LAST = [
    ("neighbourhoods", 0.5, math.inf),
    ("beam", 0.5, math.inf),
    ("search again", 0.5, math.inf),
    ("neighbourhoods to the end", 1.0, math.inf),
    ("greedy passes to the end", 1.0, math.inf),
]
LAYERED = ("layered", 0.5, math.inf)


def test_without_topple_greedy_makes_all_of_its_passes_first():
    for topple, share in ((False, 1.0), (True, 0.1)):
        problem = Problem(generate("multi", 20, buffers=3)[0], PlanOptions(topple))
        assert rows(problem)[0] == ("greedy", share, math.inf)


def test_choices_that_do_not_fit_have_greedy_end_its_passes_before_more_is_bounded(monkeypatch):
    problem = Problem(wide(60, 4, 3, 0), PlanOptions(topple=False))
    alone = [len(actions) for actions in greedy_plans(problem, math.inf)]
    parts, log, costs = _Parts(Settings()), SolveLog(problem), []

    def no_plan(problem, deadline, on_plan, threads, on_no_plan, on_bound):
        on_no_plan()
        costs.append(log.cost)

    monkeypatch.setattr("smash.planners.precedence.bound.precedence_bound", no_plan)
    parts.precedence(problem, log, perf_counter() + 100.0)
    assert costs == [alone[-1]]


def test_up_to_twelve_blocks_the_search_comes_before_the_precedence_graph():
    exact = [("search", 0.6, math.inf), ("precedence", 0.3, math.inf)]
    assert rows(sized(12)) == [*FIRST, *exact, LAYERED, *LAST]


@pytest.mark.parametrize(
    ("blocks", "precedence", "search", "layered"),
    [(13, 0.3, 0.4, [LAYERED]), (40, 0.3, 0.4, [LAYERED]), (41, 0.6, 0.2, [])],
)
def test_with_more_blocks_beams_help_and_beyond_forty_the_layered_model_proves_nothing(
    blocks, precedence, search, layered
):
    exact = [
        ("precedence", precedence, math.inf),
        ("greedy to its end", 1.0, math.inf),
        ("greedy passes", 0.1, 1.0),
        ("first beam", 0.1, 1.0),
        ("first neighbourhoods", 0.15, math.inf),
        ("search", search, math.inf),
    ]
    assert rows(sized(blocks)) == [*FIRST, *exact, *layered, *LAST]


def test_beyond_250_blocks_greedy_passes_come_before_neighbourhoods_and_beams_have_less():
    exact = [("precedence", 0.6, math.inf), ("greedy to its end", 1.0, math.inf), ("greedy passes", 0.2, math.inf)]
    assert rows(sized(251)) == [*FIRST, *exact, LAST[0], ("beam", 0.2, math.inf), *LAST[2:]]


@pytest.mark.parametrize(("blocks", "layered"), [(5, [("layered to the end", 1.0, math.inf)]), (41, [])])
def test_costs_are_left_to_the_search_over_the_laws_states_and_to_the_layered_model(blocks, layered):
    general = [("greedy", 0.1, math.inf), ("the law's states", 0.6, math.inf)]
    assert rows(sized(blocks, is_plain=False)) == [*general, *layered]


def test_where_the_law_refuses_a_neighbour_the_best_plan_is_taken_up_again(monkeypatch):
    taken, found = [], iter([[], None])

    class Neighbours:
        tried = 2

        def __init__(self, problem, seed):
            pass

        def take(self, steps):
            taken.append(steps)

        def run(self, until):
            return next(found)

    monkeypatch.setattr("smash.planners.portfolio.NeighbourhoodSearch", Neighbours)
    problem = Problem(generate("multi", 6, seed=1)[0], PlanOptions(topple=False))
    log, part = SolveLog(problem), _Parts(Settings())
    part.greedy(problem, log, math.inf)
    part.neighbourhoods(problem, log, math.inf)
    assert len(taken) == 2
    assert taken[0] == taken[1]
    assert log.refusals[0].startswith("lns")
    assert log.details["neighbourhoods"] == 2


@pytest.mark.parametrize("topple", [True, False])
def test_where_there_was_no_time_for_a_first_plan_nothing_searches_for_a_cheaper_one(topple):
    problem = Problem(generate("multi", 6, seed=1)[0], PlanOptions(topple=topple))
    log, part = SolveLog(problem), _Parts(Settings())
    for run in (part.light_search, part.search, part.beams, part.neighbourhoods, search_numbered_states):
        run(problem, log, perf_counter() + 10)
    assert log.best is None
    assert not log.details


@pytest.mark.parametrize(("goal", "passes", "kept"), [("stacks", 1e6, 5.0), ("on", 1e6, 1.0), ("stacks", 8.0, 2.0)])
def test_the_precedence_graph_gets_half_where_its_choices_always_are_a_plan_and_passes_would_not_end(
    goal, passes, kept, monkeypatch
):
    problem = Problem(draw_instance("x", Shape(60, 4, 1, kind=goal), random.Random(1)), PlanOptions(topple=True))
    parts, log, ends = _Parts(Settings()), SolveLog(problem), []
    monkeypatch.setattr("smash.planners.precedence.bound.precedence_bound", lambda *given, **_: ends.append(given[1]))
    parts.greedy(problem, log, -math.inf)
    monkeypatch.setattr("smash.planners.greedy.GreedyRun.seconds_left", lambda run: passes)
    parts.precedence(problem, log, perf_counter() + 6.0)  # six tenths of ten seconds
    assert ends[0] - perf_counter() == pytest.approx(kept, abs=0.9)
