"""The aggregating actions beside topple, carriers and costs: what the law says of them, and their files."""

from dataclasses import replace

import pytest

from smash.problem import (
    TABLE,
    Carrier,
    Carry,
    Costs,
    IllegalAction,
    Law,
    Lift,
    MalformedFile,
    Pick,
    Place,
    Plan,
    PlanOptions,
    PositionsGoal,
    State,
    Topple,
    check_plan,
    make_instance,
)
from smash.problem.files.instances import instance_document, instance_from_document
from smash.problem.files.plans import plan_document, plan_from_document
from tests.cheapest import cheapest_plan

TRAY = Carrier("tray", ("left", "right"), "left", 2)
COSTS = Costs(
    {"pick": 10, "place": 10, "topple": 15, "carry": 20, "lift": 25},
    100.0,
    {"s1": (0, 0), "s2": (0, 0.1), "g1": (1, 0), "g2": (1, 0.1), TABLE: (0, 0.3), "left": (0, 0.2), "right": (1, 0.2)},
    "ms",
)


def scoop(**changes):
    """Two piles on the left, whose bottom blocks have to go to the right; a tray for two."""
    arguments = {
        "name": "scoop",
        "blocks": ["a", "b", "c", "d"],
        "stacks": ["s1", "s2", "g1", "g2"],
        "start": {"s1": ["a", "b"], "s2": ["c", "d"]},
        "goal": PositionsGoal({"a": ("g1", 1), "c": ("g2", 1)}),
        "carriers": [TRAY],
        "capacities": {"lift": 2},
        "costs": COSTS,
    }
    return make_instance(**arguments | changes)


SCOOPED = (
    Topple("s1", 2),
    Topple("s2", 2),
    *(Pick("a", "s1"), Place("a", "tray"), Pick("c", "s2"), Place("c", "tray")),
    Carry("tray", "right"),
    *(Pick("a", "tray"), Place("a", "g1"), Pick("c", "tray"), Place("c", "g2")),
)


def test_a_carrier_takes_what_is_on_it_along():
    law = Law(scoop())
    *_, last = law.states(SCOOPED)
    assert last.stations == {"tray": "right"}
    assert law.check(SCOOPED).accepted


def test_travel_is_paid_for_the_way_of_the_blocks_and_of_the_carrier():
    short = [round(100 * 0.2), round(100 * 0.1), round(100 * 0.2), round(100 * 0.1)]
    assert Law(scoop()).check(SCOOPED).cost == 2 * 15 + 8 * 10 + sum(short) + 20 + 100
    assert Law(scoop()).price(SCOOPED) == Law(scoop()).check(SCOOPED).cost


def test_without_costs_every_action_counts_one():
    assert Law(scoop(costs=Costs())).check(SCOOPED).cost == len(SCOOPED)


@pytest.mark.parametrize(
    ("action", "reason"),
    [
        (Carry("tray", "left"), "'tray' stands at 'left'"),
        (Carry("tray", "s1"), "no station"),
        (Carry("bowl", "right"), "no carrier"),
        (Lift("s1", 1, "s1"), "another location"),
        (Lift("s1", 3, "s2"), "no block is lifted"),
        (Lift("s1", 1, "nowhere"), "no location"),
        (Pick("a", "tray"), "not on 'tray'"),
    ],
)
def test_the_law_refuses(action, reason):
    law = Law(scoop())
    assert reason in law.refusal(State.start_of(law.instance), action)


def test_a_full_carrier_takes_no_more():
    instance = scoop(carriers=[Carrier("tray", ("left", "right"), "left", 1)])
    law, state = Law(instance), State.start_of(instance)
    law.apply(state, Pick("b", "s1"))
    law.apply(state, Place("b", "tray"))
    law.apply(state, Pick("a", "s1"))
    with pytest.raises(IllegalAction, match="full"):
        law.apply(state, Place("a", "tray"))


def test_a_lift_keeps_the_order_and_its_capacity():
    law = Law(scoop(capacities={"lift": 1}))
    state = State.start_of(law.instance)
    assert "the capacity is 1" in law.refusal(state, Lift("s1", 1, "s2"))
    law = Law(scoop())
    law.apply(state, Lift("s1", 1, "s2"))
    assert state.piles["s2"] == ["c", "d", "a", "b"]


def test_what_is_left_out_is_not_allowed():
    law = Law(scoop(), PlanOptions(without=("carry", "lift")))
    state = State.start_of(law.instance)
    assert law.refusal(state, Carry("tray", "right")) == "carry is not allowed"
    assert law.refusal(state, Lift("s1", 1, "s2")) == "lift is not allowed"
    law.apply(state, Pick("b", "s1"))
    assert "carry is not allowed" in law.refusal(state, Place("b", "tray"))
    assert "the instance has no lift" in Law(scoop(capacities={})).refusal(state, Lift("s1", 1, "s2"))


@pytest.mark.parametrize("options", [PlanOptions(), PlanOptions(False, without=("carry",)), PlanOptions(True, 1)])
def test_legal_actions_are_those_that_the_law_does_not_refuse(options):
    law = Law(scoop(), options)
    state = State.start_of(law.instance)
    places = [*law.instance.locations, "tray"]
    every = [Pick(b, s) for b in law.instance.blocks for s in [*places, TABLE]]
    every += [Topple(s, h) for s in places for h in (1, 2, 3)]
    every += [Carry("tray", s) for s in ("left", "right")]
    every += [Lift(s, h, t) for s in places for h in (1, 2, 3) for t in places]
    assert set(law.legal_actions(state)) == {action for action in every if law.refusal(state, action) is None}


def test_files_of_version_2_come_back():
    instance = scoop()
    document = instance_document(instance)
    assert document["format"] == "smash-instance/2"
    assert instance_from_document(document) == instance
    plan = Plan("scoop", "me", PlanOptions(without=("lift",)), "feasible", SCOOPED, stated_cost=290)
    assert plan_document(plan)["format"] == "smash-plan/2"
    assert plan_from_document(plan_document(plan)) == plan
    assert check_plan(instance, plan).accepted


def test_what_version_1_can_say_is_written_in_version_1():
    instance = scoop(carriers=[], capacities={}, costs=Costs())
    assert instance_document(instance)["format"] == "smash-instance/1"
    assert plan_document(Plan("x", "me", PlanOptions(), "feasible", (Topple("s1", 1),)))["format"] == "smash-plan/1"


def test_a_stated_cost_that_is_not_the_plans_is_refused():
    plan = Plan("scoop", "me", PlanOptions(), "feasible", SCOOPED, stated_cost=len(SCOOPED))
    assert "its cost says 11, what its actions cost is 290" in check_plan(scoop(), plan).reason


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"carriers": [Carrier("s1", ("left",), "left", 1)]}, "'s1' stands twice"),
        ({"carriers": [Carrier("tray", ("left",), "right", 1)]}, "not one of its stations"),
        ({"carriers": [Carrier("tray", ("left",), "left", 0)]}, "1 and more"),
        ({"carriers": [Carrier("tray", ("left", "right"), "left", 1, ("a",))]}, "'a' stands twice"),
        ({"capacities": {"topple": 2}}, "one of lift"),
        ({"capacities": {"lift": 0}}, "1 and more"),
        ({"costs": Costs({"fly": 1})}, "'fly' is not allowed"),
        ({"costs": Costs({"pick": 0})}, "1 to 1,000,000"),
        ({"costs": Costs(travel=1.0)}, "is missing"),
        ({"costs": Costs(travel=float("nan"))}, "0 to 1,000,000"),
        ({"costs": Costs(positions={"s1": (float("inf"), 0)})}, "two numbers from -1000 to 1000"),
        ({"costs": Costs(positions={"moon": (0, 0)})}, "'moon' is no place"),
    ],
)
def test_a_malformed_addition_is_refused_in_one_line(changes, words):
    with pytest.raises(MalformedFile) as refused:
        scoop(**changes)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_the_scoop_pays_where_distance_counts_and_only_there():
    small = {"blocks": ["a", "c"], "start": {"s1": ["a"], "s2": ["c"]}, "capacities": {}}
    far = scoop(**small, costs=replace(COSTS, travel=300.0))
    with_tray = cheapest_plan(far)
    without = cheapest_plan(far, PlanOptions(without=("carry",)))
    assert with_tray[0] < without[0]
    assert Carry("tray", "right") in with_tray[1]
    assert cheapest_plan(scoop(**small, costs=Costs()))[0] == 4
