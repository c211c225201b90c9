"""Budgets are wall time and are kept within max(5 %, 0.5 s): for a quiet machine (`make test-timing`)."""

from time import perf_counter

import pytest

from smash.planners.astar import BeamSearch
from smash.planners.greedy import GreedyPlanner, greedy_steps
from smash.planners.protocol import SolveOptions
from smash.planners.registry import get_planner
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from smash.problem.views.numbered import Numbered

pytestmark = [pytest.mark.timing, pytest.mark.timeout(600)]

NO_TOPPLE = PlanOptions(topple=False)


def grace(budget):
    """Return how long a planner may go on after its budget [s]."""
    return max(0.05 * budget, 0.5)


@pytest.fixture(scope="module", autouse=True)
def _prepared():
    """Leave out what is done once a process or a machine: imports, machine code."""
    for name in ("smash", "astar", "smash-layered"):
        get_planner(name).prepare()


@pytest.mark.parametrize(
    ("name", "blocks", "buffers", "topple", "budget"),
    [
        ("smash", 20, 0, False, 0.05),
        ("smash", 20, 0, False, 0.5),
        ("smash", 150, 0, False, 0.05),
        ("smash", 150, 0, False, 0.5),
        ("smash", 40, 2, False, 2.0),
        ("smash", 2000, 2, False, 0.1),
        ("smash", 2000, 2000, False, 0.1),
        ("smash", 2000, 2000, False, 1.0),
        ("greedy", 2000, 2, False, 0.1),
        ("smash-layered", 40, 2, False, 2.0),
        ("smash-flow", 60, 2, True, 1.5),
        ("smash-flow", 450, 2, True, 1.5),
        ("precedence", 150, 0, False, 0.2),
        ("astar", 14, 0, False, 0.3),
        ("astar", 40, 12, False, 1.0),
        ("astar", 200, 12, False, 1.0),
    ],
)
def test_a_planner_answers_within_the_grace_of_its_budget(name, blocks, buffers, topple, budget):
    instance = generate("multi", blocks, buffers=buffers, seed=5)[0]
    planner, started = get_planner(name), perf_counter()
    planner.solve(instance, SolveOptions(topple=topple), budget)
    assert perf_counter() - started < budget + grace(budget)


def test_the_passes_of_a_beam_end_at_their_deadline():
    search = BeamSearch(Numbered.of(generate("multi", 20, buffers=0)[0]), NO_TOPPLE, 400)
    started = perf_counter()
    while search.run(started + 0.3) is not None:
        pass
    assert perf_counter() - started < 0.3 + 0.5


def test_patient_passes_of_the_greedy_planner_go_on_to_the_deadline():
    problem = Problem(generate("multi", 20, buffers=0)[0], NO_TOPPLE)
    started = perf_counter()
    list(greedy_steps(problem, started + 0.3, patient=True))
    assert 0.1 < perf_counter() - started < 0.3 + 0.5


def test_no_pass_of_the_greedy_planner_is_begun_that_would_end_after_the_budget():
    instance = generate("multi", 1000, buffers=2, seed=5)[0]
    began = perf_counter()
    first = GreedyPlanner().solve(instance, SolveOptions(topple=False), 1e-9).incumbents[0]
    assert perf_counter() - began < 3 * first.seconds + 0.5


@pytest.mark.parametrize("topple", [True, False])
@pytest.mark.parametrize("buffers", [12, 1])
def test_a_thousand_blocks_get_their_first_plan_within_seconds(topple, buffers):
    instance = generate("multi", 1000, buffers=buffers)[0]
    started = perf_counter()
    GreedyPlanner().solve(instance, SolveOptions(topple), 0.1)
    assert perf_counter() - started < 20
