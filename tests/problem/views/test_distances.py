"""Distances: what it costs at least to bring every block home."""

import math

from hypothesis import assume, given, settings

from smash.problem import TABLE, Carrier, Costs, Law, PlanOptions, PositionsGoal, State, make_instance
from smash.problem.views.distances import Distances, Estimate
from tests.cheapest import cheapest_plan
from tests.strategies import family_instances, family_options, instances, plan_options


@settings(max_examples=60, deadline=None)
@given(family_instances(max_blocks=3), family_options())
def test_the_estimate_of_the_start_is_no_more_than_the_cheapest_plan(instance, options):
    best = cheapest_plan(instance, options)
    assume(best is not None)
    assert Estimate(Law(instance, options)).of(State.start_of(instance)) <= best[0] + 1e-6


@settings(max_examples=40, deadline=None)
@given(instances(max_blocks=3), plan_options())
def test_along_a_cheapest_plan_the_estimate_never_exceeds_what_is_left(instance, options):
    best = cheapest_plan(instance, options)
    assume(best is not None)
    total, actions = best
    estimate, law = Estimate(Law(instance, options)), Law(instance, options)
    for spent, state in enumerate(law.states(actions)):
        if state.hand is None:
            assert estimate.of(state) <= total - spent + 1e-6


def row(costs=None, carriers=(), **more):
    return make_instance(
        name="x",
        blocks="ab",
        stacks=["s1", "s2"],
        buffers=["u1"],
        start={"s1": "ab"},
        goal=PositionsGoal({"a": ("s2", 1)}),
        costs=costs or Costs(),
        carriers=carriers,
        **more,
    )


def test_a_transfer_costs_a_pick_a_place_and_the_way():
    places = {"s1": (0.0, 0.0), "s2": (3.0, 4.0), "u1": (0.0, 1.0), TABLE: (1.0, 0.0)}
    distances = Distances(Law(row(Costs({"pick": 2}, 10, places)), PlanOptions(topple=False)))
    assert distances.between["s1", "s2"] == 2 + 1 + 50
    assert distances.away["s1"] == 2 + 1 + 10
    assert distances.back["s1"] == 2 * (2 + 1 + 10)
    assert distances.between["s1", "s1"] == 0


def test_nothing_but_a_topple_leads_to_the_table_region():
    assert Distances(Law(row(), PlanOptions(topple=False))).between["s1", TABLE] == math.inf
    assert Distances(Law(row(), PlanOptions(max_topple=1))).between["s1", TABLE] == 1
    assert Distances(Law(row(), PlanOptions(max_topple=2))).between["s1", TABLE] == 0.5


def test_a_carrier_on_which_nothing_may_be_put_is_no_way():
    carriers = [Carrier("tray", ("p", "q"), "p", 2)]
    with_carry = Distances(Law(row(carriers=carriers), PlanOptions()))
    without = Distances(Law(row(carriers=carriers), PlanOptions(without=("carry",))))
    assert with_carry.between["s1", "p"] == 2
    assert without.between["s1", "p"] == math.inf


def test_the_estimate_adds_up_what_has_to_move():
    # with topple b only has to leave s1 (half of a topple of two); a moves by a pick and a place; without it both do
    assert Estimate(Law(row(), PlanOptions())).of(State.start_of(row())) == 2.5
    assert Estimate(Law(row(), PlanOptions(topple=False))).of(State.start_of(row())) == 4
