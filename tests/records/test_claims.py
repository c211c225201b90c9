"""Claims against plans: across planners, variants, buffers and caps, and against start and goal."""

import pytest

from smash.problem.files.instances import instance_document, instance_from_document
from smash.problem.model import PlanOptions
from smash.problem.problem import Problem
from smash.problem.sets.suites import read_suite
from smash.records.believing import believed
from smash.records.claims import Posed
from smash.records.runs import RunRecord, instance_hash
from tests.analysis.made_up import document, record

FILED = instance_from_document(document(0, "i0", 2))


NO_PLAN = {"label": "liar", "status": "infeasible", "outcome": "infeasible"}


def posed(buffers=2, topple=True, cap=None, without=()):
    return Posed.of(Problem(FILED).with_buffers(buffers).instance, PlanOptions(topple, cap, without=without))


@pytest.mark.parametrize(
    ("wide", "narrow"),
    [
        ({}, {"topple": False}),
        ({}, {"cap": 3}),
        ({"cap": 3}, {"cap": 2}),
        ({"cap": 1}, {"topple": False}),
        ({"buffers": 2}, {"buffers": 0}),
        ({"buffers": 2}, {"buffers": 1, "topple": False}),
        ({}, {"without": ("lift",)}),
    ],
)
def test_what_allows_more_includes_what_allows_less_and_not_the_other_way(wide, narrow):
    assert posed(**wide).includes(posed(**narrow))
    assert not posed(**narrow).includes(posed(**wide))


def test_more_buffers_and_fewer_topples_include_neither():
    assert not posed(buffers=2, topple=False).includes(posed(buffers=0))
    assert not posed(buffers=0).includes(posed(buffers=2, topple=False))


def test_where_ways_cost_a_buffer_elsewhere_is_another():
    far = document(0, "i0", 1)
    far["costs"]["positions"]["u1"] = [9.0, 0.0]
    assert not Posed.of(FILED, PlanOptions()).includes(Posed.of(instance_from_document(far), PlanOptions()))


def proof(cost, label="liar", **more):
    return record(0, [(1.0, cost)], label=label, status="optimal", outcome="optimal", **more)


@pytest.mark.parametrize(
    ("claim", "plan", "said"),
    [
        (proof(12), record(0, [(1.0, 10)]), "no plan is cheaper than 12, p has a plan of 10"),
        (record(0, label="liar", lower_bound=11), record(0, [(1.0, 10)]), "no plan is cheaper than 11, p has a plan"),
        (proof(12), record(0, [(1.0, 10)], variant="no-topple"), "a plan of 10 of multi-9/i0, no-topple, 0 buffers"),
        (proof(12, buffers=4), record(0, [(1.0, 10)], buffers=1), "a plan of 10 of multi-9/i0, topple, 1 buffers"),
        (
            proof(12, variant="max-topple-4", max_topple=4),
            record(0, [(1.0, 10)], variant="max-topple-2", max_topple=2),
            "a plan of 10 of multi-9/i0, max-topple-2, 0 buffers",
        ),
        (
            record(0, **NO_PLAN),
            record(0, [(1.0, 10)]),
            "there is no plan",
        ),
        (record(0, **NO_PLAN), record(1), "start and goal show that"),
    ],
)
def test_a_false_claim_is_named_and_every_proof_of_its_planner_left_out(claim, plan, said):
    other = record(2, [(1.0, 8)], label="liar", status="optimal", outcome="optimal")
    found = believed([claim, plan, other])
    (line,) = map(str, found.contradictions)
    assert line.startswith("multi-9/i0, ")
    assert said in line
    for run in found.records:
        assert (run.status, run.lower_bound) in (("feasible", None), ("unknown", None))
    assert found.records[1] == plan


@pytest.mark.parametrize(
    ("claim", "plan"),
    [
        (proof(10), record(0, [(1.0, 10)])),
        (proof(12, variant="no-topple"), record(0, [(1.0, 10)])),
        (proof(12, buffers=0), record(0, [(1.0, 10)], buffers=4)),
        (proof(12), record(1, [(1.0, 10)])),
    ],
)
def test_planners_that_agree_contradict_nothing(claim, plan):
    found = believed([claim, plan])
    assert not list(found.lines())
    assert found.records[0].lower_bound == claim.cost


def test_where_nothing_decides_it_that_there_is_no_plan_is_a_claim_of_its_planner():
    stuck = {**document(0, "i0", 0), "capacities": {"lift": 2}, "stacks": ["s1", "s2"]}
    del stuck["costs"]
    claim = {"label": "someone", "status": "infeasible", "outcome": "infeasible", "stacks": 2}
    claim |= {"topple": False, "variant": "no-topple", "instance_document": stuck}
    made = instance_from_document(stuck)
    found = believed([record(0, **claim, instance_hash=instance_hash(made))])
    assert not found.contradictions
    assert [line for line in found.lines() if line.startswith("not decided")] == [
        "not decided: multi-9/i0, no-topple, 0 buffers: someone says that there is no plan"
    ]


@pytest.mark.parametrize(
    ("fields", "why"),
    [
        ({"cost": 9}, "its incumbents cost [10], its plan 9"),
        ({"incumbents": [(1.0, 9, "milp")], "cost": 9}, "its cost says 9"),
        ({"incumbents": [(1.0, 8, "milp"), (2.0, 10, "milp")]}, "its incumbents cost [8, 10]"),
        ({"actions": [["pick", "a0", "s2"]]}, "refused at step 1"),
        ({"variant": "no-topple"}, "its variant is 'no-topple', its options say otherwise"),
        ({"buffers": 3}, "`buffers` says 3, its instance 0"),
        ({"instance_hash": "0"}, "its instance does not fit its hash"),
        ({"instance_document": {}}, "`format`"),
        ({"outcome": "optimal"}, "its outcome is optimal, its status feasible"),
        ({"lower_bound": 11}, "lower bound 11"),
    ],
)
def test_a_record_that_cannot_be_true_counts_as_refused(fields, why):
    plain = record(0, [(1.0, 10)])
    changed = type(plain)(**{name: getattr(plain, name) for name in plain.__struct_fields__} | fields)
    (run,) = believed([changed]).records
    assert run.outcome == "refused"
    assert why in run.reason
    assert run.trace == []


def test_a_plan_for_seconds_may_have_more_actions_than_the_planner_had_found():
    of_ten = record(0, [(0.1, 12), (1.0, 10)])
    fields = {name: getattr(of_ten, name) for name in of_ten.__struct_fields__}
    incumbents = [(0.1, 12, "milp"), (1.0, 8, "milp")]
    weighed, counted = (
        type(of_ten)(**fields | {"incumbents": incumbents, "objective": objective})
        for objective in ("seconds", "actions")
    )
    assert [run.outcome for run in believed([weighed]).records] == [of_ten.outcome]
    assert weighed.trace == [(0.1, 12), (1.0, 10)]
    assert [run.outcome for run in believed([counted]).records] == ["refused"]


def test_committed_instances_pose_what_they_are():
    for instance in read_suite("multi-4")[:3]:
        assert Posed.of(instance, PlanOptions()) == Posed.of(
            instance_from_document(instance_document(instance)), PlanOptions()
        )


def test_records_are_typed():
    assert isinstance(believed([record(0)]).records[0], RunRecord)
