"""From a solution of the family's model to a plan."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from smash.planners.layered.family.model import FamilyModel
from smash.planners.layered.family.relaxed import RelaxedModel
from smash.planners.milp.arrays import Floats, Ints
from smash.problem.actions.carry import Carry
from smash.problem.actions.lift import Lift
from smash.problem.actions.topple import Topple
from smash.problem.errors import IllegalAction
from smash.problem.model import Action, Instance, OnGoal, Pick, Place, PlanOptions, State
from smash.problem.rules import Law


def read_family(
    instance: Instance, options: PlanOptions, model: FamilyModel, vector: Floats
) -> tuple[Action, ...] | None:
    """Return the plan of a solution: layers in order, one layer's actions in any order; None: the law refuses one."""
    law, state = Law(instance, options), State.start_of(instance)
    plan: list[Action] = []
    for layer in range(model.move.shape[0]):
        for action in _actions(model, vector, layer):
            try:
                law.apply(state, action)
            except IllegalAction:
                return None
            plan.append(action)
    return tuple(plan)


def _actions(model: FamilyModel, vector: Floats, layer: int) -> Iterator[Action]:
    places = model.places
    for place, height in _taken(model.topple[layer], vector):
        yield Topple(places.locations[place], model.keep[place] + height + 1)
    for source, target in _taken(model.lift[layer], vector):
        cut = next(int(height) for place, height in _taken(model.cut[layer], vector) if place == source)
        yield Lift(places.locations[source], model.keep[source] + cut + 1, places.locations[target])
    for block, source, target in _taken(model.move[layer], vector):
        yield Pick(model.blocks[block], places.source(source))
        yield Place(model.blocks[block], places.source(target))
    for _, target in _taken(model.carry[layer], vector):
        deck = places.decks[target]
        yield Carry(places.carriers[deck.carrier].name, deck.station)


class RelaxedReader:
    """Reads a solution of the relaxation as a plan, choosing what it leaves open."""

    def __init__(self, instance: Instance, options: PlanOptions, model: RelaxedModel, vector: Floats) -> None:
        self.model = model
        self.vector = vector
        self.law = Law(instance, options)
        self.state = State.start_of(instance)
        self.plan: list[Action] = []

    def actions(self) -> tuple[Action, ...] | None:
        """Return the plan, or None where blocks would have to leave in an order that the piles do not allow."""
        try:
            for layer in range(self.model.move.shape[0]):
                self._read(layer)
        except IllegalAction:
            return None
        return tuple(self.plan)

    def _do(self, *actions: Action) -> None:
        for action in actions:
            self.law.apply(self.state, action)
            self.plan.append(action)

    def _read(self, layer: int) -> None:
        model = self.model
        places = model.places
        for at, _ in self._taken(model.topple[layer]):
            falling = [block for block, source in self._taken(model.fall[layer]) if self._from(block, source) == at]
            if falling:
                self._do(Topple(places.locations[at], self._lowest(at, falling)))
        for _, source, target in self._taken(model.lift[layer]):
            taken = [block for block, at, _ in self._taken(model.lifted[layer]) if self._from(block, at) == source]
            if taken:
                self._do(Lift(places.locations[source], self._lowest(source, taken), places.locations[target]))
        for block, source, target in self._taken(model.move[layer]):
            at = model.origin[block] if source == places.count else source
            name = model.blocks[block]
            self._do(Pick(name, places.source(at)), Place(name, places.source(self._to(block, at, target))))
        for _, target in self._taken(model.carry[layer]):
            deck = places.decks[target]
            self._do(Carry(places.carriers[deck.carrier].name, deck.station))

    def _from(self, block: int, source: int) -> int:
        return self.model.origin[block] if source == len(self.model.places.locations) else source

    def _lowest(self, at: int, blocks: list[int]) -> int:
        """Return the height of the lowest of some blocks at a location.

        Raises:
            IllegalAction: where one of them is not there.
        """
        pile = self.state.piles[self.model.places.locations[at]]
        names = [self.model.blocks[block] for block in blocks]
        missing = [name for name in names if name not in pile]
        if missing:
            raise IllegalAction(f"{missing[0]!r} is not at {self.model.places.locations[at]!r}")
        return min(pile.index(name) for name in names) + 1

    def _to(self, block: int, source: int, target: int) -> int:
        """Return the place that a move ends at: the cheapest one that the law allows where it is left open."""
        model = self.model
        home, gone = model.places.count - 1, model.places.count
        if target < home:
            return target
        if target == home and model.target[block] >= 0:
            return model.target[block]
        prices = model.places.transfer[source].copy()
        if target == home:
            prices[len(model.places.locations) :] = -1
        order = [place for place in np.argsort(prices, kind="stable").tolist() if prices[place] >= 0]
        if target == gone or not order:
            return order[0] if order else source
        return self._tower(block, order)

    def _tower(self, block: int, order: list[int]) -> int:
        """Return the location where a block of an `on` goal belongs: on the block under it, or on the nearest floor."""
        goal, piles = self.law.instance.goal, self.state.piles
        assert isinstance(goal, OnGoal)
        name, names = self.model.blocks[block], self.model.places.locations
        under = goal.on.get(name)
        fits = [at for at in order if (piles[names[at]][-1] == under if piles[names[at]] else under is None)]
        return (fits or order)[0]

    def _taken(self, columns: Ints) -> list[list[int]]:
        return _taken(columns, self.vector)


def _taken(columns: Ints, vector: Floats) -> list[list[int]]:
    if not columns.size:
        return []
    found: list[list[int]] = np.argwhere((columns >= 0) & (vector[columns] > 0.5)).tolist()
    return found
