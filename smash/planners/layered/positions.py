"""The layered model with every resting place in it, as far as it is the same whatever actions and costs there are.

Where few buffers make blocks rest on stacks, on each other, or move more than twice, the positions of the chains come
back: a binary for each moving block, location, height and layer. Gravity anchors the heights; a location takes part in
one action a layer, so that a removal or a placement below a top is ruled out by gravity alone. Two row sets complete
it: `plain_positions` (transfers and topples at unit costs, the smaller one) and `network.positions` (any costs,
carriers, lifts).

All arrays have their axes in one order: t layers, b moving blocks, l locations, h heights above the kept blocks.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from smash.planners.layered.draft import Draft
from smash.planners.layered.rows import balance, bound_cost, fix, no_idle_layers
from smash.planners.milp.arrays import Floats, Ints, Milp, MilpBuilder
from smash.planners.milp.columns import taken
from smash.problem.actions.topple import Topple
from smash.problem.model import Action, OnGoal
from smash.problem.problem import Problem


@dataclass(frozen=True, slots=True)
class PositionsModel(ABC):
    """The MILP and the meaning of the columns that both row sets have.

    Attributes:
        milp: the MILP.
        locations: names of the locations.
        blocks: names of the moving blocks.
        keep: per location how many of its lowest blocks never move.
        topple: (t, l, h) the lowest height that falls, -1 where there is no such column.
    """

    milp: Milp
    locations: tuple[str, ...]
    blocks: tuple[str, ...]
    keep: tuple[int, ...]
    topple: Ints

    @abstractmethod
    def actions(self, vector: Floats, layer: int) -> Iterator[Action]:
        """Yield the actions of a layer of a solution; none touches another."""

    def topples(self, vector: Floats, layer: int) -> Iterator[Action]:
        """Yield the topples of a layer."""
        for place, height in taken(self.topple[layer], vector):
            yield Topple(self.locations[place], self.keep[place] + height + 1)


def read_positions(problem: Problem, model: PositionsModel, vector: Floats) -> tuple[Action, ...]:
    """Return the plan of a solution, layer by layer.

    Raises:
        IllegalAction: where the law refuses it.
    """
    draft = Draft(problem)
    for layer in range(len(model.topple)):
        draft.add(*model.actions(vector, layer))
    return draft.actions


class PositionsBuilder(ABC):
    """Adds columns, then rows, one method a constraint.

    A row set adds the columns: `at` (t + 1, b, l, h), the block is there before the first layer and after each;
    `lies` (t + 1, b), it is in the table region, or None where no block can be; `enter`, `leave`, `fall`
    (t, b, l, h), it comes to, is taken from, or falls from there in a layer; `topple` (t, l, h).
    """

    at: Ints
    lies: Ints | None
    enter: Ints
    leave: Ints
    fall: Ints
    topple: Ints

    def __init__(self, problem: Problem, horizon: int, deadline: float) -> None:
        instance, demands = problem.posed, problem.demands
        self.instance, self.demands = instance, demands
        self.cap = problem.options.max_topple
        self.toppled = len(instance.stacks) if problem.options.topple else 0
        self.horizon = horizon
        everything = isinstance(instance.goal, OnGoal)  # its towers may have to move
        self.keep = tuple(0 if everything else demands.keep[at] for at in instance.locations)
        piles = [instance.start[at][kept:] for at, kept in zip(instance.locations, self.keep, strict=True)]
        lying = [block for block in instance.table if everything or block in demands.placed]
        held = [block for carrier in instance.carriers for block in carrier.holds]
        self.blocks = (*(block for pile in piles for block in pile), *lying, *held)
        self.number = {block: index for index, block in enumerate(self.blocks)}
        self.piles = [[self.number[block] for block in pile] for pile in piles]
        self.lying = [self.number[block] for block in lying]
        self.milp = MilpBuilder(deadline)

    def finish(self, lower_bound: int, upper_bound: int | None) -> Milp:
        """Add everything and return the MILP, whose plans cost at least the one bound and less than the other."""
        self._add_columns()
        self._start()
        self._conserve()
        self._gravity()
        self._topples()
        self._one_action()
        self._further_rows()
        self._goal()
        no_idle_layers(self.milp, self._counted(), self._most_actions)
        bound_cost(self.milp, lower_bound, upper_bound)
        return self.milp.build()

    @abstractmethod
    def _add_columns(self) -> None:
        """Add the columns."""

    @abstractmethod
    def _further_rows(self) -> None:
        """Add the rows that only this row set has."""

    @abstractmethod
    def _moves(self) -> tuple[list[Ints], list[Ints]]:
        """Return what comes to and what goes from a position, falls apart, as arrays (t, b, l, h)."""

    @abstractmethod
    def _picked_up(self) -> Ints:
        """Return the columns (t, b, any) of blocks that leave the table region."""

    @abstractmethod
    def _actions_at(self) -> list[Ints]:
        """Return the columns (t, l, any) of the actions that a location takes part in."""

    @abstractmethod
    def _counted(self) -> list[Ints]:
        """Return the columns (t, ...) of the actions of a layer, each once."""

    @property
    @abstractmethod
    def _most_actions(self) -> int:
        """No layer has more actions."""

    def _start(self) -> None:
        standing = np.zeros(self.at.shape[1:], dtype=bool)
        for place, pile in enumerate(self.piles):
            for height, block in enumerate(pile):
                standing[block, place, height] = True
        fix(self.milp, self.at[0], standing)
        if self.lies is not None:
            lying = np.zeros(len(self.blocks), dtype=bool)
            lying[self.lying] = True
            fix(self.milp, self.lies[0], lying)

    def _conserve(self) -> None:
        """Conservation of every block at every position and in the table region."""
        into, out = self._moves()
        balance(self.milp, self.at, into, [*out, self.fall])
        if self.lies is not None:
            balance(self.milp, self.lies, [self.fall], [self._picked_up()])

    def _gravity(self) -> None:
        """At most one block a position, and one only where the position below holds one."""
        n = len(self.blocks)
        places = np.moveaxis(self.at, 1, 3)  # t, l, h, b
        self.milp.add_sums([(places.reshape(-1, n), 1)], upper=1)
        upper, under = places[:, :, 1:].reshape(-1, n), places[:, :, :-1].reshape(-1, n)
        self.milp.add_sums([(upper, 1), (under, -1)], upper=0)

    def _topples(self) -> None:
        """What falls is at or above the cut of a topple, everything there falls, and no more than the cap."""
        for place in range(self.toppled):
            for height in range(len(self.blocks)):
                cuts = self.topple[:, place, : height + 1]
                self.milp.add_sums([(self.fall[:, :, place, height], 1), (cuts, -1)], upper=0)
                after = self.at[1:, :, place, height]
                self.milp.add_sums([(after, 1), (self.topple[:, place, height][:, None], 1)], upper=1)
            if self.cap is not None:
                self.milp.add_sums([(self.fall[:, :, place], 1), (self.topple[:, place], -self.cap)], upper=0)

    def _one_action(self) -> None:
        """A location takes part in one action a layer."""
        each = (self.horizon * len(self.instance.locations), -1)
        self.milp.add_sums([(part.reshape(each), 1.0) for part in self._actions_at()], upper=1)

    def _goal(self) -> None:
        last, goal, rows = self.at[-1], self.instance.goal, self.milp.add_sums
        if isinstance(goal, OnGoal):
            for upper, under in goal.on.items():
                a, b = last[self.number[upper]], last[self.number[under]]
                rows([(a[:, 1:].reshape(1, -1), 1)], lower=1)
                rows([(a[:, 1:].reshape(-1, 1), 1), (b[:, :-1].reshape(-1, 1), -1)], upper=0)
            for block in goal.bottom:
                rows([(last[self.number[block], :, :1].reshape(1, -1), 1)], lower=1)
            return
        for place, location in enumerate(self.instance.locations):
            for height, block in enumerate(self.demands.build.get(location, ())):
                rows([(last[self.number[block], place, height].reshape(1, 1), 1)], lower=1, upper=1)
