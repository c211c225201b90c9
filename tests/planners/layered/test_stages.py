"""The methods on the contracted gadget: what a chosen horizon is too short for is never taken for a proof."""

import math

import pytest
from hypothesis import assume, given, settings

from smash.planners.greedy import greedy_plans
from smash.planners.layered import LayeredPlanner
from smash.planners.layered.blocks import MovingBlocks
from smash.planners.layered.events import build_layered
from smash.planners.layered.horizons import short_layers, sound_layers
from smash.planners.layered.stages import ContractedStages
from smash.planners.protocol import Settings, SolveLog
from smash.problem import OnGoal, PlanOptions, PositionsGoal
from smash.problem.problem import Problem
from smash.problem.sets.generators import generate
from tests.oracle import optimal_cost
from tests.planners.layered.made import NO_TOPPLE, problem, reversal
from tests.strategies import instances, plan_options


def drawn(blocks, buffers, topple):
    """Return a problem of several stacks whose optimum a short horizon misses."""
    return Problem(generate("multi", blocks, buffers=buffers, seed=1)[0], PlanOptions(topple))


def ran(method, made, horizon=None, log=None):
    """Run one method alone; return the log."""
    log = SolveLog(made) if log is None else log
    getattr(ContractedStages(made, Settings(horizon=horizon)), method)(made, log, math.inf)
    return log


def judge(log, best):
    """Hold a log to exhaustive search."""
    assert log.bound is None or log.bound <= best
    assert log.cost is None or log.cost >= best


@pytest.mark.parametrize(("blocks", "buffers", "topple"), [(6, 0, True), (6, 2, False), (5, 0, True), (5, 0, False)])
def test_the_relaxation_bounds_at_a_sound_horizon_alone(blocks, buffers, topple):
    made = drawn(blocks, buffers, topple)
    best, sound = optimal_cost(made.instance, made.options), sound_layers(MovingBlocks.of(made))
    for horizon in range(1, sound + 1):
        log = ran("relaxations", made, horizon)
        judge(log, best)
        assert (log.bound is None) == (horizon < sound)
    assert log.bound_origin == "layered relaxation"


@pytest.mark.parametrize(
    ("blocks", "buffers", "topple", "horizons"),
    [(6, 0, True, (3, 4, 5)), (6, 2, False, (5, 6, 7)), (5, 0, True, (1, 3, 8)), (5, 0, False, (3, 4))],
)
def test_whatever_horizon_is_chosen_the_answer_is_true(blocks, buffers, topple, horizons):
    made = drawn(blocks, buffers, topple)
    best = optimal_cost(made.instance, made.options)
    for horizon in horizons:
        plan = LayeredPlanner().plan(made, Settings(horizon=horizon), 20.0)
        assert plan.lower_bound <= best
        assert plan.stated_cost is None or plan.stated_cost >= best
        assert plan.status != "infeasible"
        assert plan.status != "optimal" or plan.stated_cost == best


def test_without_a_chosen_horizon_there_is_a_short_one_and_then_the_sound_one():
    made = drawn(6, 0, True)
    blocks = MovingBlocks.of(made)
    assert ContractedStages(made, Settings()).horizons == [short_layers(blocks), sound_layers(blocks)] == [5, 10]
    assert ContractedStages(made, Settings(horizon=3)).horizons == [3]
    assert ContractedStages(reversal(options=NO_TOPPLE), Settings()).horizons == [4]


@pytest.mark.parametrize(("horizon", "layers"), [(None, 10), (3, 3)])
def test_the_first_model_is_the_relaxation_at_the_last_of_its_horizons(horizon, layers):
    made = drawn(6, 0, True)
    first = ContractedStages(made, Settings(horizon=horizon)).first_model()
    assert first.milp.size() == build_layered(made, MovingBlocks.of(made), layers).milp.size()


def test_each_misplaced_block_is_a_bound_of_two():
    made = problem({"s": "abc"}, PositionsGoal({"a": ("t", 1)}))  # b and c may lie where they fall
    log = ran("moves", made)
    assert (log.bound, log.cost) == (2, None)
    assert optimal_cost(made.instance) == 3


def test_a_solution_whose_blocks_find_no_place_to_rest_is_a_dearer_plan_and_proves_no_more():
    made = drawn(5, 0, False)
    log = ran("relaxations", made)
    assert log.bound == 14
    assert 20 == optimal_cost(made.instance, made.options) <= log.cost


def test_a_goal_chain_that_may_be_built_anywhere_has_no_resting_places():
    floating = problem({"s": "ab"}, OnGoal({"a": "b"}))
    assert ContractedStages(floating, Settings()).why_not_resting(floating) is not None
    assert ContractedStages(reversal(), Settings()).why_not_resting(reversal()) is None


@pytest.mark.parametrize(("blocks", "buffers", "topple"), [(6, 0, True), (5, 2, False), (5, 0, False)])
def test_resting_places_give_plans_and_prove_nothing(blocks, buffers, topple):
    made = drawn(blocks, buffers, topple)
    log = ran("resting", made)
    assert log.details["stages"][0]["horizon"] == sound_layers(MovingBlocks.of(made))
    judge(log, optimal_cost(made.instance, made.options))
    assert log.bound is None
    assert log.details["stages"][0]["status"] == "optimal" or log.cost is None
    assert (log.cost is None) == ((blocks, buffers) == (5, 0))  # there a block has to rest twice


@pytest.mark.parametrize(("options", "cost"), [(None, 5), (NO_TOPPLE, 8)])
def test_positions_alone_prove_the_optimum(options, cost):
    log = ran("positions", reversal(options=options))
    assert (log.cost, log.bound) == (cost, cost)
    assert log.bound_origin.startswith("layered positions")


def test_positions_in_too_few_layers_for_every_cheaper_plan_prove_nothing():
    made = drawn(5, 0, False)
    short = short_layers(MovingBlocks.of(made))
    log = SolveLog(made)
    log.offer(next(greedy_plans(made, math.inf, 0)), "known")
    assert short < (log.cost - 1) // 2
    ran("positions", made, short, log)
    assert (log.bound, log.details["stages"][0]["status"]) == (None, "infeasible")


@settings(max_examples=25, deadline=None)
@given(instances(min_blocks=1, max_blocks=3, max_buffers=1), plan_options())
def test_method_after_method_nothing_false_is_proven(instance, options):
    made = Problem(instance, options)
    assume(not made.solved and made.infeasible is None)
    best, log = optimal_cost(instance, options), SolveLog(made)
    stages = ContractedStages(made, Settings())
    for method in ("moves", "relaxations", "resting", "positions"):
        if method != "resting" or stages.why_not_resting(made) is None:
            ran(method, made, log=log)
            judge(log, best)
    assert log.cost == log.bound == best
