"""Certificates that choose the places of towers: they never claim too much, and nothing in them can be changed."""

import contextlib
import copy
import itertools
import math
import random
from time import perf_counter

import msgspec
import numpy as np
import pytest

from smash.experiments.best_known.standing import open_instances
from smash.planners.milp.arrays import MilpBuilder
from smash.planners.milp.solvers import highs
from smash.planners.precedence.certify import certify
from smash.problem import OnGoal, PlanOptions, StacksGoal, make_instance
from smash.problem.certificate import Certificate, Leaf, certificate_text, proven_bound
from smash.problem.certificate_places import ONE, ConditionalCycle, NamedCases, NamedLeaf, PlacesChecker
from smash.problem.errors import RefusedCertificate
from smash.problem.problem import Problem
from tests.oracle import optimal_cost
from tests.relations import related

NO_TOPPLE = PlanOptions(topple=False)


def read_back(certificate):
    """Return a certificate as it is read from its file."""
    return msgspec.json.decode(certificate_text(certificate), type=Certificate)


@pytest.mark.parametrize("hundred", range(4))
def test_no_plan_is_cheaper_than_what_is_certified(hundred):
    chosen = 0
    for seed in range(100 * hundred, 100 * hundred + 100):
        problem = related(seed, hand=0.1, stacks=2)
        if problem.infeasible is None:
            certificate = read_back(certify(problem, math.inf))
            bound = proven_bound(problem.instance, problem.options, certificate)
            assert bound == certificate.bound <= optimal_cost(problem.instance, problem.options)
            chosen += certificate.places is not None or any(first.places for first in certificate.first_places)
    assert chosen


def two_bottoms():
    """To be at a bottom c needs the place of two blocks, or that of three."""
    goal = OnGoal({}, ("a", "c"))
    return make_instance(
        {"s1": "abc", "s2": "de", "s3": "fgh"}, goal, name="two bottoms", blocks="abcdefgh", stacks=["s1", "s2", "s3"]
    )


def in_the_way():
    """Wherever c and b go with one location free, one of them cannot move directly."""
    return make_instance(
        {"s1": "acb"}, OnGoal({"a": "b"}, ("c",)), name="in the way", blocks="abc", stacks=["s1", "s2"]
    )


def towers_in_turn():
    """Neither c on d nor a on b has to be at a bottom, and on two locations neither can wait for the other."""
    goal = OnGoal({"c": "d", "a": "b"})
    return make_instance({"s1": "c", "u1": "adb"}, goal, name="in turn", blocks="abcd", stacks=["s1"], buffers=["u1"])


@pytest.mark.parametrize(
    ("instance", "options"),
    [
        (two_bottoms(), PlanOptions()),
        (two_bottoms(), NO_TOPPLE),
        (in_the_way(), PlanOptions(max_topple=2)),
        (towers_in_turn(), PlanOptions()),
    ],
)
def test_what_the_cycles_alone_do_not_see_is_certified(instance, options):
    certificate = read_back(certify(Problem(instance, options), math.inf))
    assert certificate.places is not None
    assert certificate.cycles == []
    assert certificate.proof == Leaf([])
    assert proven_bound(instance, options, certificate) == optimal_cost(instance, options)


def test_where_the_cycles_prove_as_much_the_file_has_no_places():
    goal = OnGoal({}, ("a", "b"))
    instance = make_instance({"s1": ("a", "b")}, goal, name="x", blocks="ab", stacks=["s1", "s2"])
    assert "places" not in certificate_text(certify(Problem(instance), math.inf))


OPEN = "open-on-01", PlanOptions(max_topple=4)


def open_certificate():
    """Return an open problem that the cycles do not settle, and its certificate."""
    instance = open_instances()[OPEN[0]]
    return instance, read_back(certify(Problem(instance, OPEN[1]), perf_counter() + 60))


def test_an_open_problem_is_certified_to_its_optimum():
    instance, certificate = open_certificate()
    assert certificate.places is not None
    assert proven_bound(instance, OPEN[1], certificate) == 31  # the cost in results/best-known/best-known.csv


def leaves(proof):
    """Yield the leaves of a tree of cases."""
    if isinstance(proof, NamedLeaf):
        yield proof
    else:
        yield from leaves(proof.taken)
        yield from leaves(proof.untaken)


def refused(instance, options, certificate, words):
    """Assert that a certificate is refused, and with which words."""
    with pytest.raises(RefusedCertificate, match=words):
        proven_bound(instance, options, certificate)


def test_no_condition_of_a_cycle_can_be_left_out():
    instance, certificate = open_certificate()
    tried = 0
    for number, cycle in enumerate(certificate.places.cycles):
        for condition in cycle.given:
            changed = copy.deepcopy(certificate)
            changed.places.cycles[number].given.remove(condition)
            refused(instance, OPEN[1], changed, f"cycle {number}: (.* need not be|all of its events)")
            tried += 1
    assert tried


def test_a_wrong_cycle_is_refused():
    instance, certificate = open_certificate()
    for number, cycle in enumerate(certificate.places.cycles):
        if len(cycle.events) > 2:
            changed = copy.deepcopy(certificate)
            changed.places.cycles[number].events.reverse()
            refused(instance, OPEN[1], changed, f"cycle {number}: ")


@pytest.mark.parametrize(
    ("events", "given", "words"),
    [
        ([("removed", "c"), ("placed", "c")], [], "cycle 0: all of its events may be one"),
        ([], [], "cycle 0: all of its events may be one"),
        ([("removed", "x")], [], "cycle 0: 'x' need not be removed"),
        ([("lifted", "c")], [], "cycle 0: 'c' need not be lifted"),
        ([("removed", "a"), ("removed", "c")], [], "cycle 0: 'a' need not be removed"),
        ([("removed", "a"), ("removed", "c")], [["removed", "a"]], "cycle 0: 'a' need not be removed before 'c'"),
        ([("removed", "d"), ("placed", "c")], [["at", "c", "s1"]], "cycle 0: 'd' need not be removed"),
        ([("removed", "c"), ("placed", "c")], [["at", "c", "s9"]], "cycle 0: .* is no condition"),
        ([("removed", "c"), ("placed", "c")], [["under", "a", "c"]], "cycle 0: .* is no condition"),
        ([("removed", "c"), ("placed", "c")], [["stays", "c"]], "cycle 0: .* is no condition"),
    ],
)
def test_what_is_no_cycle_is_refused(events, given, words):
    certificate = read_back(certify(Problem(two_bottoms(), NO_TOPPLE), math.inf))
    certificate.places.cycles[:0] = [ConditionalCycle(events, given)]
    refused(two_bottoms(), NO_TOPPLE, certificate, words)


def test_a_weight_that_is_raised_proves_less():
    instance, certificate = open_certificate()
    for number, leaf in enumerate(leaves(certificate.places.proof)):
        for row in range(len(leaf.rows)):
            changed = copy.deepcopy(certificate)
            rows = list(leaves(changed.places.proof))[number].rows
            name, weight = rows[row]
            rows[row] = (name, weight + 100 * ONE)
            refused(instance, OPEN[1], changed, "it states the bound 31, its proof gives")


@pytest.mark.parametrize(
    ("name", "weight", "words"),
    [
        (["floor", "s1"], -ONE, "the weight -1000000"),
        (["floor", "s9"], ONE, "which is no row"),
        (["cycle", 99], ONE, "which is no row"),
        (["cycle", -1], ONE, "which is no row"),
        (["above", "a"], ONE, "which is no row"),
        (["falls", "a"], ONE, "which is no row"),
        (["place", "d"], ONE, "which is no row"),
        (["order", "a", "c", "s1"], ONE, "which is no row"),
        ([], ONE, "which is no row"),
    ],
)
def test_a_weight_is_on_a_row_and_not_negative(name, weight, words):
    certificate = read_back(certify(Problem(two_bottoms(), NO_TOPPLE), math.inf))
    next(leaves(certificate.places.proof)).rows.append((name, weight))
    refused(two_bottoms(), NO_TOPPLE, certificate, words)


def test_no_case_can_be_left_out():
    instance = open_instances()["open-on-01"]
    certificate = read_back(certify(Problem(instance, NO_TOPPLE), perf_counter() + 60))
    tree = certificate.places.proof
    assert isinstance(tree, NamedCases)
    for part in (tree.taken, tree.untaken, NamedCases(tree.choice, tree.untaken, tree.taken)):
        certificate.places.proof = part
        refused(instance, NO_TOPPLE, certificate, "it states the bound 44, its proof gives")
    certificate.places.proof = NamedCases(["under", "x", "y"], tree.taken, tree.untaken)
    refused(instance, NO_TOPPLE, certificate, "which is no choice")


def test_the_proof_of_another_instance_is_refused():
    certificate = read_back(certify(Problem(two_bottoms(), NO_TOPPLE), math.inf))
    goal = OnGoal({}, ("a", "c"))
    easier = make_instance(
        {"s1": "abc", "s2": "d", "s3": "fgh"}, goal, name="two bottoms", blocks="abcdfgh", stacks=["s1", "s2", "s3"]
    )
    refused(easier, NO_TOPPLE, certificate, "it states the bound 6|is no|need not be")
    refused(in_the_way(), NO_TOPPLE, certificate, "it is for instance")


def test_it_is_for_on_goals_and_stands_alone():
    certificate = read_back(certify(Problem(two_bottoms(), NO_TOPPLE), math.inf))
    other = make_instance({"s1": "a"}, StacksGoal({"s2": ["a"]}), name="two bottoms", blocks="a", stacks=["s1", "s2"])
    refused(other, NO_TOPPLE, certificate, "the goal is no `on` goal")
    certificate.cycles.append(["c"])
    refused(two_bottoms(), NO_TOPPLE, certificate, "beside that of its places")


def test_the_checker_finds_what_every_plan_costs():
    checker = PlacesChecker(two_bottoms(), NO_TOPPLE)
    assert checker.base == 2
    assert checker.costs["removed", "d"] == 2
    assert ("removed", "c") not in checker.costs


def test_it_is_cut_short_by_the_deadline():
    instance, options = two_bottoms(), PlanOptions()
    short = certify(Problem(instance, options), -math.inf)
    assert proven_bound(instance, options, short) == short.bound <= 3


def cheapest_of_all_rows(problem, draw, tried):
    """Return the least cost of values that fulfil the structure and every drawn cycle that the checker takes."""
    checker = PlacesChecker(problem.posed, problem.options)
    bases = [*checker.bottoms, *checker.loose]
    blocks = problem.instance.blocks
    pairs = list(itertools.permutations(checker.loose, 2))
    conditions = [["removed", b] for b in blocks] + [["stays", b] for b in blocks]
    conditions += [["at", b, q] for b in bases for q in checker.piles] + [["under", *pair] for pair in pairs]
    rows = [checker.row(("place", b)) for b in bases] + [checker.row(("floor", q)) for q in checker.piles]
    rows += [checker.row(("order", *pair, q)) for pair in pairs for q in checker.piles]
    rows += [checker.row(("falls", b)) for b in checker.falls]
    rows += [checker.row(("above", b)) for (kind, b, *_) in checker.costs if kind == "removed" and checker.spot[b][1]]
    for _ in range(tried):
        events = [(draw.choice(["removed", "placed"]), draw.choice(blocks)) for _ in range(draw.randint(2, 4))]
        given = draw.sample(conditions, min(len(conditions), draw.randint(0, 3)))
        with contextlib.suppress(RefusedCertificate):
            rows.append(checker.cycle_row(0, ConditionalCycle(events, given)))
    keys = [*checker.costs, *(("under", *pair) for pair in pairs)]
    column = {key: number for number, key in enumerate(keys)}
    builder = MilpBuilder(math.inf)
    builder.add_columns(len(keys), cost=np.array([float(checker.cost(key)) for key in keys]))
    for row in {(row.least, tuple(row.signs.items())): row for row in rows}.values():
        columns = [column[key] for key in row.signs]
        builder.add_rows([0] * len(columns), columns, [float(s) for s in row.signs.values()], count=1, lower=row.least)
    solved = highs.solve(builder.build(), time_limit=60.0, seed=1)
    assert solved.status == "optimal"
    return checker.base + round(solved.bound)


@pytest.mark.parametrize("part", range(4))
def test_every_plan_fulfils_every_cycle_that_the_checker_takes(part):
    """Whoever writes a certificate: what is drawn at random and taken never asks for more than a cheapest plan does."""
    for seed in range(12 * part, 12 * part + 12):
        problem = related(seed, hand=0.0, stacks=2)
        if problem.infeasible is None and problem.posed.goal.on and len(problem.instance.blocks) > 1:
            assert cheapest_of_all_rows(problem, random.Random(seed), 1500) <= optimal_cost(
                problem.instance, problem.options
            ), seed
