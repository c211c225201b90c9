"""The layered model of the family: blocks at places, heights and stations, and one binary for each activation.

It generalises `smash.planners.layered.positions`. Each layer holds actions that do not touch each other: a location
takes part in one of them, a block in one, a carrier either in one carry or in loads and unloads; there is one lift a
layer. So the actions of a layer are legal in any order. What a carry or a lift moves has an edge for each block that
may not exceed the activation: one activation is paid once for all that it holds, and in full for the first.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from smash.planners.layered.family.carriers import CarrierColumns, add_carriers
from smash.planners.layered.family.places import Places
from smash.planners.milp.arrays import Ints, Milp, MilpBuilder
from smash.problem.model import Instance, OnGoal, PlanOptions
from smash.problem.views.demands import Demands


@dataclass(frozen=True, slots=True)
class FamilyModel:
    """The MILP and the meaning of the columns that a plan is read from.

    Axes: t layers, b moving blocks, l locations, h heights above the kept blocks, d decks, p places. -1 where there
    is no such column. `move`: (t, b, p, p) a pick at one place and a place at the other; `topple`: (t, l, h) the
    lowest height that falls; `carry`: (t, d, d) a carrier from one station to another; `cut`: (t, l, h) the lowest
    height that is lifted; `lift`: (t, l, l) a lift from one location to another.
    """

    places: Places
    blocks: tuple[str, ...]
    keep: tuple[int, ...]
    milp: Milp
    move: Ints
    topple: Ints
    carry: Ints
    cut: Ints
    lift: Ints


def build_family(
    instance: Instance,
    demands: Demands,
    options: PlanOptions,
    horizon: int,
    lower_bound: int = 0,
    upper_bound: int | None = None,
    deadline: float = math.inf,
) -> FamilyModel:
    """Build the model.

    Args:
        instance: the problem.
        demands: what its goal asks; kept blocks are left out, but for an `on` goal, whose towers may have to move.
        options: what plans may use.
        horizon: number of layers.
        lower_bound: a proven bound on the cost of every plan, as a row.
        upper_bound: only plans cheaper than this are of interest (None: all are).
        deadline: when to give up [s, clock of `perf_counter`].

    Raises:
        OutOfTime: where the deadline has passed.
    """
    return _Builder(instance, demands, options, horizon, deadline).build(lower_bound, upper_bound)


class _Builder:
    """Adds columns, then rows, one method a constraint."""

    def __init__(
        self, instance: Instance, demands: Demands, options: PlanOptions, horizon: int, deadline: float
    ) -> None:
        self.instance = instance
        self.demands = demands
        self.cap = options.max_topple
        self.places = Places.of(instance, options)
        everything = isinstance(instance.goal, OnGoal)
        self.keep = tuple(0 if everything else demands.keep[at] for at in instance.locations)
        piles = [instance.start[at][kept:] for at, kept in zip(instance.locations, self.keep, strict=True)]
        lying = [block for block in instance.table if everything or block in demands.placed]
        held = [block for carrier in instance.carriers for block in carrier.holds]
        self.blocks = (*(block for pile in piles for block in pile), *lying, *held)
        self.number = {block: index for index, block in enumerate(self.blocks)}
        self.piles = [[self.number[block] for block in pile] for pile in piles]
        self.lying = [self.number[block] for block in lying]
        self.layers = horizon
        self.milp = MilpBuilder(deadline)

    def build(self, lower_bound: int, upper_bound: int | None) -> FamilyModel:
        self._add_states()
        self._add_edges()
        self._start()
        self._conserve()
        self._gravity()
        self._decks()
        self._topples()
        self._lifts()
        self._one_action()
        self._goal()
        self._no_idle_layers()
        self._cost(lower_bound, upper_bound)
        return FamilyModel(
            self.places,
            self.blocks,
            self.keep,
            self.milp.build(),
            self.move,
            self.topple,
            self.carry,
            self.cut,
            self.lift,
        )

    def _new(self, *shape: int, integral: bool = True) -> Ints:
        return self.milp.add_columns(math.prod(shape), integral=integral).reshape(shape)

    def _priced(self, repeat: tuple[int, ...], price: Ints) -> Ints:
        """Return columns of shape `repeat` + the shape of `price`, -1 where the price says that there is no edge."""
        columns = np.full((*repeat, *price.shape), -1, dtype=np.int64)
        there = np.broadcast_to(price >= 0, columns.shape)
        columns[there] = self.milp.add_columns(int(there.sum()), cost=np.broadcast_to(price, columns.shape)[there])
        return columns

    def _add_states(self) -> None:
        """Columns of what holds before the first layer and after each."""
        n, locations, decks = len(self.blocks), len(self.places.locations), len(self.places.decks)
        times = self.layers + 1
        self.at = self._new(times, n, locations, n)
        self.lies = self._new(times, n)
        self.on = self._new(times, n, decks)
        self.stands = self._new(times, decks)

    def _add_edges(self) -> None:
        """Columns of what happens in each layer, at its cost."""
        places, layers, n = self.places, self.layers, len(self.blocks)
        locations = len(places.locations)
        free_carry = np.where(places.carry >= 0, 0, -1)
        free_lift = np.where(places.lift >= 0, 0, -1)
        self.move = self._priced((layers, n), places.transfer)
        self.enter = self._new(layers, n, locations, n)
        self.leave = self._new(layers, n, locations, n, integral=False)
        toppled = np.full((locations, n), -1, dtype=np.int64)
        toppled[: places.toppled] = places.topple
        self.topple = self._priced((layers,), toppled)
        self.fall = self._priced((layers, n), np.where(toppled >= 0, 0, -1))
        self.carry = self._priced((layers,), places.carry)
        self.ride = self._priced((layers, n), free_carry)
        self.lift = self._priced((layers,), places.lift)
        self.lifted = self._priced((layers, n), free_lift)
        ends = np.full((locations, n), 0 if places.lifted else -1, dtype=np.int64)
        self.cut, self.land = self._priced((layers,), ends), self._priced((layers,), ends)
        self.rise, self.settle = self._priced((layers, n), ends), self._priced((layers, n), ends)
        group = min(places.lifted, n)
        self.rank = self._new(layers, n, group)

    def _fix(self, columns: Ints, values: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> None:
        sides = values.astype(float).ravel()
        self.milp.add_sums([(columns.reshape(-1, 1), 1.0)], lower=sides, upper=sides)

    def _start(self) -> None:
        n = len(self.blocks)
        standing = np.zeros(self.at.shape[1:], dtype=bool)
        for place, pile in enumerate(self.piles):
            for height, block in enumerate(pile):
                standing[block, place, height] = True
        lying = np.zeros(n, dtype=bool)
        lying[self.lying] = True
        held = np.zeros(self.on.shape[1:], dtype=bool)
        occupied = np.zeros(len(self.places.decks), dtype=bool)
        for number, deck in enumerate(self.places.decks):
            carrier = self.places.carriers[deck.carrier]
            if carrier.at == deck.station:
                occupied[number] = True
                held[[self.number[block] for block in carrier.holds], number] = True
        for columns, values in ((self.at, standing), (self.lies, lying), (self.on, held), (self.stands, occupied)):
            self._fix(columns[0], values)

    def _conserve(self) -> None:
        """Conservation of every block at every node; what leaves a place by a move enters another."""
        rows = self.milp.add_sums
        layers, n, locations = self.enter.shape[:3]
        cells = self.enter.size

        def by_cell(columns: Ints) -> Ints:
            return columns.reshape(cells, 1)

        came = [(by_cell(self.enter), -1.0), (by_cell(self.settle), -1.0)]
        went = [(by_cell(part), 1.0) for part in (self.leave, self.fall, self.rise)]
        rows([(by_cell(self.at[1:]), 1), (by_cell(self.at[:-1]), -1), *came, *went], lower=0, upper=0)

        def by_place(columns: Ints) -> Ints:
            return columns.reshape(layers * n * locations, -1)

        out, into = self.move[:, :, :locations, :], np.swapaxes(self.move, 2, 3)[:, :, :locations, :]
        rows([(by_place(self.leave), 1), (by_place(out), -1)], lower=0, upper=0)
        rows([(by_place(self.enter), 1), (by_place(into), -1)], lower=0, upper=0)
        if self.places.lifted:
            rows([(by_place(self.rise), 1), (by_place(self.lifted), -1)], lower=0, upper=0)
            rows([(by_place(self.settle), 1), (by_place(np.swapaxes(self.lifted, 2, 3)), -1)], lower=0, upper=0)

        def by_block(columns: Ints) -> Ints:
            return columns.reshape(layers * n, -1)

        taken = self.move[:, :, self.places.table, :]
        now, before = by_block(self.lies[1:]), by_block(self.lies[:-1])
        rows([(now, 1), (before, -1), (by_block(self.fall), -1), (by_block(taken), 1)], lower=0, upper=0)
        events = [(by_block(part), 1.0) for part in (self.move, self.fall, self.ride, self.lifted)]
        rows(events, upper=1)

    def _gravity(self) -> None:
        """At most one block a place, and one only where the place below holds one."""
        n = len(self.blocks)
        places = np.moveaxis(self.at, 1, 3)  # t, l, h, b
        self.milp.add_sums([(places.reshape(-1, n), 1)], upper=1)
        upper, under = places[:, :, 1:].reshape(-1, n), places[:, :, :-1].reshape(-1, n)
        self.milp.add_sums([(upper, 1), (under, -1)], upper=0)

    def _decks(self) -> None:
        inside = slice(len(self.places.locations), self.places.table)
        into, out = np.swapaxes(self.move, 2, 3)[:, :, inside], self.move[:, :, inside]
        add_carriers(self.milp, self.places, CarrierColumns(self.on, self.stands, self.carry, self.ride, into, out))

    def _topples(self) -> None:
        """What falls is at or above the cut of a topple, everything there falls, and no more than the cap."""
        n = len(self.blocks)
        for place in range(self.places.toppled):
            for height in range(n):
                cuts = self.topple[:, place, : height + 1]
                self.milp.add_sums([(self.fall[:, :, place, height], 1), (cuts, -1)], upper=0)
                after = self.at[1:, :, place, height]
                self.milp.add_sums([(after, 1), (self.topple[:, place, height][:, None], 1)], upper=1)
            falls = self.fall[:, :, place].reshape(self.layers, -1)
            self.milp.add_sums([(falls, 1), (self.topple[:, place], -1)], lower=0)
            if self.cap is not None:
                self.milp.add_sums([(falls, 1), (self.topple[:, place], -self.cap)], upper=0)
            # A block falls at the price of a whole topple, however many layers share it out.
            for block in range(n):
                self.milp.add_sums([(self.fall[:, block, place], 1), (self.topple[:, place], -1)], upper=0)

    def _lifts(self) -> None:
        """A lift takes the top of a pile, at most the capacity, and sets it down in its order."""
        if not self.places.lifted:
            return
        rows = self.milp.add_sums
        layers, n, locations = self.lifted.shape[:3]
        lifts = np.broadcast_to(self.lift[:, None], self.lifted.shape)
        there = self.lifted.ravel() >= 0
        rows([(self.lifted.reshape(-1, 1)[there], 1), (lifts.reshape(-1, 1)[there], -1)], upper=0)
        each = (layers * locations, -1)
        out, into = self.lift.reshape(each), np.swapaxes(self.lift, 1, 2).reshape(each)
        rows([(self.cut.reshape(each), 1), (out, -1)], lower=0, upper=0)
        rows([(self.land.reshape(each), 1), (into, -1)], lower=0, upper=0)
        risen = np.moveaxis(self.rise, 1, 2).reshape(each)
        rows([(risen, 1), (out, -self.rank.shape[2])], upper=0)
        rows([(risen, 1), (out, -1)], lower=0)
        rows([(self.rank.reshape(layers * n, -1), 1), (self.lifted.reshape(layers * n, -1), -1)], lower=0, upper=0)
        rows([(np.swapaxes(self.rank, 1, 2).reshape(-1, n), 1)], upper=1)
        for height in range(n):
            cuts = self.cut[:, :, : height + 1].reshape(each)
            rows([(np.moveaxis(self.rise[..., height], 1, 2).reshape(each), 1), (cuts, -1)], upper=0)
            after = np.moveaxis(self.at[1:, :, :, height], 1, 2).reshape(each)
            rows([(after, 1), (self.cut[:, :, height].reshape(-1, 1), 1)], upper=1)
        self._lifted_order()

    def _lifted_order(self) -> None:
        """The block of rank i in the hand comes from the cut + i and goes to the landing + i."""
        layers, n, locations, heights = self.rise.shape
        blocks = (layers, n, locations)

        def each(columns: Ints, axis: int) -> Ints:
            return np.broadcast_to(np.expand_dims(columns, axis), blocks).reshape(-1, 1)

        for rank in range(self.rank.shape[2]):
            held = each(self.rank[..., rank], 2)
            for low in range(heights):
                cut, land = each(self.cut[..., low], 1), each(self.land[..., low], 1)
                if low + rank < heights:
                    rise, settle = (part[..., low + rank].reshape(-1, 1) for part in (self.rise, self.settle))
                    self.milp.add_sums([(rise, 1), (cut, 1), (held, -1)], upper=1)
                    self.milp.add_sums([(held, 1), (land, 1), (settle, -1)], upper=1)
                else:
                    self.milp.add_sums([(held, 1), (land, 1)], upper=1)

    def _one_action(self) -> None:
        """A location takes part in one action a layer; there is one lift."""
        locations = len(self.places.locations)
        move = np.moveaxis(self.move, 1, 3)  # t, p, p, b
        out, into = move[:, :locations], np.swapaxes(move, 1, 2)[:, :locations]
        parts = [out, into, self.topple, self.lift, np.swapaxes(self.lift, 1, 2)]
        each = (self.layers * locations, -1)
        self.milp.add_sums([(part.reshape(each), 1.0) for part in parts], upper=1)
        if self.places.lifted:
            self.milp.add_sums([(self.lift.reshape(self.layers, -1), 1)], upper=1)

    def _goal(self) -> None:
        last = self.at[-1]
        goal, rows = self.instance.goal, self.milp.add_sums
        if isinstance(goal, OnGoal):
            for upper, under in goal.on.items():
                a, b = last[self.number[upper]], last[self.number[under]]
                rows([(a[:, 1:].reshape(1, -1), 1)], lower=1)
                rows([(a[:, 1:].reshape(-1, 1), 1), (b[:, :-1].reshape(-1, 1), -1)], upper=0)
            for block in goal.bottom:
                rows([(last[self.number[block], :, :1].reshape(1, -1), 1)], lower=1)
            return
        for place, location in enumerate(self.places.locations):
            for height, block in enumerate(self.demands.build.get(location, ())):
                rows([(last[self.number[block], place, height].reshape(1, 1), 1)], lower=1)

    def _activations(self) -> list[tuple[Ints, float]]:
        parts = (self.move, self.topple, self.carry, self.lift)
        return [(part.reshape(self.layers, -1), 1.0) for part in parts]

    def _no_idle_layers(self) -> None:
        """Symmetry: a layer in which nothing happens is followed by such layers only."""
        most = len(self.blocks) + len(self.places.locations) + len(self.places.carriers)
        later = [(part[1:], value) for part, value in self._activations()]
        sooner = [(part[:-1], -value * most) for part, value in self._activations()]
        self.milp.add_sums([*later, *sooner], upper=0)

    def _cost(self, lower_bound: int, upper_bound: int | None) -> None:
        prices = self.milp.costs()
        columns = np.flatnonzero(prices)
        upper = np.inf if upper_bound is None else upper_bound - 1
        self.milp.add_row(columns, prices[columns], lower=lower_bound, upper=upper)
