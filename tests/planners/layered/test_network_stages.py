"""The methods on the network of places: bounds without order, relaxations with and without it, positions."""

from time import perf_counter

import pytest
from hypothesis import assume, given, settings

from smash.planners.layered.network.moving import Moving
from smash.planners.layered.network.relaxed import build_relaxed
from smash.planners.layered.network.stages import NetworkStages
from smash.planners.protocol import Settings, SolveLog
from smash.problem import Carrier, Costs
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.planners.layered.made import NO_TOPPLE, priced, problem
from tests.strategies import family_instances, family_options

SECONDS = 60.0
"""More than any of these models takes."""

TURNED = {"s": "abc"}, {"t": "acb"}
EXCHANGE = priced({"s": "a", "t": "b"}, {"s": "b", "t": "a"}, buffers="u", options=NO_TOPPLE)
"""12 in truth: one of the two blocks is put aside. 8 without order."""
ONE_BUFFER = priced(*TURNED, buffers="u", options=NO_TOPPLE)
"""24 in truth; 20 where b and c may leave u in any order."""
TWO_BUFFERS = priced(*TURNED, buffers="u v", options=NO_TOPPLE)
"""20 in truth, 12 without order."""


def ran(method, made, horizon=None, *, known=False):
    """Run one method, with a cheapest plan known or none; return the log and what was solved (model, horizon)."""
    log = SolveLog(made)
    if known:
        log.offer(cheapest_plan(made.instance, made.options)[1], "known")
    stages = NetworkStages(made, Settings(horizon=horizon))
    getattr(stages, method)(made, log, perf_counter() + SECONDS)
    return log, [(stage["model"], stage.get("horizon")) for stage in log.details["stages"]]


def judge(log, best):
    """Hold a log to uniform-cost search."""
    if best is None:
        assert log.cost is None
        return
    assert log.refuted is None
    assert log.bound is None or log.bound <= best[0]
    assert log.cost is None or log.cost >= best[0]


@pytest.mark.parametrize(("made", "bound", "best"), [(EXCHANGE, 8, 12), (ONE_BUFFER, 12, 24), (TWO_BUFFERS, 12, 20)])
def test_the_flow_bounds_and_gives_no_plan(made, bound, best):
    log, _ = ran("flow", made)
    assert cheapest_plan(made.instance, made.options)[0] == best
    assert (log.cost, log.bound, log.bound_origin) == (None, bound, "layered flow without order")


def test_where_there_is_no_flow_there_is_no_plan():
    made = problem({"s": "ab"}, {"s": "ba"}, "s", options=NO_TOPPLE, capacities={"lift": 2})
    log, _ = ran("flow", made)
    assert cheapest_plan(made.instance, made.options) is None
    assert (log.refuted, log.bound) == ("layered flow without order", None)


def test_the_relaxation_gives_a_plan_at_the_short_horizon_and_the_proof_at_one_that_holds_all_cheaper_ones():
    log, solved = ran("relaxations", EXCHANGE)
    assert (log.cost, log.bound, log.bound_origin) == (12, 12, "layered relaxation at a horizon of 2")
    assert solved == [("relaxation", 3), ("most actions", None), ("relaxation", 2)]


def test_the_order_is_added_where_a_solution_without_it_is_no_plan():
    log, solved = ran("relaxations", ONE_BUFFER)
    assert (log.cost, log.bound, log.bound_origin) == (24, 24, "layered ordered relaxation at a horizon of 7")
    assert [model for model, _ in solved if model != "most actions"] == ["relaxation", "ordered relaxation"]
    assert any("the top of 'u' is 'b'" in refusal for refusal in log.refusals)


@pytest.mark.parametrize(("made", "horizon"), [(ONE_BUFFER, 2), (ONE_BUFFER, 4), (TWO_BUFFERS, 3), (EXCHANGE, 1)])
def test_a_chosen_horizon_that_is_too_short_for_cheaper_plans_proves_nothing(made, horizon):
    for method in ("relaxations", "positions"):
        log, solved = ran(method, made, horizon, known=True)
        assert (log.bound, log.refuted) == (None, None)
        assert {at for _, at in solved} == {None, horizon}


def test_a_chosen_horizon_is_solved_once_and_without_a_plan_proves_nothing():
    log, solved = ran("relaxations", EXCHANGE, 3)
    assert solved == [("relaxation", 3)]
    assert (log.cost, log.bound) == (12, None)


def test_a_number_of_layers_that_is_enough_is_worked_out_once_a_cost():
    log, solved = ran("relaxations", ONE_BUFFER, known=True)
    assert [model for model, _ in solved] == ["most actions", "relaxation", "ordered relaxation"]
    assert log.bound == 24


def test_nothing_cheaper_without_order_is_a_proof():
    made = priced({"s": "ab"}, {"s": "ba"}, "s", buffers="u v", options=NO_TOPPLE)
    log, _ = ran("positions", made, known=True)
    assert (log.bound, log.bound_origin) == (16, "layered flow without order")


@pytest.mark.parametrize("made", [EXCHANGE, ONE_BUFFER, TWO_BUFFERS])
def test_positions_prove_the_cheapest_plan(made):
    log, solved = ran("positions", made, known=True)
    assert log.bound == log.cost
    assert log.bound_origin == f"layered positions at a horizon of {solved[-1][1]}"


def test_the_short_horizon_has_a_layer_more_for_carries():
    at = {"s": (0.0, 0.0), "near": (0.0, 0.0), "t": (9.0, 0.0), "far": (9.0, 0.0), "table": (0.0, 0.0)}
    tray = Carrier("tray", ("near", "far"), "near", 2)
    more = {"costs": Costs(travel=1.0, positions=at), "options": NO_TOPPLE}
    carried = problem({"s": "ab"}, {"t": "ba"}, carriers=(tray,), **more)
    by_hand = problem({"s": "ab"}, {"t": "ba"}, costs=Costs({"pick": 3}), options=NO_TOPPLE)
    assert [NetworkStages(made, Settings()).short for made in (carried, by_hand)] == [2 + 2 + 2, 2 + 2 + 1]


@pytest.mark.parametrize(("horizon", "layers"), [(None, 3), (4, 4)])
def test_the_first_model_is_the_relaxation_at_the_chosen_horizon_or_the_short_one(horizon, layers):
    model = NetworkStages(EXCHANGE, Settings(horizon=horizon)).first_model()
    assert model.milp.size() == build_relaxed(EXCHANGE, Moving.of(EXCHANGE), layers).milp.size()


@settings(max_examples=10, deadline=None)
@given(family_instances(max_blocks=2, max_stacks=2), family_options())
def test_method_by_method_nothing_false_is_proven(instance, options):
    made = Problem(instance, options)
    assume(not made.solved and made.infeasible is None and not made.demands.met)
    best = cheapest_plan(instance, options)
    judge(ran("flow", made)[0], best)
    for horizon in (None, 2):
        judge(ran("relaxations", made, horizon, known=best is not None)[0], best)
    judge(ran("positions", made, 2, known=best is not None)[0], best)
