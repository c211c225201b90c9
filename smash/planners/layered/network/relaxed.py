"""The relaxation of `positions`: three nodes a block, and the places where it rests in between.

As in `smash.planners.layered.events`, gravity shrinks a chain of height-indexed nodes: a block *waits* where it
starts until its first removal, *rests* on any location, deck or the table region, and is *home* after its last
placement. What rests on a location keeps all else from leaving or filling it; the order of what rests there is left
free (unless `ordered`), and a block without a goal is forgotten after its second removal. So every plan with one
action a layer is a solution of the same cost or less, and the optimum bounds all plans that the layers hold; most
solutions are plans.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from smash.planners.layered.network.carriers import CarrierColumns, add_carriers
from smash.planners.layered.network.moving import Moving
from smash.planners.layered.network.places import NO_EDGE, free
from smash.planners.layered.network.resting_order import OrderColumns, add_resting_order
from smash.planners.layered.rows import balance, bound_cost, fix, no_idle_layers
from smash.planners.milp.arrays import Ints, Milp, MilpBuilder
from smash.planners.milp.columns import new_columns, priced_columns
from smash.problem.problem import Problem

STARTS_TAKEN, REST_TAKEN = 0, 1
"""Kinds of topples and lifts: those that take blocks which wait where they started, those of resting blocks alone."""


@dataclass(frozen=True, slots=True)
class RelaxedModel:
    """The MILP and the meaning of its columns; -1 where there is no such column.

    Axes: t layers, b moving blocks, l locations, d decks. Sources of a move are the places and, last, the start;
    targets are the locations and decks, then home, then anywhere (`smash.planners.layered.network.moving`).

    `move`: (t, b, sources, targets); `topple`: (t, l, kinds); `fall`: (t, b, l + start); `carry`: (t, d, d);
    `lift`: (t, kinds, l, l); `lifted`: (t, b, l + start, l + home + anywhere).
    """

    milp: Milp
    moving: Moving
    move: Ints
    topple: Ints
    fall: Ints
    carry: Ints
    lift: Ints
    lifted: Ints


def build_relaxed(
    problem: Problem,
    moving: Moving,
    horizon: int,
    lower_bound: int = 0,
    upper_bound: int | None = None,
    deadline: float = math.inf,
    *,
    ordered: bool = False,
) -> RelaxedModel:
    """Build the relaxation.

    Args:
        problem: what is planned.
        moving: its moving blocks.
        horizon: number of layers.
        lower_bound: a bound on the cost of every solution, as a row: one that a coarser relaxation has proven. What
            bounds plans alone may be above what this relaxation costs, and would cut that off.
        upper_bound: only plans cheaper than this are of interest (None: all are).
        deadline: when to give up [s, clock of `perf_counter`].
        ordered: keep the order of what rests on one another (`smash.planners.layered.network.resting_order`).

    Raises:
        OutOfTime: where the deadline has passed.
    """
    builder = _Builder(problem, moving, horizon, deadline)
    builder.add_rows()
    if ordered:
        columns = OrderColumns(builder.move, builder.fall, builder.lifted, builder.rests)
        add_resting_order(builder.milp, builder.moving, columns)
    bound_cost(builder.milp, lower_bound, upper_bound)
    edges = (builder.move, builder.topple, builder.fall, builder.carry, builder.lift, builder.lifted)
    return RelaxedModel(builder.milp.build(), moving, *edges)


class _Builder:
    """Adds columns, then rows, one method a constraint."""

    def __init__(self, problem: Problem, moving: Moving, horizon: int, deadline: float) -> None:
        self.moving, self.places, self.blocks = moving, moving.places, moving.blocks
        self.piles, self.chains = moving.piles, [chain for _, chain in moving.blocks.chains]
        self.placed = sorted(moving.blocks.placed)
        self.origin, self.target, self.anywhere = moving.origin, moving.target, moving.anywhere
        self.start, self.home = moving.start, moving.home
        self.cap = problem.options.max_topple
        self.layers = horizon
        self.milp = MilpBuilder(deadline)

    def add_rows(self) -> None:
        self._add_columns()
        self._start_and_end()
        self._conserve()
        self._carriers()
        self._leave_in_order()
        self._arrive_in_order()
        self._rest_keeps_off()
        self._topples()
        self._lifts()
        self._one_action()
        most = len(self.blocks) + len(self.places.locations) + len(self.places.carriers)
        no_idle_layers(self.milp, (self.move, self.topple, self.carry, self.lift), most)

    def _states(self, *shape: int) -> Ints:
        """Return columns of what holds before the first layer and after each: sums of binaries."""
        return new_columns(self.milp, self.layers + 1, *shape, integral=False)

    def _add_columns(self) -> None:
        places, layers, n = self.places, (self.layers,), len(self.blocks)
        locations, decks = len(places.locations), len(places.decks)
        self.waits, self.lies, self.is_home = self._states(n), self._states(n), self._states(n)
        self.rests, self.on, self.stands = self._states(n, locations), self._states(n, decks), self._states(decks)
        self.move = priced_columns(self.milp, layers, self.moving.transfers())
        price = np.full((locations, 2), NO_EDGE, dtype=np.int64)
        price[: places.toppled] = places.topple
        self.topple = priced_columns(self.milp, layers, price)
        self.fall = priced_columns(self.milp, layers, self.moving.falls())
        self.carry = priced_columns(self.milp, layers, places.carry)
        self.ride = priced_columns(self.milp, (self.layers, n), free(places.carry))
        self.lift = priced_columns(self.milp, layers, np.array([places.lift, places.lift]))
        self.lifted = priced_columns(self.milp, layers, self.moving.lifts())

    def _start_and_end(self) -> None:
        decks = len(self.places.decks)
        held, standing = [], []
        for number, carrier in self.places.occupied():
            standing.append(number)
            held += [self.blocks.names.index(block) * decks + number for block in carrier.holds]
        self._fix(self.waits[0], [block for block, at in enumerate(self.origin) if at >= 0])
        self._fix(self.lies[0], list(self.blocks.lying))
        self._fix(self.rests[0], [])
        self._fix(self.on[0], held)
        self._fix(self.stands[0], standing)
        self._fix(self.is_home[0], [])
        self._fix(self.is_home[-1], self.placed)
        self._fix(self.waits[-1], [])

    def _fix(self, columns: Ints, chosen: list[int]) -> None:
        """Set the chosen of some columns, by their place in the flat array, and no others."""
        values = np.zeros(columns.size)
        values[chosen] = 1
        fix(self.milp, columns, values)

    def _conserve(self) -> None:
        """Conservation of every block at every node (decks apart); a block takes part in one action a layer."""
        locations, table = len(self.places.locations), self.places.table
        move, lifted, fall = self.move, self.lifted, self.fall
        out = [move[:, :, self.start], lifted[:, :, locations], fall[:, :, locations]]
        balance(self.milp, self.waits, [], out)
        into = [np.swapaxes(move, 2, 3)[:, :, :locations], np.swapaxes(lifted, 2, 3)[:, :, :locations]]
        balance(self.milp, self.rests, into, [part[:, :, :locations] for part in (move, lifted, fall)])
        balance(self.milp, self.lies, [fall], [move[:, :, table]])
        balance(self.milp, self.is_home, [move[:, :, :, self.home], lifted[:, :, :, locations]], [])
        rows = self.layers * len(self.blocks)
        self.milp.add_sums([(part.reshape(rows, -1), 1.0) for part in (move, lifted, fall, self.ride)], upper=1)

    def _carriers(self) -> None:
        inside = self.places.inside
        into, out = np.swapaxes(self.move, 2, 3)[:, :, inside], self.move[:, :, inside]
        add_carriers(self.milp, self.places, CarrierColumns(self.on, self.stands, self.carry, self.ride, into, out))

    def _leave_in_order(self) -> None:
        """A pile empties from its top: by moves one after the other, by a topple or a lift at once."""
        for lower, upper in (pair for pile in self.piles for pair in itertools.pairwise(pile)):
            waits = self.waits[1:, [lower, upper]]
            self.milp.add_sums([(waits[:, 1:], 1), (waits[:, :1], -1)], upper=0)
            self.milp.add_sums([(self.move[:, lower, self.start], 1), (self.waits[:-1, [upper]], 1)], upper=1)

    def _arrive_in_order(self) -> None:
        """A goal chain fills from its bottom, after its location has been left."""
        for chain in self.chains:
            for under, upper in itertools.pairwise(chain):
                homes = self.is_home[1:, [under, upper]]
                self.milp.add_sums([(homes[:, 1:], 1), (homes[:, :1], -1)], upper=0)
                arrives = self.move[:, upper, :, self.home]
                self.milp.add_sums([(arrives, 1), (self.is_home[:-1, [under]], -1)], upper=0)
            at = self.target[chain[0]]
            if at >= 0 and self.piles[at]:
                lowest = self.piles[at][0]
                self.milp.add_sums([(self.is_home[1:, [chain[0]]], 1), (self.waits[:-1, [lowest]], 1)], upper=1)

    def _rest_keeps_off(self) -> None:
        """What rests on a location keeps the waiting blocks below from leaving and the goal chain from growing."""
        for block in range(len(self.blocks)):
            for at, pile in enumerate(self.piles):
                before, after = self.rests[:-1, [block], at], self.rests[1:, [block], at]
                if pile:
                    leaves = self.move[:, pile, self.start].reshape(self.layers, -1)
                    self.milp.add_sums([(leaves, 1), (before, 1)], upper=1)
                    takes = [(self.topple[:, [at], STARTS_TAKEN], 1.0), (self.lift[:, STARTS_TAKEN, at], 1.0)]
                    self.milp.add_sums([*takes, (after, 1)], upper=1)
                for comer in (other for other in self.placed if self.target[other] == at and other != block):
                    was, now = self.is_home[:-1, [comer]], self.is_home[1:, [comer]]
                    self.milp.add_sums([(now, 1), (was, -1), (before, 1)], upper=1)

    def _topples(self) -> None:
        locations = len(self.places.locations)
        for at in range(self.places.toppled):
            either = self.topple[:, at]
            falls = [self.fall[:, :, at]]
            if self.piles[at]:
                falls.append(self.fall[:, self.piles[at], locations])
            for block in range(len(self.blocks)):
                whole = [self.fall[:, [block], at]]
                if self.origin[block] == at:
                    own = self.fall[:, [block], locations]
                    self.milp.add_sums([(own, 1), (self.topple[:, [at], STARTS_TAKEN], -1)], upper=0)
                    whole.append(own)
                self.milp.add_sums([*((part, 1.0) for part in whole), (either, -1)], upper=0)
            parts = [(part, 1.0) for part in falls]
            self.milp.add_sums([*parts, (either, -1)], lower=0)
            if self.cap is not None:
                self.milp.add_sums([*parts, (either, -self.cap)], upper=0)

    def _lifts(self) -> None:
        """A lift is paid in full by each block that it takes; it takes no more than the capacity, in their order."""
        if not self.places.lifted:
            return
        for source, target in self._pairs():
            both, starts = self.lift[:, :, source, target], self.lift[:, [STARTS_TAKEN], source, target]
            taken = []
            for block in range(len(self.blocks)):
                parts, own = self._lifted_from(block, source, target)
                taken.append(parts)
                if own is not None:
                    self.milp.add_sums([(own, 1), (starts, -1)], upper=0)
                self.milp.add_sums([(parts, 1), (both, -1)], upper=0)
            everything = np.concatenate(taken, axis=1)
            self.milp.add_sums([(everything, 1), (both, -self.places.lifted)], upper=0)
        self._lifts_to_anywhere()
        locations = len(self.places.locations)
        for chain in self.chains:
            for under, upper in itertools.combinations(chain, 2):
                at = self.origin[under]
                if at >= 0 and self.origin[upper] == at and self.piles[at].index(under) > self.piles[at].index(upper):
                    together = self.lifted[:, [under, upper], locations, locations]
                    self.milp.add_sums([(together, 1)], upper=1)

    def _pairs(self) -> Iterator[tuple[int, int]]:
        return itertools.permutations(range(len(self.places.locations)), 2)

    def _lifted_from(self, block: int, source: int, target: int) -> tuple[Ints, Ints | None]:
        """Return the columns by which a lift between two locations takes a block; and those from its start."""
        locations = len(self.places.locations)
        targets = [target] + ([locations] if self.target[block] == target else [])
        parts = self.lifted[:, block, source][:, targets]
        if self.origin[block] != source:
            return parts, None
        own = self.lifted[:, block, locations][:, targets]
        return np.concatenate([parts, own], axis=1), own

    def _lifts_to_anywhere(self) -> None:
        """Lifts whose target the relaxation leaves open: home for an `on` goal, anywhere for a block without a goal."""
        locations = len(self.places.locations)
        for source in range(locations):
            both = self.lift[:, :, source].reshape(self.layers, -1)
            starts = self.lift[:, STARTS_TAKEN, source]
            openly = []
            for block in range(len(self.blocks)):
                targets = [locations + 1] + ([locations] if self.anywhere else [])
                parts = self.lifted[:, block, source][:, targets]
                if self.origin[block] == source:
                    own = self.lifted[:, block, locations][:, targets]
                    self.milp.add_sums([(own, 1), (starts, -1)], upper=0)
                    parts = np.concatenate([parts, own], axis=1)
                self.milp.add_sums([(parts, 1), (both, -1)], upper=0)
                openly.append(parts)
            self.milp.add_sums([(np.concatenate(openly, axis=1), 1), (both, -self.places.lifted)], upper=0)

    def _one_action(self) -> None:
        """A location takes part in one action a layer; there is one lift."""
        for at in range(len(self.places.locations)):
            starting = self.move[:, self.piles[at], self.start]
            arriving = self.move[..., self.home][:, [b for b in self.placed if self.target[b] == at]]
            parts = [starting, arriving, self.move[:, :, at], self.move[:, :, :, at], self.topple[:, at]]
            parts += [self.lift[:, :, at], self.lift[:, :, :, at]]
            self.milp.add_sums([(part.reshape(self.layers, -1), 1.0) for part in parts if part.size], upper=1)
        if self.places.lifted:
            self.milp.add_sums([(self.lift.reshape(self.layers, -1), 1)], upper=1)
