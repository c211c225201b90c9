"""The fewest blocks put aside, proven a second time by core-guided MaxSAT."""

import itertools
import math
import random
from time import perf_counter

import pytest
from pysat.solvers import Solver

from smash.planners.precedence import hitting_set, maxsat
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.hitting_set import HIGHS, MAXSAT, HittingSetSolver
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from smash.problem.sets.open_instances import Shape, draw_instance
from tests.arrangements import wide
from tests.planners.precedence.events import hits_all
from tests.planners.precedence.maxsat import fewest_aside


def drawn(blocks, stacks, seed):
    """Draw as the study `fewest_aside` does, with as many buffers as blocks."""
    name = f"aside-{blocks}-{stacks}-{seed}"
    instance = draw_instance(name, Shape(blocks, stacks, blocks), random.Random(name))
    return build_graph(Problem(instance, PlanOptions(topple=False)))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("blocks", "stacks"), [(20, 3), (60, 8)])
def test_two_methods_find_the_same(blocks, stacks, seed):
    graph = drawn(blocks, stacks, seed)
    solver = HittingSetSolver(graph, prover=HIGHS)
    found = solver.solve(math.inf)
    assert hits_all(graph, found.chosen)
    assert found.bound == solver.cost(found.chosen) == 2 * fewest_aside(graph)


def test_annealing_and_rank_inequalities_prove_nothing_that_is_not_so(kernels):
    graph = drawn(120, 12, seed=0)
    solver = HittingSetSolver(graph, prover=HIGHS)
    found = solver.solve(perf_counter() + 30)
    assert found.bound <= 2 * fewest_aside(graph) <= solver.cost(found.chosen)


@pytest.mark.parametrize(("blocks", "stacks", "seed"), [(30, 8, 9), (40, 6, 5)])
def test_runs_that_one_topple_takes_are_counted_too(blocks, stacks, seed, kernels, monkeypatch):
    monkeypatch.setattr(hitting_set, "QUICK_CHOICES", 0)
    graph = build_graph(Problem(wide(blocks, stacks, seed), PlanOptions(max_topple=2)))
    solver = HittingSetSolver(graph, prover=MAXSAT)
    found = solver.solve(math.inf)
    assert hits_all(graph, found.chosen)
    assert found.prover == MAXSAT
    assert found.bound == solver.cost(found.chosen) == HittingSetSolver(graph, prover=HIGHS).solve(math.inf).bound


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_three_hundred_blocks_on_thirty_stacks(seed, kernels):
    graph = drawn(300, 30, seed)
    solver = HittingSetSolver(graph, prover=HIGHS)
    found = solver.solve(perf_counter() + 300)
    assert found.bound <= 2 * fewest_aside(graph) <= solver.cost(found.chosen)


def test_the_solver_stops_at_the_conflicts_that_it_is_allowed():
    """The deadline is looked at between two allowances (ten pigeons in nine holes; Glucose goes on to a restart)."""
    holes, pigeons = range(9), range(10)
    name = {(pigeon, hole): 9 * pigeon + hole + 1 for pigeon in pigeons for hole in holes}
    clauses = [[name[pigeon, hole] for hole in holes] for pigeon in pigeons]
    clauses += [[-name[a, hole], -name[b, hole]] for hole in holes for a, b in itertools.combinations(pigeons, 2)]
    with Solver(maxsat.SOLVER, bootstrap_with=clauses) as solver:
        solver.conf_budget(10)
        assert solver.solve_limited() is None
        assert solver.accum_stats()["conflicts"] <= 10
