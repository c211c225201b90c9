"""Numbers of layers: short ones for plans, enough ones for proofs, growing ones in between."""

import math
from functools import partial

import pytest
from hypothesis import assume, given, settings

from smash.planners.layered.blocks import MovingBlocks
from smash.planners.layered.horizons import Cheaper, direct_layers, enough_layers, short_layers, sound_layers
from smash.planners.layered.plain_positions import build_plain_positions
from smash.planners.layered.positions import read_positions
from smash.planners.milp.solving import Solving, Stage
from smash.planners.protocol import Settings, SolveLog
from smash.problem import Pick, Place
from smash.problem.problem import Problem
from tests.cheapest import cheapest_plan
from tests.planners.layered.made import NO_TOPPLE, problem, reversal
from tests.strategies import instances, plan_options


@pytest.mark.parametrize(("options", "direct", "short"), [(None, 4, 6), (NO_TOPPLE, 6, 6)])
def test_a_pile_empties_in_one_topple_or_block_by_block(options, direct, short):
    # b, c, d leave s and are placed on e
    blocks = MovingBlocks.of(problem({"s": "abcd", "t": "e"}, {"s": "a", "t": "edcb"}, options=options))
    assert (direct_layers(blocks), short_layers(blocks), sound_layers(blocks)) == (direct, short, 6)


def test_a_short_horizon_is_no_longer_than_the_sound_one():
    blocks = MovingBlocks.of(problem({"s": "a"}, {"t": "a"}))
    assert (direct_layers(blocks), short_layers(blocks), sound_layers(blocks)) == (2, 2, 2)


@settings(max_examples=40, deadline=None)
@given(instances(min_blocks=1, max_blocks=3, max_buffers=1), plan_options())
def test_a_cheapest_plan_fits_enough_layers_for_one_more_than_its_cost(instance, options):
    best = cheapest_plan(instance, options)
    assume(best is not None and best[0])
    cost, actions = best
    layers = len(actions) - sum(isinstance(action, Place) for action in actions)
    assert layers <= enough_layers(MovingBlocks.of(Problem(instance, options)), cost + 1)


def test_without_a_plan_nothing_is_known():
    assert enough_layers(MovingBlocks.of(reversal()), None) is None


def grown(made, first, horizon=None, plan=None):
    """Grow the model of positions, from a plan that is known; return the log and the horizons tried."""
    log, tried, blocks = SolveLog(made), [], MovingBlocks.of(made)
    if plan is not None:
        assert log.offer(plan, "known")

    def stage(layers, bound, best):
        tried.append(layers)
        build, read = partial(build_plain_positions, made, layers, bound, best), partial(read_positions, made)
        return Stage("positions", build, read, layers)

    solving = Solving(Settings(horizon=horizon), log, math.inf)
    Cheaper(stage, lambda: enough_layers(blocks, log.cost)).grow(solving, first)
    return log, tried


def test_horizons_grow_until_one_holds_every_cheaper_plan_and_that_is_the_proof():
    log, tried = grown(reversal(options=NO_TOPPLE), 2)
    assert tried == [2, 4, 3]  # 8 is found in 4 layers; what costs less has 3 at the most
    assert (log.cost, log.bound, log.bound_origin) == (8, 8, "layered positions at a horizon of 3")


def test_a_chosen_horizon_is_the_only_one_and_a_short_one_proves_nothing():
    log, tried = grown(reversal(options=NO_TOPPLE), 2, horizon=3)
    assert (tried, log.cost, log.bound) == ([3], None, None)


@pytest.mark.parametrize(("horizon", "bound"), [(2, None), (3, 8)])
def test_no_better_plan_in_too_few_layers_is_no_proof(horizon, bound):
    plan = [action for move in ("bsu", "asv", "bus", "avs") for action in (Pick(*move[:2]), Place(move[0], move[2]))]
    log, _ = grown(reversal(options=NO_TOPPLE), 2, horizon, plan)
    assert (log.cost, log.bound) == (8, bound)
