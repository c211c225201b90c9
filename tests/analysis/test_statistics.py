"""Intervals and paired comparisons: known figures, and laws for any input."""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from smash_analysis.statistics.intervals import bootstrap, bootstrap_ratio, is_range, paired, success_rate, wilson
from smash_analysis.tables.writing import with_spread


def side(costs, seeds=(0,)):
    """One side: instance -> cost, None where it solved nothing."""
    rows = [(name, seed, cost is not None, cost) for name, cost in costs.items() for seed in seeds]
    return pd.DataFrame(rows, columns=["instance", "seed", "solved", "cost"]).astype({"cost": float})


def compare(left, right):
    return paired(left, right, ["instance", "seed"], ["instance"], "cost")


def test_wilson_interval_of_nothing_and_of_all():
    assert wilson(0, 0) == (0.0, 1.0)
    low, high = wilson(20, 20)
    assert (round(low, 3), high) == (0.839, 1.0)


@given(st.integers(1, 500).flatmap(lambda trials: st.tuples(st.integers(0, trials), st.just(trials))))
def test_a_wilson_interval_holds_the_share_and_stays_a_share(counts):
    successes, trials = counts
    low, high = wilson(successes, trials)
    assert 0.0 <= low <= successes / trials + 1e-12
    assert successes / trials - 1e-12 <= high <= 1.0


def test_a_rate_counts_instances_and_more_seeds_do_not_narrow_its_interval():
    once = pd.DataFrame({"instance": ["a", "b"], "good": [True, False]})
    uneven = pd.concat([once, *[once[once["instance"] == "a"]] * 2])
    rate = success_rate(uneven, "good")
    assert (rate.mean, rate.units, rate.trials) == (0.5, 2, 4)
    assert rate.interval == success_rate(once, "good").interval == wilson(1, 2)
    assert math.isnan(success_rate(once.iloc[:0], "good").mean)


def test_the_bootstrap_interval_holds_the_mean():
    low, high = bootstrap(np.arange(8.0))
    assert 0.0 < low < 3.5 < high < 7.0


def test_fewer_than_eight_values_have_a_range_and_no_interval():
    assert bootstrap(np.array([3.0, 1.0, 2.0])) == (1.0, 3.0)
    assert bootstrap_ratio(np.array([1.0, 3.0]), np.array([2.0, 2.0])) == (0.5, 1.5)
    assert (is_range(7), is_range(8)) == (True, False)
    assert with_spread(2.0, (1.0, 3.0), 7) == "2.0 (1.0 to 3.0)"
    assert with_spread(2.0, (1.0, 3.0), 8) == "2.0 [1.0, 3.0]"
    assert with_spread(2.0, (math.nan, math.nan), 8) == "2.0"
    assert with_spread(math.nan, (math.nan, math.nan), 0) == "–"


def test_the_bootstrap_of_equal_values_is_that_value_and_of_none_is_no_number():
    assert bootstrap(np.array([3.0, 3.0])) == (3.0, 3.0)
    assert all(math.isnan(end) for end in bootstrap(np.array([])))


def test_the_same_records_give_the_same_interval():
    values = np.random.default_rng(1).normal(size=30)
    assert bootstrap(values) == bootstrap(values)


def test_a_ratio_that_is_the_same_in_every_pair_has_no_spread():
    below = np.array([10.0, 20.0, 40.0] * 3)
    assert bootstrap_ratio(1.5 * below, below) == pytest.approx((1.5, 1.5))


def test_only_common_instances_are_compared_and_coverage_is_kept():
    pair = compare(side({"a": 30, "b": 20, "c": None, "d": 99}), side({"a": 20, "b": None, "c": 5, "d": 66}))
    assert (pair.problems, pair.left_rate.mean, pair.right_rate.mean, pair.units) == (4, 0.75, 0.75, 2)
    assert pair.differences.tolist() == [10, 33]
    assert (pair.left_mean, pair.right_mean) == (64.5, 43)
    assert pair.ratio == pytest.approx(1.5)
    assert pair.tally == (2, 0, 0)


def test_what_one_side_alone_tried_is_no_pair():
    assert compare(side({"a": 3, "b": 4}), side({"a": 3})).problems == 1


def test_seeds_of_one_instance_are_one_piece_of_evidence():
    pair = compare(side({"a": 30, "b": 20}, seeds=(0, 1, 2)), side({"a": 20, "b": 20}, seeds=(0, 1, 2)))
    assert (pair.problems, pair.left_rate.units, pair.units) == (6, 2, 2)


def test_nothing_in_common_gives_no_figure():
    pair = compare(side({"a": 3, "b": None}), side({"a": None, "b": 4}))
    assert pair.units == 0
    assert all(math.isnan(x) for x in (pair.mean, pair.ratio, *pair.interval))


def test_plans_of_no_action_have_a_difference_but_no_ratio():
    pair = compare(side({"a": 0}), side({"a": 0}))
    assert pair.mean == 0
    assert math.isnan(pair.ratio)


@settings(max_examples=25, deadline=None)
@given(st.dictionaries(st.text(max_size=4), st.tuples(st.integers(0, 99), st.integers(0, 99)), min_size=1, max_size=9))
def test_swapping_the_sides_mirrors_the_differences(costs):
    left, right = (side({name: pair[at] for name, pair in costs.items()}) for at in (0, 1))
    forth, back = compare(left, right), compare(right, left)
    assert forth.mean == pytest.approx(-back.mean)
    assert forth.tally == back.tally[::-1]
    assert forth.interval[0] <= forth.mean + 1e-9
    assert forth.mean - 1e-9 <= forth.interval[1]
