"""The row set of `smash.planners.layered.positions` for carriers, lifts and any costs.

A transfer is one column, a *move* from place to place, because its price depends on both ends. The actions of a
layer are legal in any order: a block takes part in one, a carrier either in one carry or in loads and unloads; there
is one lift a layer. What a carry or a lift moves has an edge for each block that may not exceed the activation: one
activation is paid once for all that it holds, and in full for the first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from smash.planners.layered.network.carriers import CarrierColumns, add_carriers
from smash.planners.layered.network.lifts import LiftColumns, add_lifts
from smash.planners.layered.network.places import NO_EDGE, Places, free
from smash.planners.layered.positions import PositionsBuilder, PositionsModel
from smash.planners.layered.rows import fix
from smash.planners.milp.arrays import Floats, Ints
from smash.planners.milp.columns import new_columns, priced_columns, taken
from smash.problem.actions.lift import Lift
from smash.problem.model import Action, Pick, Place
from smash.problem.problem import Problem


@dataclass(frozen=True, slots=True)
class NetworkPositions(PositionsModel):
    """The model; p places, d decks, -1 where there is no such column.

    `move`: (t, b, p, p) a pick at one place and a place at the other; `carry`: (t, d, d) a carrier from one station
    to another; `cut`: (t, l, h) the lowest height that is lifted; `lift`: (t, l, l) a lift from one location to
    another.
    """

    places: Places
    move: Ints
    carry: Ints
    cut: Ints
    lift: Ints

    def actions(self, vector: Floats, layer: int) -> Iterator[Action]:
        """Yield the actions of a layer of a solution."""
        places = self.places
        yield from self.topples(vector, layer)
        cuts = {cut[0]: cut[1] for cut in taken(self.cut[layer], vector)}
        for source, target in taken(self.lift[layer], vector):
            height = self.keep[source] + cuts[source] + 1
            yield Lift(places.locations[source], height, places.locations[target])
        for block, source, target in taken(self.move[layer], vector):
            yield Pick(self.blocks[block], places.source(source))
            yield Place(self.blocks[block], places.source(target))
        for _, target in taken(self.carry[layer], vector):
            yield places.carry_to(target)


def build_network_positions(
    problem: Problem, horizon: int, lower_bound: int, upper_bound: int | None, deadline: float = math.inf
) -> NetworkPositions:
    """Build the model; arguments and errors as in `build_plain_positions`."""
    builder = _Builder(problem, horizon, deadline)
    milp = builder.finish(lower_bound, upper_bound)
    return NetworkPositions(
        milp,
        problem.instance.locations,
        builder.blocks,
        builder.keep,
        builder.topple,
        builder.places,
        builder.move,
        builder.carry,
        builder.lifts.cut,
        builder.lifts.lift,
    )


class _Builder(PositionsBuilder):
    move: Ints
    carry: Ints
    lifts: LiftColumns

    def __init__(self, problem: Problem, horizon: int, deadline: float) -> None:
        super().__init__(problem, horizon, deadline)
        self.places = Places.of(problem)

    def _add_columns(self) -> None:
        places, layers, n, milp = self.places, self.horizon, len(self.blocks), self.milp
        locations, decks = len(places.locations), len(places.decks)
        self.at = new_columns(milp, layers + 1, n, locations, n)
        self.lies = new_columns(milp, layers + 1, n)
        self.on = new_columns(milp, layers + 1, n, decks)
        self.stands = new_columns(milp, layers + 1, decks)
        self.move = priced_columns(milp, (layers, n), places.transfer)
        self.enter = new_columns(milp, layers, n, locations, n)
        self.leave = new_columns(milp, layers, n, locations, n, integral=False)
        toppled = np.full((locations, n), NO_EDGE, dtype=np.int64)
        toppled[: places.toppled] = places.topple
        self.topple = priced_columns(milp, (layers,), toppled)
        self.fall = priced_columns(milp, (layers, n), free(toppled))
        self.carry = priced_columns(milp, (layers,), places.carry)
        self.ride = priced_columns(milp, (layers, n), free(places.carry))
        self.lifts = LiftColumns.of(milp, places, layers, n)

    def _start(self) -> None:
        super()._start()
        held = np.zeros(self.on.shape[1:], dtype=bool)
        occupied = np.zeros(len(self.places.decks), dtype=bool)
        for number, carrier in self.places.occupied():
            occupied[number] = True
            held[[self.number[block] for block in carrier.holds], number] = True
        fix(self.milp, self.on[0], held)
        fix(self.milp, self.stands[0], occupied)

    def _moves(self) -> tuple[list[Ints], list[Ints]]:
        return [self.enter, self.lifts.settle], [self.leave, self.lifts.rise]

    def _picked_up(self) -> Ints:
        return self.move[:, :, self.places.table]

    def _further_rows(self) -> None:
        self._link_moves()
        inside = self.places.inside
        into, out = np.swapaxes(self.move, 2, 3)[:, :, inside], self.move[:, :, inside]
        add_carriers(self.milp, self.places, CarrierColumns(self.on, self.stands, self.carry, self.ride, into, out))
        self._pay_for_topples()
        add_lifts(self.milp, self.places, self.lifts, self.at)

    def _link_moves(self) -> None:
        """What leaves a location by a move enters another place; a block takes part in one action a layer."""
        rows = self.milp.add_sums
        layers, n, locations = self.enter.shape[:3]
        each = (layers * n * locations, -1)
        out, into = self.move[:, :, :locations], np.swapaxes(self.move, 2, 3)[:, :, :locations]
        rows([(self.leave.reshape(each), 1), (out.reshape(each), -1)], lower=0, upper=0)
        rows([(self.enter.reshape(each), 1), (into.reshape(each), -1)], lower=0, upper=0)
        events = (self.move, self.fall, self.ride, self.lifts.lifted)
        rows([(part.reshape(layers * n, -1), 1.0) for part in events], upper=1)

    def _pay_for_topples(self) -> None:
        """A block falls at the price of a whole topple, however many layers share it out; a topple takes some block."""
        for place in range(self.toppled):
            falls = self.fall[:, :, place].reshape(self.horizon, -1)
            self.milp.add_sums([(falls, 1), (self.topple[:, place], -1)], lower=0)
            for block in range(len(self.blocks)):
                self.milp.add_sums([(self.fall[:, block, place], 1), (self.topple[:, place], -1)], upper=0)

    def _actions_at(self) -> list[Ints]:
        locations = len(self.places.locations)
        each = (self.horizon, locations, -1)
        move, lift = np.moveaxis(self.move, 1, 3), self.lifts.lift  # move: t, p, p, b
        out, into = move[:, :locations], np.swapaxes(move, 1, 2)[:, :locations]
        parts = (out, into, self.topple, lift, np.swapaxes(lift, 1, 2))
        return [part.reshape(each) for part in parts]

    def _counted(self) -> list[Ints]:
        return [self.move, self.topple, self.carry, self.lifts.lift]

    @property
    def _most_actions(self) -> int:
        return len(self.blocks) + len(self.places.locations) + len(self.places.carriers)
