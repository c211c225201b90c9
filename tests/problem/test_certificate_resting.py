"""Certificates where the goal says `ontable` or `clear`, or the hand is full: true, whole, and refused when changed."""

import copy
import math

import pytest

from smash.planners.precedence.certify import certify
from smash.planners.precedence.graph import build_graph
from smash.problem import OnGoal, PlanOptions, make_instance
from smash.problem.certificate import (
    Leaf,
    RefusedCertificate,
    certificate_text,
    first_problems,
    proven_bound,
    read_certificate,
)
from smash.problem.problem import Problem
from tests.oracle import optimal_cost
from tests.planners.precedence.events import cheapest_hitting_cost
from tests.relations import related

NO_TOPPLE = PlanOptions(topple=False)
HELD = make_instance({"s1": [*"ab"], "s2": ["d"]}, OnGoal({"a": "c", "d": "b"}), stacks=5, hand="c")


def hitting_bound(problem):
    graph = build_graph(problem)
    return graph.base_cost + cheapest_hitting_cost(graph)


@pytest.mark.parametrize("part", range(2))
def test_a_certificate_proves_what_the_graph_says_and_no_plan_is_cheaper(part):
    for seed in range(150 * part, 150 * part + 150):
        problem = related(seed, hand=0.4, contradictory=0.0)
        if problem.infeasible is not None:
            continue
        instance, options = problem.instance, problem.options
        certificate = certify(problem, math.inf)
        assert proven_bound(instance, options, certificate) == certificate.bound
        assert certificate.bound <= optimal_cost(instance, options), seed
        rests = (
            [problem]
            if instance.hand is None
            else [Problem(r, options) for r in first_problems(instance, options).values()]
        )
        least = (instance.hand is not None) + min(map(hitting_bound, rests))
        if certificate.places is None and all(first.places is None for first in certificate.first_places):
            assert certificate.bound == least
        else:
            assert certificate.bound >= least


def test_blocks_that_may_fall_together_are_counted_once():
    instance = make_instance({"s1": [*"pqrs"]}, OnGoal({}, ontable=("p", "q", "r", "s")), stacks=3)
    assert certify(Problem(instance), math.inf).bound == 1
    assert certify(Problem(instance, PlanOptions(max_topple=1)), math.inf).bound == 3
    assert certify(Problem(instance, NO_TOPPLE), math.inf).bound == 6


def test_what_lies_on_a_clear_block_must_leave():
    instance = make_instance({"s1": [*"pqr"]}, OnGoal({}, clear=("p",)), stacks=2)
    assert certify(Problem(instance), math.inf).bound == 1
    assert certify(Problem(instance, NO_TOPPLE), math.inf).bound == 4


def test_a_full_hand_has_a_proof_for_each_class_of_locations(tmp_path):
    certificate = certify(Problem(HELD), math.inf)
    assert [first.place for first in certificate.first_places] == ["s1", "s2", "s3"]
    assert certificate.bound == optimal_cost(HELD)
    (tmp_path / "proof.json").write_text(certificate_text(certificate))
    assert read_certificate(tmp_path / "proof.json") == certificate


def test_without_a_full_hand_a_certificate_is_written_as_ever():
    instance = make_instance({"s1": [*"ab"]}, {"s2": [*"ab"]}, stacks=2)
    assert "first_places" not in certificate_text(certify(Problem(instance), math.inf))


def _drop(certificate):
    certificate.first_places.pop()


def _twice(certificate):
    certificate.first_places.append(certificate.first_places[0])


def _elsewhere(certificate):
    certificate.first_places[0].place = "s5"


def _more(certificate):
    certificate.first_places[0].bound += 1


def _all_more(certificate):
    certificate.bound += 1


def _beside(certificate):
    certificate.proof = Leaf([(0, 1)])


def _stranger(certificate):
    certificate.first_places[0].cycles.append(["c"])


@pytest.mark.parametrize("change", [_drop, _twice, _elsewhere, _more, _all_more, _beside, _stranger])
def test_a_changed_certificate_of_a_full_hand_is_refused(change):
    certificate = copy.deepcopy(certify(Problem(HELD), math.inf))
    change(certificate)
    with pytest.raises(RefusedCertificate):
        proven_bound(HELD, PlanOptions(), certificate)


def test_first_places_without_a_full_hand_are_refused():
    certificate = certify(Problem(HELD), math.inf)
    instance = make_instance({"s1": [*"ab"], "s2": ["d"]}, OnGoal({"d": "b"}), stacks=5, name=HELD.name)
    with pytest.raises(RefusedCertificate, match="the hand is empty"):
        proven_bound(instance, PlanOptions(), certificate)


@pytest.mark.parametrize("seed", range(0, 200, 5))
def test_a_bound_that_is_one_higher_is_refused(seed):
    problem = related(seed, hand=0.2, contradictory=0.0)
    if problem.infeasible is None:
        certificate = certify(problem, math.inf)
        certificate.bound += 1
        with pytest.raises(RefusedCertificate, match="its proof gives"):
            proven_bound(problem.instance, problem.options, certificate)
