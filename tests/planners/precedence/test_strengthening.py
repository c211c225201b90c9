"""Annealing and rank inequalities inside of the solver: they speed a proof up and change nothing of it."""

import math

import pytest

from smash.planners.precedence import hitting_set
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.hitting_set import HittingSetSolver
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.planners.precedence.events import cheapest_hitting_cost, hits_all


@pytest.fixture
def at_once(monkeypatch):
    """No dive along the relaxation, and no integer solve on the cycles alone, comes before them."""
    dive = HittingSetSolver._dive

    def only_of_whole_values(solver, values, deadline):
        whole = values is not None and (values == values.round()).all()
        return dive(solver, values, deadline) if whole else set(range(len(solver.graph.choices)))

    monkeypatch.setattr(hitting_set, "QUICK_CHOICES", 0)
    monkeypatch.setattr(HittingSetSolver, "_dive", only_of_whole_values)


@pytest.mark.usefixtures("at_once")
@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("options", [PlanOptions(topple=False), PlanOptions(max_topple=1)])
def test_small_graphs_end_at_the_cheapest_of_all_sets(seed, options, kernels):
    graph = build_graph(Problem(wide(11, 4, seed), options))
    solver = HittingSetSolver(graph)
    found = solver.solve(math.inf)
    assert hits_all(graph, found.chosen)
    assert found.bound == solver.cost(found.chosen) == cheapest_hitting_cost(graph)


@pytest.mark.usefixtures("at_once")
def test_a_gap_of_the_cycles_is_closed_by_rank_inequalities(kernels):
    graph = build_graph(Problem(wide(120, 20, seed=1), PlanOptions(topple=False)))
    bounds = []
    solver = HittingSetSolver(graph, on_bound=bounds.append)
    found = solver.solve(math.inf)
    assert found.rounds["ranks"] > 0
    assert bounds[-1] == solver.cost(found.chosen)
    assert hits_all(graph, found.chosen)
