"""The flow without order: its least cost bounds every plan, its most actions hold every cheaper one."""

from hypothesis import assume, given, settings

from smash.planners.layered.network.moving import Moving
from smash.planners.layered.network.positions import build_network_positions
from smash.planners.layered.network.unordered import build_cheapest, build_longest
from smash.problem import Carrier, Costs, PlanOptions, PositionsGoal
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.planners.layered.made import NO_TOPPLE, optimum, priced, problem
from tests.strategies import family_instances, family_options


def cheapest(made):
    return optimum(build_cheapest(made, Moving.of(made)))


def most_actions(made, below):
    negated = optimum(build_longest(made, Moving.of(made), below))
    return None if negated is None else -negated


def test_every_block_that_leaves_or_is_placed_is_paid_for():
    assert cheapest(priced({"s": "ab"}, {"t": "ba"})) == 8
    assert cheapest(priced({"s": "ab"}, PositionsGoal({"a": ("t", 1)}), options=NO_TOPPLE)) == 8


def test_a_topple_is_counted_once_for_all_that_falls_and_by_its_cap():
    goal = PositionsGoal({"a": ("t", 1)})
    assert cheapest(priced({"s": "abc"}, goal)) == 4 + 1
    assert cheapest(priced({"s": "abc"}, goal, options=PlanOptions(max_topple=1))) == 4 + 2


def test_a_carry_is_counted_by_the_capacity():
    at = {"s": (0.0, 0.0), "near": (0.0, 0.0), "t": (9.0, 0.0), "far": (9.0, 0.0), "table": (0.0, 0.0)}
    costs = Costs(travel=1.0, positions=at)
    prices = []
    for capacity in (1, 2):
        tray = Carrier("tray", ("near", "far"), "near", capacity)
        made = problem({"s": "ab"}, {"t": "ba"}, carriers=(tray,), costs=costs, options=NO_TOPPLE)
        prices.append(cheapest(made))
    assert prices == [22, 18]  # by hand 11 each; on one tray 4 + 4 and a carry of 10


def test_where_no_edge_leads_home_there_is_no_flow():
    made = problem({"s": "ab"}, {"s": "ba"}, "s", options=NO_TOPPLE, capacities={"lift": 2})
    assert cheapest(made) is None


def test_nothing_cheaper_than_the_cheapest_has_actions():
    made = priced({"s": "ab"}, {"t": "ba"})
    assert most_actions(made, 8) is None
    assert most_actions(made, 9) == 2


@settings(max_examples=15, deadline=None)
@given(family_instances(max_blocks=2, max_stacks=2), family_options())
def test_it_bounds_the_cost_and_the_layers_of_a_cheapest_plan(instance, options):
    made, best = Problem(instance, options), cheapest_plan(instance, options)
    assume(best is not None and best[0] and not made.demands.met)
    assert cheapest(made) <= best[0]
    layers = most_actions(made, best[0] + 1)
    if layers <= 6:
        assert optimum(build_network_positions(made, layers, 0, None)) == best[0]
