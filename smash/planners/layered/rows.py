"""Rows that the layered models have in common; t layers are the first axis of every array."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from smash.planners.milp.arrays import Ints, MilpBuilder


def fix(milp: MilpBuilder, columns: Ints, values: ArrayLike) -> None:
    """Give columns their values (an array of the same shape)."""
    sides = np.asarray(values, dtype=float).ravel()
    milp.add_sums([(columns.reshape(-1, 1), 1.0)], lower=sides, upper=sides)


def balance(milp: MilpBuilder, state: Ints, into: Sequence[Ints], out: Sequence[Ints]) -> None:
    """A state after each layer is that before it, and what comes in the layer, without what goes.

    Args:
        milp: the model.
        state: (t + 1, ...) what holds before the first layer and after each.
        into: what comes, arrays of the state's shape for t layers, with any further axes.
        out: what goes.
    """
    rows = state[1:].size
    terms = [(state[1:].reshape(rows, 1), 1.0), (state[:-1].reshape(rows, 1), -1.0)]
    terms += [(part.reshape(rows, -1), -1.0) for part in into] + [(part.reshape(rows, -1), 1.0) for part in out]
    milp.add_sums(terms, lower=0, upper=0)


def no_idle_layers(milp: MilpBuilder, actions: Sequence[Ints], most: int) -> None:
    """Symmetry: a layer in which nothing happens is followed by such layers only.

    Args:
        milp: the model.
        actions: (t, ...) the actions of a layer, each in one column.
        most: no layer has more actions.
    """
    parts = [part.reshape(len(part), -1) for part in actions]
    later, sooner = [(part[1:], 1.0) for part in parts], [(part[:-1], -float(most)) for part in parts]
    milp.add_sums([*later, *sooner], upper=0)


def bound_cost(milp: MilpBuilder, lower: float, upper: float | None) -> None:
    """Keep the cost of a solution at least at `lower` and below `upper` (None: whatever it is)."""
    prices = milp.costs()
    columns = np.flatnonzero(prices)
    milp.add_row(columns, prices[columns], lower=lower, upper=np.inf if upper is None else upper - 1)
