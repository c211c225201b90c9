"""Models as arrays: what was added stands where it belongs, and can be looked at before it is solved."""

import math

import numpy as np
import pytest

from smash.planners.milp.arrays import MilpBuilder, OutOfTime


def dense(model):
    """Return the rows of a model's matrix as lists."""
    return np.transpose([model.matrix @ unit for unit in np.eye(model.columns)]).tolist()


def test_columns_are_binaries_unless_said_otherwise():
    builder = MilpBuilder()
    first = builder.add_columns(2, cost=[3, 4])
    second = builder.add_columns(1, lower=-1, upper=5, integral=False)
    model = builder.build()
    assert first.tolist() + second.tolist() == [0, 1, 2]
    assert model.objective.tolist() == builder.costs().tolist() == [3, 4, 0]
    assert (model.lower.tolist(), model.upper.tolist()) == ([0, 0, -1], [1, 1, 5])
    assert model.integral.tolist() == [True, True, False]


def test_rows_are_counted_from_where_the_last_block_ended_and_entries_at_one_place_add_up():
    builder = MilpBuilder()
    x, y = builder.add_columns(2)
    builder.add_row([x], 1.0, upper=1)
    builder.add_rows([0, 1, 1], [x, y, y], [1.0, 2.0, 3.0], count=2, lower=[0, 4])
    model = builder.build()
    assert dense(model) == [[1, 0], [1, 0], [0, 5]]
    assert model.row_lower.tolist() == [-math.inf, 0, 4]
    assert model.row_upper.tolist() == [1, math.inf, math.inf]


def test_sums_take_a_row_from_each_array_and_leave_out_missing_columns():
    builder = MilpBuilder()
    builder.add_columns(4)
    builder.add_sums([(np.array([[0, 1], [2, -1]]), 1.0), (np.array([3, 3]), -2.0)], upper=[0, 1])
    model = builder.build()
    assert dense(model) == [[1, 1, 0, -2], [0, 0, 1, -2]]
    assert model.row_upper.tolist() == [0, 1]


def test_no_rows_are_made_of_empty_arrays():
    builder = MilpBuilder()
    builder.add_columns(1)
    builder.add_sums([(np.zeros((0, 3), dtype=np.int64), 1.0)], upper=0)
    assert builder.build().rows == 0


def test_the_violation_is_the_largest_of_rows_and_bounds():
    builder = MilpBuilder()
    x, y = builder.add_columns(2)
    builder.add_row([x, y], 1.0, lower=2)
    model = builder.build()
    assert model.violation(np.array([1.0, 1.0])) == 0
    assert model.violation(np.array([1.0, 0.5])) == 0.5
    assert model.violation(np.array([3.0, 1.0])) == 2


def test_the_size_counts_columns_rows_and_entries():
    builder = MilpBuilder()
    x, y = builder.add_columns(2)
    builder.add_columns(1, integral=False)
    builder.add_row([x, y], 1.0, upper=1)
    assert builder.build().size() == {"columns": 3, "integer_columns": 2, "rows": 1, "nonzeros": 2}


def test_an_empty_model_is_built():
    model = MilpBuilder().build()
    assert (model.columns, model.rows, model.violation(np.zeros(0))) == (0, 0, 0)


def test_past_its_deadline_nothing_is_added_or_built():
    builder = MilpBuilder(deadline=-math.inf)
    builder.add_columns(1)
    with pytest.raises(OutOfTime):
        builder.add_row([0], 1.0)
    with pytest.raises(OutOfTime):
        builder.build()
