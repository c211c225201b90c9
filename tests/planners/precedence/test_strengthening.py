"""Annealing, rank inequalities and MaxSAT inside of the solver: they speed a proof up and change nothing of it."""

import itertools
import math

import pytest

from smash.planners.precedence import hitting_set
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.hitting_set import HIGHS, MAXSAT, HittingSetSolver
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.planners.precedence.events import cheapest_hitting_cost, hits_all

PROVERS = [HIGHS, MAXSAT]


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
@pytest.mark.parametrize("prover", PROVERS)
def test_small_graphs_end_at_the_cheapest_of_all_sets(seed, options, prover, kernels):
    graph = build_graph(Problem(wide(11, 4, seed), options))
    solver = HittingSetSolver(graph, prover=prover)
    found = solver.solve(math.inf)
    assert hits_all(graph, found.chosen)
    assert found.bound == solver.cost(found.chosen) == cheapest_hitting_cost(graph)


@pytest.mark.usefixtures("at_once")
def test_a_gap_of_the_cycles_is_closed_by_rank_inequalities(kernels):
    graph = build_graph(Problem(wide(120, 20, seed=1), PlanOptions(topple=False)))
    bounds = []
    solver = HittingSetSolver(graph, on_bound=bounds.append, prover=HIGHS)
    found = solver.solve(math.inf)
    assert found.rounds["ranks"] > 0
    assert found.prover == HIGHS
    assert bounds[-1] == solver.cost(found.chosen)
    assert hits_all(graph, found.chosen)


@pytest.mark.usefixtures("at_once")
def test_a_gap_of_the_cycles_is_closed_by_maxsat(kernels):
    graph = build_graph(Problem(wide(80, 14, seed=4), PlanOptions(topple=False)))
    bounds = []
    solver = HittingSetSolver(graph, on_bound=bounds.append)
    found = solver.solve(math.inf)
    assert found.prover == MAXSAT
    assert bounds == sorted(set(bounds))
    assert bounds[-1] == solver.cost(found.chosen)
    assert hits_all(graph, found.chosen)


@pytest.mark.usefixtures("at_once")
def test_with_more_blocks_rank_inequalities_take_the_place_of_maxsat_unless_it_is_asked_for(kernels, monkeypatch):
    monkeypatch.setattr(hitting_set, "MOST_COUNTED", 10)
    graph = build_graph(Problem(wide(80, 14, seed=4), PlanOptions(topple=False)))
    ranked, counted = (HittingSetSolver(graph, prover=prover).solve(math.inf) for prover in (None, MAXSAT))
    assert ranked.prover == HIGHS
    assert ranked.rounds["ranks"] > 0
    assert counted.prover == MAXSAT
    assert counted.rounds["ranks"] == 0
    assert ranked.bound == counted.bound


@pytest.mark.usefixtures("at_once")
def test_maxsat_that_is_stopped_leaves_a_bound_that_holds(kernels, monkeypatch):
    from smash.planners.precedence import maxsat
    from smash.planners.precedence.turns import turn_graph

    graph = build_graph(Problem(wide(60, 10, seed=2), PlanOptions(topple=False)))
    full = HittingSetSolver(graph).solve(math.inf).bound
    stopped = HittingSetSolver(graph)
    short = list(maxsat.short_cycles(turn_graph(graph)))
    monkeypatch.setattr(maxsat, "short_cycles", lambda turns, deadline: short)
    clock = itertools.chain(itertools.repeat(0.0, 40), itertools.repeat(math.inf))
    monkeypatch.setattr(maxsat, "perf_counter", clock.__next__)
    found = stopped.solve(math.inf)
    assert found.bound <= full <= stopped.cost(found.chosen)


@pytest.mark.parametrize("seed", range(4))
def test_short_cycles_are_all_cycles_of_two_and_three_without_a_shorter_one(seed):
    from smash.planners.precedence.maxsat import short_cycles
    from smash.planners.precedence.turns import turn_graph

    turns = turn_graph(build_graph(Problem(wide(14, 5, seed), PlanOptions(topple=False))))
    free = turns.free.tolist()
    leads = turns.edges == 1
    pairs = {(a, b) for a, b in itertools.combinations(free, 2) if leads[a, b] and leads[b, a]}
    triples = {
        frozenset(turn)
        for turn in itertools.permutations(free, 3)
        if all(leads[a, b] and not leads[b, a] for a, b in zip(turn, (*turn[1:], turn[0]), strict=True))
    }
    found = list(short_cycles(turns))
    assert sorted(cycle for cycle in found if len(cycle) == 2) == sorted(pairs)
    assert {frozenset(cycle) for cycle in found if len(cycle) == 3} == triples
    assert len(found) == len(pairs) + len(triples)


@pytest.mark.usefixtures("at_once")
@pytest.mark.parametrize("most", [0, 7])
def test_short_cycles_that_there_was_no_time_for_are_added_where_an_answer_leaves_them(most, kernels, monkeypatch):
    graph = build_graph(Problem(wide(40, 8, seed=4), PlanOptions(topple=False)))
    full = HittingSetSolver(graph).solve(math.inf)
    monkeypatch.setattr(hitting_set, "MOST_SHORT", most)
    found = HittingSetSolver(graph).solve(math.inf)
    assert found.bound == full.bound
    assert hits_all(graph, found.chosen)


@pytest.mark.usefixtures("at_once")
def test_maxsat_begins_with_long_cycles_that_the_relaxation_did_not_ask_for(kernels, monkeypatch):
    from smash.planners.precedence import maxsat

    given = []
    begin = maxsat.MaxSat.__init__

    def noted(self, weights, clauses, *more):
        given.append({tuple(clause) for clause in clauses if len(clause) > 3})
        begin(self, weights, clauses, *more)

    monkeypatch.setattr(maxsat.MaxSat, "__init__", noted)
    for roundings in (0, hitting_set.ROUNDINGS):
        monkeypatch.setattr(hitting_set, "ROUNDINGS", roundings)
        HittingSetSolver(build_graph(Problem(wide(80, 14, seed=4), PlanOptions(topple=False)))).solve(math.inf)
    without, with_them = given
    assert len(with_them) > len(without)


def test_listing_short_cycles_ends_at_the_deadline(monkeypatch):
    from smash.planners.precedence import maxsat
    from smash.planners.precedence.turns import turn_graph

    turns = turn_graph(build_graph(Problem(wide(60, 10, seed=2), PlanOptions(topple=False))))
    clock = itertools.count()
    monkeypatch.setattr(maxsat, "perf_counter", lambda: float(next(clock)))
    every, some = list(maxsat.short_cycles(turns)), list(maxsat.short_cycles(turns, next(clock) + 20.0))
    assert 0 < len(some) < len(every)
    assert some == every[: len(some)]
    assert not list(maxsat.short_cycles(turns, -1.0))
