"""Gathering: another order of the same steps, with the same end and the chosen ones together."""

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from smash.planners.neighbourhood.gathering import gathered
from smash.problem.views.numbered import ON_TABLE, TOPPLE
from tests.planners.neighbourhood.wandering import verdict_on, wandering_plan
from tests.strategies import EVERY_KIND, instances, plan_options


@settings(max_examples=200, deadline=None)
@given(
    instances(max_blocks=5, max_stacks=5, kinds=EVERY_KIND),
    plan_options(),
    st.integers(0, 9999),
    st.sets(st.integers(0, 12)),
    st.integers(0, 4),
)
def test_the_new_order_is_a_plan_too(instance, options, seed, chosen, begin):
    planned = wandering_plan(instance, options, seed, count=16)
    assume(planned is not None)
    problem, steps = planned
    chosen = {index for index in chosen if index < len(steps) - begin}
    before, together, after = gathered(steps[begin:], chosen)
    assert sorted(before + together + after) == sorted(steps[begin:])
    assert {steps[begin + index] for index in chosen} <= set(together)
    assert verdict_on(problem, [*steps[:begin], *before, *together, *after]).accepted


def test_what_does_not_concern_them_goes_before_or_after():
    steps = [(0, 0, 1), (1, 2, 3), (2, 4, 5), (3, 1, 6), (4, 6, 0), (5, 3, 7)]
    assert gathered(steps, {0, 4}) == ([(1, 2, 3), (2, 4, 5), (5, 3, 7)], [(0, 0, 1), (3, 1, 6), (4, 6, 0)], [])
    assert gathered(steps, {1}) == ([(0, 0, 1), (2, 4, 5), (3, 1, 6), (4, 6, 0)], [(1, 2, 3)], [(5, 3, 7)])


def test_topples_and_picks_from_the_table_region_keep_their_order():
    steps = [(TOPPLE, 0, 1), (1, ON_TABLE, 2), (TOPPLE, 3, 1)]
    assert gathered(steps, {0, 2})[1] == steps
