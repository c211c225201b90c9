"""Columns in arrays: their shapes, their prices, and what a solution takes of them."""

import numpy as np

from smash.planners.milp.arrays import MilpBuilder
from smash.planners.milp.columns import new_columns, priced_columns, taken


def test_new_columns_have_a_shape_a_cost_and_a_kind():
    milp = MilpBuilder()
    binaries, fractions = new_columns(milp, 2, 3, cost=4.0), new_columns(milp, 2, integral=False)
    model = milp.build()
    assert binaries.tolist() == [[0, 1, 2], [3, 4, 5]]
    assert fractions.tolist() == [6, 7]
    assert model.objective.tolist() == [4.0] * 6 + [0.0] * 2
    assert model.integral.tolist() == [True] * 6 + [False] * 2


def test_there_is_a_column_where_there_is_a_price():
    milp = MilpBuilder()
    columns = priced_columns(milp, (2,), np.array([5, -1, 0]))
    assert columns.tolist() == [[0, -1, 1], [2, -1, 3]]
    assert milp.build().objective.tolist() == [5, 0, 5, 0]


def test_taken_are_the_columns_at_one_and_never_those_that_are_not_there():
    columns = np.array([[0, -1], [2, 1]])
    assert taken(columns, np.array([0.0, 1.0, 0.999999])) == [[1, 0], [1, 1]]
    assert taken(np.zeros((0, 2), dtype=np.int64), np.zeros(1)) == []
