"""Certificates prove what the exact planner claims, and nothing that is not so."""

import copy
import random
from time import perf_counter
from unittest.mock import patch

import msgspec
import pytest
from click.testing import CliRunner
from hypothesis import given, settings

from smash.cli.certify import command as certify_command
from smash.cli.verify import command as verify_command
from smash.planners.precedence import PrecedencePlanner
from smash.planners.precedence.certify import certify
from smash.planners.protocol import SolveOptions
from smash.problem import (
    MalformedFile,
    OnGoal,
    Pick,
    Place,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    Topple,
    make_instance,
    write_instance,
    write_plan,
)
from smash.problem.certificate import (
    ONE,
    Cases,
    Certificate,
    Leaf,
    RefusedCertificate,
    certificate_text,
    proven_bound,
    why_not_certified,
)
from smash.problem.errors import Unsupported
from smash.problem.files.instances import instance_from_document
from smash.problem.plan import Plan
from smash.problem.problem import Problem
from tests.arrangements import wide
from tests.oracle import optimal_cost
from tests.strategies import instances, plan_options


def certificate_of(instance, options, seconds=20.0):
    """Return the certificate as it is read back from its file."""
    text = certificate_text(certify(Problem(instance, options), perf_counter() + seconds))
    return msgspec.json.decode(text, type=Certificate)


def planners_bound(instance, options, seconds):
    """Return the planner's bound without the argument that certificates do not know: where blocks wait."""
    with patch("smash.planners.precedence.bound.waits_decide", return_value=False):
        asked = SolveOptions(options.topple, options.max_topple)
        return PrecedencePlanner().solve(instance, asked, seconds).lower_bound


@settings(max_examples=80, deadline=None)
@given(instances(max_blocks=7), plan_options())
def test_the_certificate_proves_the_planners_bound(instance, options):
    if Problem(instance, options).infeasible is not None:
        return
    proven = proven_bound(instance, options, certificate_of(instance, options))
    assert proven == planners_bound(instance, options, 10.0)


@pytest.mark.parametrize("topple", [True, False])
def test_a_gap_of_the_relaxation_is_closed_by_cases(topple):
    kinds = set()
    for seed in range(10 if topple else 3):
        instance = wide(40, 14, seed) if topple else wide(60, 6, seed)
        options = PlanOptions(topple, 2 if topple else None)
        certificate = certificate_of(instance, options)
        assert proven_bound(instance, options, certificate) == planners_bound(instance, options, 20.0)
        kinds.add(type(certificate.proof))
    assert Leaf in kinds


def move_over():
    """Return two stacks that each move over as they are: without topple both upper blocks are put aside."""
    return make_instance(
        name="move over",
        blocks="abcd",
        stacks=["s1", "s2", "s3", "s4"],
        start={"s1": "ab", "s2": "cd"},
        goal=StacksGoal({"s3": ("a", "b"), "s4": ("c", "d")}),
    )


def test_the_arithmetic_can_be_followed_by_hand():
    options = PlanOptions(topple=False)
    certificate = Certificate(
        "smash-certificate/1",
        "move over",
        False,
        None,
        12,
        [["a"], ["b"], ["c"], ["d"]],
        Leaf([(1, 2 * ONE), (3, 2 * ONE)]),
    )
    with pytest.raises(RefusedCertificate, match="'a' need not come before"):
        proven_bound(move_over(), options, certificate)
    certificate.cycles = [["b"], ["d"]]
    certificate.proof = Leaf([(0, 2 * ONE), (1, 2 * ONE)])
    assert proven_bound(move_over(), options, certificate) == 12 == optimal_cost(move_over(), options)


def good():
    return Certificate(
        "smash-certificate/1", "move over", False, None, 12, [["b"], ["d"]], Leaf([(0, 2 * ONE), (1, 2 * ONE)])
    )


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"instance": "other"}, "is for instance"),
        ({"topple": True}, "topple options"),
        ({"bound": 14}, "its proof gives 12"),
        ({"cycles": [["b"], ["nobody"]]}, "not every block"),
        ({"cycles": [["b"], []]}, "not every block"),
        ({"cycles": [["b"], ["a", "c"]]}, "need not come before"),
        ({"proof": Leaf([(0, 3 * ONE), (1, 2 * ONE)])}, "weigh more than it costs"),
        ({"proof": Leaf([(0, -1)])}, "the weight -1"),
        ({"proof": Leaf([(2, 1)])}, "cycle 2"),
        ({"proof": Cases(["aside", "z"], Leaf([]), Leaf([]))}, "which is no choice"),
        ({"proof": Cases(["aside", "b"], Leaf([(1, 2 * ONE)]), Leaf([]))}, "its proof gives 8"),
    ],
)
def test_a_changed_certificate_is_refused(changes, words):
    assert proven_bound(move_over(), PlanOptions(topple=False), good()) == 12
    with pytest.raises(RefusedCertificate, match=words):
        proven_bound(move_over(), PlanOptions(topple=False), msgspec.structs.replace(good(), **changes))


def three_in_turn():
    """Return three blocks, p, q and r, each of which has to leave before the two others can be placed."""
    return make_instance(
        {"s1": "up", "s2": "vq", "s3": "zwr", "s4": ""},
        StacksGoal({"s1": ("z", "q"), "s2": ("w", "p"), "s4": ("u", "v", "r")}),
        name="three in turn",
        blocks="upvqzwr",
        buffers=2,
    )


def with_ranks(*ranks, proof=None, bound=18):
    """Return a certificate for `three_in_turn` without topple by ranks alone."""
    proof = proof or Leaf([(0, 2 * ONE)])
    return Certificate("smash-certificate/1", "three in turn", False, None, bound, [], proof, ranks=list(ranks))


def test_of_three_blocks_that_wait_for_each_other_two_are_put_aside():
    options = PlanOptions(topple=False)
    stated = with_ranks(["p", "q", "r"])
    read = msgspec.json.decode(certificate_text(stated), type=Certificate)
    assert read == stated
    assert proven_bound(three_in_turn(), options, read) == 18
    halves = Leaf([(number, ONE) for number in range(3)])
    pairs = with_ranks(["p", "q"], ["q", "r"], ["p", "r"], proof=halves)  # three, and costs are even
    assert proven_bound(three_in_turn(), options, pairs) == 18
    cases = Cases(["aside", "p"], Leaf([(0, 2 * ONE)]), Leaf([(0, 2 * ONE)]))
    assert proven_bound(three_in_turn(), options, with_ranks(["p", "q", "r"], proof=cases)) == 18
    assert "ranks" not in certificate_text(with_ranks())


@pytest.mark.parametrize(
    ("rank", "words"),
    [
        (["p", "p"], "rank 0"),
        (["p", "nobody"], "rank 0"),
        ([], "rank 0"),
        (["u", "p"], "its proof gives 14"),
        (["p", "q"], "its proof gives 16"),
    ],
)
def test_a_rank_says_no_more_than_is_so(rank, words):
    with pytest.raises(RefusedCertificate, match=words):
        proven_bound(three_in_turn(), PlanOptions(topple=False), with_ranks(rank))


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4), plan_options())
def test_no_rank_that_the_checker_accepts_is_above_the_optimum(instance, options):
    best = optimal_cost(instance, options)
    if best is None or not instance.blocks:
        return
    draw = random.Random(repr(instance))
    for _ in range(10):
        ranks = [draw.sample(instance.blocks, draw.randint(1, len(instance.blocks))) for _ in range(2)]
        ranks = [rank for rank in ranks if accepted(instance, options, [], [], [rank]) is not None]
        weights = [(number, draw.choice([1, 2]) * ONE) for number in range(len(ranks))]
        bound = accepted(instance, options, [], weights, ranks)
        assert bound is None or bound <= best


def test_cases_may_be_used_instead_of_weights():
    impossible = Leaf([(0, 100 * ONE)])
    certificate = good()
    certificate.proof = Cases(["aside", "b"], Leaf([(1, 2 * ONE)]), impossible)
    assert proven_bound(move_over(), PlanOptions(topple=False), certificate) == 12


@settings(max_examples=60, deadline=None)
@given(instances(max_blocks=4), plan_options())
def test_no_certificate_that_the_checker_accepts_is_above_the_optimum(instance, options):
    """Random cycles with random weights: whatever the checker lets through is a true bound."""
    best = optimal_cost(instance, options)
    if best is None:
        return
    draw = random.Random(repr(instance))
    for _ in range(30):
        cycles = [draw.sample(instance.blocks, draw.randint(1, len(instance.blocks))) for _ in instance.blocks]
        cycles = [cycle for cycle in cycles if accepted(instance, options, [cycle], [])]
        weights = [(number, draw.choice([1, 2]) * ONE) for number in range(len(cycles)) if draw.random() < 0.7]
        bound = accepted(instance, options, cycles, weights)
        assert bound is None or bound <= best


def accepted(instance, options, cycles, weights, ranks=()):
    """Return the bound of a certificate, or None where the checker refuses it; 0 is a bound."""
    certificate = Certificate(
        "smash-certificate/1", instance.name, options.topple, options.max_topple, -1, cycles, Leaf(weights)
    )
    certificate.ranks = list(ranks)
    with pytest.raises(RefusedCertificate) as refusal:
        proven_bound(instance, options, certificate)
    words = str(refusal.value)
    return int(words.rsplit(" ", 1)[1]) if "its proof gives" in words else None


@pytest.mark.parametrize("goal", [StacksGoal({}), PositionsGoal({}), OnGoal({})])
def test_nothing_to_do_needs_no_cycle(goal):
    instance = make_instance(name="x", blocks=[], stacks=["s1"], start={}, goal=goal)
    assert proven_bound(instance, PlanOptions(), certificate_of(instance, PlanOptions())) == 0


def test_the_commands_certify_and_verify_a_plan(tmp_path):
    instance, options = move_over(), SolveOptions(topple=False)
    result = PrecedencePlanner().solve(instance, options, 10.0)
    files = [str(tmp_path / name) for name in ("instance.json", "plan.json", "proof.json")]
    write_instance(instance, files[0])
    write_plan(result.as_plan(instance, "precedence", options), files[1])
    run = CliRunner()
    assert "at least 12 actions" in run.invoke(certify_command, [*files[:2], "--out", files[2]]).output
    assert "no plan has fewer than its 12 actions" in run.invoke(verify_command, files).output
    (tmp_path / "proof.json").write_text((tmp_path / "proof.json").read_text().replace('"bound": 12', '"bound": 14'))
    ended = run.invoke(verify_command, files)
    assert isinstance(ended.exception, MalformedFile)
    assert ended.exception.exit_code == 3
    worse = copy.copy(result.as_plan(instance, "precedence", PlanOptions()))
    write_plan(worse, files[1])
    assert "topple options" in str(run.invoke(verify_command, files).exception)


def beyond(extra, **changes):
    document = {
        "format": "smash-instance/2",
        "name": "beyond",
        "blocks": ["a", "b", "c"],
        "stacks": ["s", "g"],
        "start": {"s": ["a", "b", "c"]},
        "goal": {"kind": "stacks", "stacks": {"g": ["a", "b", "c"]}},
    }
    return instance_from_document(document | extra | changes)


CARRIER = {"name": "t", "stations": ["x", "y"], "at": "x", "capacity": 2, "holds": ["c"]}


@pytest.mark.parametrize(
    ("extra", "words"),
    [
        ({"capacities": {"lift": 3}}, "plans may use lift"),
        ({"carriers": [CARRIER | {"holds": []}]}, "plans may use carry"),
        ({"costs": {"actions": {"topple": 2}}}, "its actions have costs"),
        ({"carriers": [CARRIER | {"stations": ["x"]}], "start": {"s": ["a", "b"]}}, "blocks start on a carrier"),
    ],
)
def test_nothing_is_proven_where_the_argument_does_not_reach(tmp_path, extra, words):
    instance = beyond(extra)
    options = PlanOptions(without=("carry",)) if "start" in extra and "carriers" in extra else PlanOptions()
    said = why_not_certified(instance, options)
    assert said is not None
    assert said.startswith(words)
    proof = Certificate("smash-certificate/1", "beyond", True, None, 7, [["c"]], Leaf([(0, 999_999)]))
    with pytest.raises(Unsupported, match=words):
        proven_bound(instance, options, proof)


def test_an_optimal_plan_without_a_bound_claims_its_cost(tmp_path):
    instance = make_instance({"s": ["a", "b"], "g": []}, StacksGoal({"g": ("a", "b")}), name="two", buffers=1)
    lifted = (Topple("s", 2), Pick("a", "s"), Place("a", "g"), Pick("b", "table"), Place("b", "g"))
    wasted = (Pick("b", "s"), Place("b", "s"), *lifted)
    weak = certificate_of(instance, PlanOptions())
    files = [tmp_path / name for name in ("instance.json", "plan.json", "proof.json")]
    write_instance(instance, files[0])
    write_plan(Plan("two", "liar", PlanOptions(), "optimal", wasted), files[1])
    files[2].write_text(certificate_text(weak))
    ended = CliRunner().invoke(verify_command, list(map(str, files)))
    assert ended.exit_code == 3
    write_plan(Plan("two", "honest", PlanOptions(), "optimal", lifted), files[1])
    assert CliRunner().invoke(verify_command, list(map(str, files))).exit_code == 0
