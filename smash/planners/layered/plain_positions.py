"""The row set of `positions` for pick, place and topple alone, each at cost 1.

Where a block comes from is left open in the columns: what is taken up in a layer is put down in it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from smash.planners.layered.events import TOPPLE_COST, TRANSFER_COST
from smash.planners.layered.positions import PositionsBuilder, PositionsModel
from smash.planners.milp.arrays import Floats, Ints
from smash.planners.milp.columns import new_columns, taken
from smash.problem.errors import IllegalAction
from smash.problem.model import TABLE, Action, Pick, Place
from smash.problem.problem import Problem


@dataclass(frozen=True, slots=True)
class PlainPositions(PositionsModel):
    """The model; `enter`, `leave`: (t, b, l, h); `take`: (t, b) a block is taken from the table region, -1: none is."""

    enter: Ints
    leave: Ints
    take: Ints

    def actions(self, vector: Floats, layer: int) -> Iterator[Action]:
        """Yield the actions of a layer of a solution.

        Raises:
            IllegalAction: where a block comes from nowhere.
        """
        yield from self.topples(vector, layer)
        from_table = {block for (block,) in taken(self.take[layer], vector)}
        source = {block: self.locations[place] for block, place, _ in taken(self.leave[layer], vector)}
        source |= dict.fromkeys(from_table, TABLE)
        for block, place, _ in taken(self.enter[layer], vector):
            name = self.blocks[block]
            if block not in source:
                raise IllegalAction(f"{name!r} comes from nowhere in layer {layer}")
            yield Pick(name, source[block])
            yield Place(name, self.locations[place])


def build_plain_positions(
    problem: Problem, horizon: int, lower_bound: int, upper_bound: int | None, deadline: float = math.inf
) -> PlainPositions:
    """Build the model.

    Args:
        problem: what is planned; kept blocks are left out, but for an `on` goal.
        horizon: number of layers.
        lower_bound: a proven bound on the cost of every plan, as a row.
        upper_bound: only plans cheaper than this are of interest (None: all are).
        deadline: when to give up [s, clock of `perf_counter`].

    Raises:
        OutOfTime: where the deadline has passed.
    """
    builder = _Builder(problem, horizon, deadline)
    milp = builder.finish(lower_bound, upper_bound)
    locations = problem.instance.locations
    return PlainPositions(
        milp, locations, builder.blocks, builder.keep, builder.topple, builder.enter, builder.leave, builder.take
    )


class _Builder(PositionsBuilder):
    take: Ints

    def _add_columns(self) -> None:
        layers, n, locations = self.horizon, len(self.blocks), len(self.instance.locations)
        self.at = new_columns(self.milp, layers + 1, n, locations, n)
        self.enter = new_columns(self.milp, layers, n, locations, n, cost=TRANSFER_COST)
        self.leave = new_columns(self.milp, layers, n, locations, n)
        self.fall = np.full((layers, n, locations, n), -1, dtype=np.int64)
        self.fall[:, :, : self.toppled] = new_columns(self.milp, layers, n, self.toppled, n)
        self.take, self.lies = np.full((layers, n), -1, dtype=np.int64), None
        if self.toppled or self.lying:
            self.take = new_columns(self.milp, layers, n)
            self.lies = new_columns(self.milp, layers + 1, n)
        self.topple = np.full((layers, locations, n), -1, dtype=np.int64)
        self.topple[:, : self.toppled] = new_columns(self.milp, layers, self.toppled, n, cost=TOPPLE_COST)

    def _moves(self) -> tuple[list[Ints], list[Ints]]:
        return [self.enter], [self.leave]

    def _picked_up(self) -> Ints:
        return self.take[:, :, None]

    def _further_rows(self) -> None:
        """What is taken up in a layer is put down in it."""
        rows = (self.horizon * len(self.blocks), -1)
        entered, left, took = (part.reshape(rows) for part in (self.enter, self.leave, self.take))
        self.milp.add_sums([(entered, 1), (left, -1), (took, -1)], lower=0, upper=0)

    def _actions_at(self) -> list[Ints]:
        by_location = (self.horizon, len(self.instance.locations), -1)
        enter, leave = (np.moveaxis(part, 1, 2).reshape(by_location) for part in (self.enter, self.leave))
        return [enter, leave, self.topple]

    def _counted(self) -> list[Ints]:
        return [self.enter, self.topple]

    @property
    def _most_actions(self) -> int:
        return len(self.instance.locations)
