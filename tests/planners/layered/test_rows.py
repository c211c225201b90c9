"""Rows that the layered models share, on a handful of columns."""

import numpy as np
import pytest

from smash.planners.layered.rows import balance, bound_cost, fix, no_idle_layers
from smash.planners.milp.arrays import MilpBuilder


def violation(milp, values):
    return milp.build().violation(np.array(values, dtype=float))


def test_columns_are_fixed_to_their_values():
    milp = MilpBuilder()
    fix(milp, milp.add_columns(2), [True, False])
    assert violation(milp, [1, 0]) == 0
    assert violation(milp, [0, 0]) == 1


@pytest.mark.parametrize(("state", "comes", "goes", "fits"), [((0, 1), 1, 0, 1), ((1, 0), 0, 1, 1), ((0, 1), 0, 0, 0)])
def test_a_state_changes_by_what_comes_and_goes(state, comes, goes, fits):
    milp = MilpBuilder()
    columns = milp.add_columns(4)
    balance(milp, columns[:2], [columns[2:3]], [columns[3:]])
    assert (violation(milp, [*state, comes, goes]) == 0) == fits


def test_no_layer_works_after_an_idle_one():
    milp = MilpBuilder()
    no_idle_layers(milp, [milp.add_columns(4).reshape(2, 2)], 2)
    assert violation(milp, [0, 0, 1, 0]) > 0
    assert violation(milp, [1, 0, 1, 1]) == 0
    assert violation(milp, [1, 0, 0, 0]) == 0


def test_the_cost_is_kept_between_its_bounds():
    milp = MilpBuilder()
    milp.add_columns(3, cost=[2, 0, 3])
    bound_cost(milp, 2, 5)
    assert violation(milp, [1, 0, 1]) == 1
    assert violation(milp, [0, 1, 0]) == 2
    assert violation(milp, [0, 1, 1]) == 0
