import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from hypothesis import HealthCheck, given, settings
from smash_baselines import planners
from smash_baselines.engines.downward import bound_in
from smash_baselines.planners import Aries, Enhsp, FdLama, FdLamaChain, FdLamaFirst, FdOpt, FdOptIpdb, SymkOpt

from smash.planners.protocol import SolveOptions
from smash.planners.registry import get_planner
from smash.problem import Law, PlannerOutOfMemory, PlanOptions, make_instance, read_instance
from smash.problem.model import OnGoal, PositionsGoal, StacksGoal
from smash.problem.sets.suites import suite_files
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options

FAST_DOWNWARD = [FdLama, FdLamaChain, FdLamaFirst, FdOpt, FdOptIpdb]
PROVERS = [FdOpt, FdOptIpdb, SymkOpt]

pytestmark = pytest.mark.skipif(FdOpt().missing() is not None, reason="Fast Downward is not installed")


class Enough(Exception):
    """Raised out of a planner's report of its first plan."""


def figure_1():
    """The paper's first figure: the block at the bottom of four must reach the empty location."""
    return make_instance(
        name="figure-1",
        blocks=["a", "b", "c", "d"],
        stacks=["s1", "g"],
        buffers=["u1", "u2", "u3"],
        start={"s1": ["a", "b", "c", "d"]},
        goal=PositionsGoal({"a": ("g", 1)}),
    )


def solve(planner, instance, options=None, budget=20.0, **more):
    return planner.solve(instance, options or SolveOptions(), budget, **more)


@pytest.mark.parametrize("planner", [FdOpt, FdOptIpdb])
def test_one_topple_saves_five_actions_in_figure_1(planner):
    with_topple, without = solve(planner(), figure_1()), solve(planner(), figure_1(), SolveOptions(topple=False))
    assert (with_topple.status, with_topple.cost, with_topple.bound_origin) == ("optimal", 3, planner.name)
    assert (without.status, without.cost) == ("optimal", 8)


def test_a_cap_costs_more_topples():
    result = solve(FdOptIpdb(), figure_1(), SolveOptions(max_topple=2))
    assert (result.status, result.cost) == ("optimal", 4)
    assert FdLama().unsupported(figure_1(), SolveOptions(max_topple=2)) is not None
    assert FdLama().unsupported(figure_1(), SolveOptions(max_topple=4)) is None


def test_lama_reports_each_better_plan_at_once():
    seen = []

    def leave_at_third(seconds, cost, actions):
        seen.append((seconds, cost))
        if len(seen) == 3:
            raise Enough

    instance = read_instance(suite_files("multi-6")[0])
    with pytest.raises(Enough):
        solve(FdLamaChain(), instance, budget=60.0, on_incumbent=leave_at_third)
    assert seen == sorted(seen)
    assert [cost for _, cost in seen] == sorted({cost for _, cost in seen}, reverse=True)


def test_translation_and_search_are_told_apart():
    result = solve(FdLama(), figure_1())
    assert result.status == "feasible"
    assert result.lower_bound is None
    assert result.details["outcome"] == "solved"
    assert result.details["translation_seconds"] > 0
    assert result.details["search_seconds"] > 0


def test_a_start_that_holds_the_goal_needs_no_engine():
    empty = make_instance(name="empty", blocks=[], stacks=["s"], start={}, goal=StacksGoal({}))
    for planner in FAST_DOWNWARD:
        result = solve(planner(), empty)
        assert (result.status, result.actions) == ("optimal", ())


def test_what_has_no_plan_is_proven_by_an_exhaustive_search_alone():
    turned = make_instance(
        name="turned", blocks=["a", "b"], stacks=["s"], start={"s": ["a", "b"]}, goal=StacksGoal({"s": ("b", "a")})
    )
    pick_and_place = SolveOptions(topple=False)
    assert solve(FdOpt(), turned, pick_and_place).status == "infeasible"
    assert solve(FdOptIpdb(), turned, pick_and_place).status == "infeasible"
    assert solve(FdLama(), turned, pick_and_place, budget=3.0).status == "unknown"
    assert solve(FdOpt(), turned).cost == 5


def test_odd_names_starts_on_buffers_and_on_the_table():
    odd = make_instance(
        name="odd",
        blocks=["", "quote'\"(", "größe"],
        stacks=["größe", "x y"],
        buffers=["", "(:init"],
        start={"": ["größe"]},
        table=["", "quote'\"("],
        goal=OnGoal({"größe": "", "": "quote'\"("}, ("quote'\"(",)),
    )
    for planner in FAST_DOWNWARD:
        result = solve(planner(), odd)
        assert Law(odd).check(result.actions).accepted
        assert result.cost == 6


@pytest.mark.parametrize("planner", [FdLama, FdOpt])
def test_a_spent_budget_is_said(planner):
    instance = read_instance(suite_files("multi-9")[1])
    result = solve(planner(), instance, SolveOptions(topple=False), budget=1.0)
    assert result.status in ("feasible", "unknown")
    assert result.details["outcome"] == "budget spent"


@pytest.mark.timing
@pytest.mark.parametrize("planner", [FdLama, FdOpt])
def test_the_budget_is_wall_time_and_holds(planner):
    instance = read_instance(suite_files("multi-9")[1])
    started = time.monotonic()
    solve(planner(), instance, SolveOptions(topple=False), budget=1.0)
    assert time.monotonic() - started < 1.5


def test_a_lower_bound_stands_when_the_budget_ends_first():
    instance = read_instance(suite_files("multi-9")[1])
    for budget in (4.0, 16.0, 64.0):  # on a busy machine the search may not have begun by the end of the first
        result = solve(FdOpt(), instance, SolveOptions(topple=False), budget)
        if result.lower_bound is not None:
            break
    assert result.status == "unknown"
    assert 10 < result.lower_bound <= 40
    assert result.bound_origin == "fd-opt"


@pytest.mark.parametrize(
    ("line", "bound"),
    [
        ("[t=0.063495s, 11212 KB] f = 9, 7 evaluated, 1 expanded", 9),
        ("[t=27.7s, 940780 KB] BOUND: 19 < 2147483647 [0/1 plans], dir: BW, reconstruction time: 0.0s", 19),
        ("[t=3.085028s, 602332 KB] BOUND: 37 < 36 [1/1 plans], dir: BW, reconstruction time: 0.042097s", 36),
        ("[t=0.063495s, 11212 KB] New best heuristic value for cpdbs: 8", None),
    ],
)
def test_what_a_search_says_of_its_bound_is_never_above_its_plan(line, bound):
    assert bound_in(line) == bound


def test_a_memory_limit_is_a_crash_with_a_name():
    with pytest.raises(PlannerOutOfMemory, match="memory"):
        solve(FdOpt(memory=30 << 20), read_instance(suite_files("multi-9")[0]))


SLEEPER = """
import sys
from smash_baselines.planners import FdLama
from smash.planners.protocol import SolveOptions
from smash.problem import read_instance
print("started", flush=True)
FdLama().solve(read_instance(sys.argv[1]), SolveOptions(), 60, lambda *_: print("plan", flush=True))
"""


@pytest.mark.parametrize(
    "number", [signal.SIGKILL, *(pytest.param(s, marks=pytest.mark.slow) for s in (signal.SIGTERM, signal.SIGINT))]
)
def test_killing_the_caller_leaves_no_engine(number):
    caller = subprocess.Popen(
        [sys.executable, "-c", SLEEPER, str(suite_files("multi-9")[0])],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env={**os.environ, "PYTHONPATH": str(Path(planners.__file__).parents[1])},
    )
    assert caller.stdout.readline() == "started\n"
    assert caller.stdout.readline() == "plan\n"
    engines = psutil.Process(caller.pid).children(recursive=True)
    assert engines
    caller.send_signal(number)
    caller.communicate(timeout=60)
    _, alive = psutil.wait_procs(engines, timeout=60)
    assert not alive


@pytest.mark.slow
def test_aries_and_its_server_die_with_the_caller():
    if Aries().missing():
        pytest.skip("Aries is not installed")
    solver = SLEEPER.replace("FdLama", "Aries").replace("60", "60.0")
    caller = subprocess.Popen(
        [sys.executable, "-c", solver, str(suite_files("multi-9")[0])],
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(Path(planners.__file__).parents[1])},
    )
    family = psutil.Process(caller.pid)
    deadline = time.monotonic() + 100
    while not any("aries_linux" in child.name() for child in family.children(recursive=True)):
        assert time.monotonic() < deadline
        time.sleep(0.1)
    engines = family.children(recursive=True)
    caller.kill()
    caller.communicate(timeout=60)
    _, alive = psutil.wait_procs(engines, timeout=60)
    assert not alive


@pytest.mark.parametrize("planner", [FdLama, Enhsp, pytest.param(Aries, marks=pytest.mark.slow)])
def test_the_first_plan_comes_before_the_end_and_who_has_enough_can_leave(planner):
    if planner().missing():
        pytest.skip(str(planner().missing()))
    seen = []

    def leave(seconds, cost, actions):
        seen.append(cost)
        raise Enough

    before = set(psutil.Process().children(recursive=True))
    with pytest.raises(Enough):
        solve(planner(), figure_1(), budget=60.0, on_incumbent=leave)
    assert len(seen) == 1
    assert seen[0] >= 3
    assert set(psutil.Process().children(recursive=True)) <= before


def test_the_registry_knows_the_baselines():
    for name in (
        "fd-lama",
        "fd-lama:conditional",
        "fd-lama:chain",
        "fd-lama-first",
        "fd-opt",
        "fd-opt-ipdb",
        "symk-opt",
    ):
        assert get_planner(name).summary


def assert_optimal(planner, instance, options, budget=30.0):
    solve_options = SolveOptions(options.topple, options.max_topple)
    result = solve(planner, instance, solve_options, budget)
    best = optimal_cost(instance, options)
    assert not result.details.get("refused")
    assert (result.status, result.cost) == (("infeasible", None) if best is None else ("optimal", best))
    assert best is None or result.lower_bound == best


@settings(max_examples=12, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(instances(max_blocks=3), plan_options())
def test_ipdb_proves_the_exhaustive_optimum(instance, options):
    assert_optimal(FdOptIpdb(), instance, options)


@pytest.mark.slow
@pytest.mark.parametrize("planner", PROVERS)
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(instances(max_blocks=5), plan_options())
def test_every_prover_finds_the_exhaustive_optimum(planner, instance, options):
    assert_optimal(planner(), instance, options)


@pytest.mark.slow
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(instances(max_blocks=4), plan_options())
def test_lama_never_beats_the_optimum_and_its_plans_are_legal(instance, options):
    for planner in (FdLama(), FdLamaChain()):
        solve_options = SolveOptions(options.topple, options.max_topple)
        if planner.unsupported(instance, solve_options):
            continue
        result = solve(planner, instance, solve_options, 1.0)
        best = optimal_cost(instance, PlanOptions(options.topple, options.max_topple))
        assert not result.details.get("refused")
        assert (result.cost is None) if best is None else (result.cost is None or result.cost >= best)
