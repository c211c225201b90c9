"""Annealing: whenever it is stopped its choices hit every cycle; compiled and interpreted it does the same."""

import math

import pytest

from smash.planners.precedence.annealing import Annealing
from smash.planners.precedence.compiled import INTERPRETED
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.hitting_set import HittingSetSolver
from smash.planners.precedence.kernels import order
from smash.planners.precedence.turns import turn_graph
from smash.problem import PlanOptions
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.planners.precedence.events import hits_all

NO_TOPPLE = PlanOptions(topple=False)


def turning(blocks, stacks, seed):
    graph = build_graph(Problem(wide(blocks, stacks, seed), NO_TOPPLE))
    return graph, turn_graph(graph)


@pytest.mark.parametrize("moves", [0, 1, 10, 2000])
@pytest.mark.parametrize("seed", range(4))
def test_its_choices_hit_every_cycle(seed, moves):
    graph, turns = turning(25, 4, seed)
    assert hits_all(graph, Annealing(turns, INTERPRETED, seed).run(moves, math.inf))


@pytest.mark.parametrize("seed", range(4))
def test_it_finds_the_fewest_of_some_dozen_blocks(seed):
    graph, turns = turning(30, 4, seed)
    assert len(Annealing(turns, INTERPRETED, 0).run(6000, math.inf)) == len(
        HittingSetSolver(graph).solve(math.inf).chosen
    )


def test_past_the_deadline_it_tries_no_further_moves():
    graph, turns = turning(12, 3, 0)
    assert Annealing(turns, INTERPRETED, 0).run(100, -math.inf) == set(range(len(graph.choices)))


def test_where_labels_run_out_they_are_given_anew(monkeypatch):
    monkeypatch.setattr(order, "GAP", 2)
    graph, turns = turning(25, 4, seed=1)
    assert hits_all(graph, Annealing(turns, INTERPRETED, 0).run(2000, math.inf))


def test_compiled_and_interpreted_it_finds_the_same(kernels):
    _, turns = turning(25, 4, seed=2)
    found = [Annealing(turns, code, 5).run(3000, math.inf) for code in (INTERPRETED, kernels)]
    assert found[0] == found[1]
