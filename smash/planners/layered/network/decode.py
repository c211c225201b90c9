"""From a solution of the relaxation to a plan, choosing what it leaves open."""

from __future__ import annotations

import numpy as np

from smash.planners.layered.draft import Draft
from smash.planners.layered.network.places import NO_EDGE
from smash.planners.layered.network.relaxed import RelaxedModel
from smash.planners.milp.arrays import Floats, Ints
from smash.planners.milp.columns import taken
from smash.problem.actions.lift import Lift
from smash.problem.actions.topple import Topple
from smash.problem.errors import IllegalAction
from smash.problem.model import Action, OnGoal
from smash.problem.problem import Problem


def read_relaxed(problem: Problem, model: RelaxedModel, vector: Floats) -> tuple[Action, ...]:
    """Return the plan of a solution, layer by layer.

    Raises:
        IllegalAction: where blocks would have to leave in an order that the piles do not allow.
    """
    reader = _Reader(problem, model, vector)
    for layer in range(len(model.move)):
        reader.read(layer)
    return reader.draft.actions


class _Reader:
    def __init__(self, problem: Problem, model: RelaxedModel, vector: Floats) -> None:
        self.instance = problem.instance
        self.model, self.moving, self.places = model, model.moving, model.moving.places
        self.names = model.moving.blocks.names
        self.vector = vector
        self.draft = Draft(problem)

    def read(self, layer: int) -> None:
        model, places = self.model, self.places
        for at, _ in self._taken(model.topple[layer]):
            falling = [block for block, source in self._taken(model.fall[layer]) if self._from(block, source) == at]
            if falling:
                self.draft.add(Topple(places.locations[at], self._lowest(at, falling)))
        for _, source, target in self._taken(model.lift[layer]):
            lifted = [block for block, at, _ in self._taken(model.lifted[layer]) if self._from(block, at) == source]
            if lifted:
                self.draft.add(Lift(places.locations[source], self._lowest(source, lifted), places.locations[target]))
        for block, source, target in self._taken(model.move[layer]):
            at = self.moving.origin[block] if source == self.moving.start else source
            self.draft.move(self.names[block], places.source(at), places.source(self._to(block, at, target)))
        for _, target in self._taken(model.carry[layer]):
            self.draft.add(places.carry_to(target))

    def _from(self, block: int, source: int) -> int:
        return self.moving.origin[block] if source == len(self.places.locations) else source

    def _lowest(self, at: int, blocks: list[int]) -> int:
        """Return the height of the lowest of some blocks at a location.

        Raises:
            IllegalAction: where one of them is not there.
        """
        location = self.places.locations[at]
        pile = self.draft.state.piles[location]
        names = [self.names[block] for block in blocks]
        missing = [name for name in names if name not in pile]
        if missing:
            raise IllegalAction(f"{missing[0]!r} is not at {location!r}")
        return min(pile.index(name) for name in names) + 1

    def _to(self, block: int, source: int, target: int) -> int:
        """Return the place that a move ends at: the cheapest one that the law allows where it is left open."""
        home, gone = self.moving.home, self.moving.gone
        if target < home:
            return target
        if target == home and self.moving.target[block] >= 0:
            return self.moving.target[block]
        prices = self.places.transfer[source].copy()
        if target == home:
            prices[len(self.places.locations) :] = NO_EDGE
        order = [place for place in np.argsort(prices, kind="stable").tolist() if prices[place] >= 0]
        if target == gone or not order:
            return order[0] if order else source
        return self._tower(block, order)

    def _tower(self, block: int, order: list[int]) -> int:
        """Return the location where a block of an `on` goal belongs: on the block under it, or on the nearest floor."""
        goal, piles = self.instance.goal, self.draft.state.piles
        assert isinstance(goal, OnGoal)
        name, names = self.names[block], self.places.locations
        under = goal.on.get(name)
        fits = [at for at in order if (piles[names[at]][-1] == under if piles[names[at]] else under is None)]
        return (fits or order)[0]

    def _taken(self, columns: Ints) -> list[list[int]]:
        return taken(columns, self.vector)
