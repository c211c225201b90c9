"""The network of places: which edges there are, and what each costs."""

from smash.planners.layered.network.places import NO_EDGE, Places, free
from smash.problem import Carrier, Carry, Costs, PlanOptions
from smash.problem.model import TABLE
from tests.planners.layered.made import problem

TRAY = Carrier("tray", ("near", "far"), "far", 2)
AT = {"s": (0.0, 0.0), "t": (3.0, 4.0), "near": (0.0, 1.0), "far": (3.0, 1.0), TABLE: (6.0, 8.0)}
COSTS = Costs({"pick": 2, "carry": 5, "lift": 7, "topple": 4}, 1.0, AT)


def network(**options):
    made = problem(
        {"s": "a"}, {"t": "a"}, carriers=(TRAY,), capacities={"lift": 2}, costs=COSTS, options=PlanOptions(**options)
    )
    return Places.of(made)


def test_places_are_locations_then_decks_then_the_table_region():
    places = network()
    assert [places.source(number) for number in range(places.count)] == ["s", "t", "tray", "tray", TABLE]
    assert places.inside == slice(2, 4)
    assert places.table == 4


def test_a_transfer_costs_a_pick_a_place_and_the_way():
    transfer = network().transfer
    assert transfer[0, 1] == 2 + 1 + 5
    assert transfer[4, 0] == 2 + 1 + 10
    assert transfer[0, 2] == 2 + 1 + 1


def test_nothing_is_placed_on_the_table_nor_where_it_comes_from():
    transfer = network().transfer
    assert (transfer[:, 4] == NO_EDGE).all()
    assert (transfer.diagonal() == NO_EDGE).all()
    assert transfer[2, 3] == transfer[3, 2] == NO_EDGE  # one carrier is at one station at a time


def test_carries_and_lifts_cost_an_activation_and_the_way():
    places = network()
    assert places.carry.tolist() == [[NO_EDGE, 8], [8, NO_EDGE]]
    assert places.lift.tolist() == [[NO_EDGE, 12], [12, NO_EDGE]]
    assert (places.topple, places.toppled, places.lifted) == (4, 2, 2)


def test_what_is_not_allowed_has_no_edge():
    places = network(topple=False, without=("carry", "lift"))
    assert (places.carry == NO_EDGE).all()
    assert (places.lift == NO_EDGE).all()
    assert (places.transfer[:, 2:4] == NO_EDGE).all()
    assert places.transfer[2, 0] >= 0  # what a carrier holds is picked off it
    assert (places.toppled, places.lifted) == (0, 0)


def test_a_carrier_starts_at_one_deck_and_goes_to_another():
    places = network()
    assert [(number, carrier.name) for number, carrier in places.occupied()] == [(1, "tray")]
    assert places.carry_to(0) == Carry("tray", "near")


def test_free_edges_are_where_priced_ones_are():
    places = network()
    assert (free(places.carry) >= 0).tolist() == (places.carry >= 0).tolist()
    assert set(free(places.carry).ravel().tolist()) == {0, NO_EDGE}
