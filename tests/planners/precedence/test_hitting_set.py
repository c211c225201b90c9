"""Cheapest hitting sets: they hit all cycles, nothing cheaper does, and whenever it is stopped the bound holds."""

import math

import pytest
from hypothesis import given, settings

from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.hitting_set import HittingSetSolver
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.planners.precedence.events import cheapest_hitting_cost, hits_all, in_order
from tests.strategies import instances, plan_options


@settings(max_examples=50, deadline=None)
@given(instances(max_blocks=5), plan_options())
def test_the_set_is_as_cheap_as_the_cheapest_of_all_sets_that_hit(instance, options):
    graph = build_graph(Problem(instance, options))
    solver = HittingSetSolver(graph)
    found = solver.solve(math.inf)
    assert hits_all(graph, found.chosen)
    assert found.bound == solver.cost(found.chosen) == cheapest_hitting_cost(graph)


def test_each_solve_may_have_another_number_of_threads():
    graph = build_graph(Problem(wide(10, 4, 0), PlanOptions(topple=False)))
    bounds = [HittingSetSolver(graph, threads).solve(math.inf).bound for threads in (1, 2, 3)]
    assert bounds == [cheapest_hitting_cost(graph)] * 3


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("options", [PlanOptions(), PlanOptions(max_topple=2), PlanOptions(topple=False)])
def test_rows_are_cycles_and_the_set_hits_each(seed, options):
    graph = build_graph(Problem(wide(10, 4, seed), options))
    found = HittingSetSolver(graph).solve(math.inf)
    assert hits_all(graph, found.chosen)
    for row, cycle in zip(found.rows, found.cycles, strict=True):
        assert row == graph.row(cycle)
        assert row & found.chosen
        assert not in_order(graph, set(cycle))
    assert found.bound == cheapest_hitting_cost(graph)


@pytest.mark.parametrize("topple", [True, False])
def test_bounds_rise_and_choices_get_cheaper_until_they_meet(topple):
    graph = build_graph(Problem(wide(60, 5, seed=6), PlanOptions(topple, 2 if topple else None)))
    bounds, costs = [], []
    solver = HittingSetSolver(graph, on_bound=bounds.append)
    costs.append(solver.cost(solver.start(math.inf)))
    found = solver.solve(math.inf, lambda chosen: costs.append(solver.cost(chosen)))
    assert bounds == sorted(set(bounds))
    assert costs == sorted(set(costs), reverse=True)
    assert found.bound == bounds[-1] == costs[-1]


def test_stopped_before_it_began_it_has_choices_that_hit_and_a_bound_that_holds():
    graph = build_graph(Problem(wide(12, 4, seed=3), PlanOptions(topple=False)))
    found = HittingSetSolver(graph).solve(-math.inf)
    assert hits_all(graph, found.chosen)
    assert found.bound <= HittingSetSolver(graph).solve(math.inf).bound


def test_without_topple_a_bound_is_even():
    graph = build_graph(Problem(wide(40, 4, seed=8), PlanOptions(topple=False)))
    bounds = []
    HittingSetSolver(graph, on_bound=bounds.append).solve(math.inf)
    assert bounds
    assert all(bound % 2 == 0 for bound in bounds)


@pytest.mark.parametrize(("blocks", "stacks", "seed"), [(40, 6, 3), (30, 8, 9), (40, 6, 5)])
def test_where_the_relaxation_leaves_a_gap_integer_choices_close_it(blocks, stacks, seed):
    graph = build_graph(Problem(wide(blocks, stacks, seed), PlanOptions(max_topple=2)))
    solver = HittingSetSolver(graph)
    found = solver.solve(math.inf)
    assert found.rounds["mip"] >= 1
    assert hits_all(graph, found.chosen)
    assert found.bound == solver.cost(found.chosen)


def test_nobody_has_proven_a_bound_that_is_the_base_cost():
    graph = build_graph(Problem(wide(30, 5, seed=1), PlanOptions(topple=False)))
    assert HittingSetSolver(graph).solve(-1.0).prover is None
