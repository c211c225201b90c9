"""Columns of a model in arrays: added by shape, chosen by price, read from a solution."""

from __future__ import annotations

import math

import numpy as np

from smash.planners.milp.arrays import Floats, Ints, MilpBuilder


def new_columns(milp: MilpBuilder, *shape: int, cost: float = 0.0, integral: bool = True) -> Ints:
    """Return new binaries, or fractions between 0 and 1, in an array of a shape.

    Args:
        milp: the model.
        shape: the shape.
        cost: what each costs.
        integral: whether they are binaries.
    """
    return milp.add_columns(math.prod(shape), cost=cost, integral=integral).reshape(shape)


def priced_columns(milp: MilpBuilder, repeat: tuple[int, ...], price: Ints) -> Ints:
    """Return new binaries of shape `repeat` + that of `price`, -1 where the price is negative: there is no edge.

    Args:
        milp: the model.
        repeat: how often the edges are there.
        price: what each edge costs.
    """
    columns = np.full((*repeat, *price.shape), -1, dtype=np.int64)
    there = np.broadcast_to(price >= 0, columns.shape)
    columns[there] = milp.add_columns(int(there.sum()), cost=np.broadcast_to(price, columns.shape)[there])
    return columns


def taken(columns: Ints, vector: Floats) -> list[list[int]]:
    """Return the places in an array of columns (-1: none) whose binary is 1 in a solution, in the array's order."""
    if not columns.size:
        return []
    found: list[list[int]] = np.argwhere((columns >= 0) & (vector[columns] > 0.5)).tolist()
    return found
