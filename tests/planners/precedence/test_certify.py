"""Writing certificates: the checker accepts each, for the value of the cheapest hitting set."""

import math

import pytest
from hypothesis import given, settings

from smash.planners.precedence.certify import certify
from smash.planners.precedence.graph import build_graph
from smash.planners.precedence.hitting_set import HittingSetSolver
from smash.problem import PlanOptions
from smash.problem.certificate import Cases, proven_bound
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.planners.precedence.events import cheapest_hitting_cost
from tests.strategies import instances, plan_options


@settings(max_examples=50, deadline=None)
@given(instances(max_blocks=5), plan_options())
def test_a_certificate_proves_the_base_and_the_cheapest_hitting_set(instance, options):
    graph = build_graph(Problem(instance, options))
    certificate = certify(Problem(instance, options), math.inf)
    by_cycles = graph.base_cost + cheapest_hitting_cost(graph)
    assert certificate.bound == by_cycles or (certificate.places is not None and certificate.bound > by_cycles)
    assert proven_bound(instance, options, certificate) == certificate.bound


@pytest.mark.parametrize("topple", [True, False])
def test_cycles_known_before_serve_the_proof(topple):
    instance, options = wide(30, 4, seed=5), PlanOptions(topple)
    known = HittingSetSolver(build_graph(Problem(instance, options))).solve(math.inf).cycles
    certificate = certify(Problem(instance, options), math.inf, known)
    assert proven_bound(instance, options, certificate) == certify(Problem(instance, options), math.inf).bound


def test_a_certificate_cut_short_proves_less_and_says_so():
    instance, options = wide(30, 4, seed=5), PlanOptions(topple=False)
    short = certify(Problem(instance, options), -math.inf)
    assert "time ran out" in short.note
    assert proven_bound(instance, options, short) == short.bound <= certify(Problem(instance, options), math.inf).bound


@pytest.mark.parametrize(("blocks", "stacks", "seed"), [(30, 8, 9), (40, 6, 5)])
def test_where_the_relaxation_leaves_a_gap_cases_close_it(blocks, stacks, seed):
    instance, options = wide(blocks, stacks, seed), PlanOptions(max_topple=2)
    graph = build_graph(Problem(instance, options))
    certificate = certify(Problem(instance, options), math.inf)
    assert isinstance(certificate.proof, Cases)
    assert certificate.bound == graph.base_cost + HittingSetSolver(graph).solve(math.inf).bound
    assert proven_bound(instance, options, certificate) == certificate.bound
