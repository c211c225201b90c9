"""The layered model with the locations that there are: every block that is put aside rests somewhere.

Added to the three-node model: for each block that is put aside a location and a level on it (1: on whatever lies
there). What rests at a location forbids all else there until it has left; levels keep the order of a pile. Plans
that move a block more than twice are not in this model, so that it gives plans and no bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from smash.planners.layered.blocks import MovingBlocks
from smash.planners.layered.events import Event, EventsBuilder, LayeredModel, read_events
from smash.planners.layered.rows import bound_cost
from smash.planners.milp.arrays import Floats, Ints, Milp
from smash.planners.milp.columns import new_columns, taken
from smash.problem.problem import Problem

LEVELS = 3
"""Blocks that may rest on one another at one location."""


@dataclass(frozen=True, slots=True)
class RestingModel:
    """The layered model and `comes`: (blocks, locations, levels, layers) columns of the places where blocks rest."""

    layered: LayeredModel
    comes: Ints

    @property
    def milp(self) -> Milp:
        """The MILP of both."""
        return self.layered.milp


def build_resting(
    problem: Problem,
    blocks: MovingBlocks,
    horizon: int,
    lower_bound: int,
    upper_bound: int | None,
    deadline: float = math.inf,
) -> RestingModel:
    """Build the model.

    Args:
        problem: what is planned.
        blocks: its moving blocks; no goal chain may float.
        horizon: number of layers.
        lower_bound: a proven bound on the cost of every plan, as a row.
        upper_bound: only plans cheaper than this are of interest (None: all are).
        deadline: when to give up [s, clock of `perf_counter`].

    Raises:
        OutOfTime: where the deadline has passed.
    """
    builder = _RestingBuilder(problem, blocks, horizon, deadline, (lower_bound, upper_bound))
    layered = builder.build()
    return RestingModel(layered, builder.comes)


class _RestingBuilder(EventsBuilder):
    def __init__(
        self, problem: Problem, blocks: MovingBlocks, horizon: int, deadline: float, bounds: tuple[int, int | None]
    ) -> None:
        super().__init__(problem, blocks, horizon, deadline)
        self.locations = problem.instance.locations
        self.bounds = bounds

    def _detours(self) -> None:
        super()._detours()
        shape = (len(self.blocks), len(self.locations), LEVELS, self.horizon)
        self.comes = new_columns(self.milp, *shape)
        self.goes = new_columns(self.milp, *shape)
        self.rests = new_columns(self.milp, *shape)
        self._come_and_go()
        self._pile_up()
        for place, location in enumerate(self.locations):
            self._keep_off(place, location)
        bound_cost(self.milp, *self.bounds)

    def _come_and_go(self) -> None:
        blocks, _, _, layers = self.comes.shape
        for block in range(blocks):
            for layer in range(layers):
                for kind, parts in (("aside", self.comes), ("from_aside", self.goes)):
                    edge = self.edges[kind][block, layer]
                    columns = parts[block, :, :, layer].ravel()
                    whole = [edge] if edge >= 0 else []
                    self.milp.add_row([*columns, *whole], [*[1] * len(columns), *[-1] * len(whole)], lower=0, upper=0)
        states = [(self.rests, 1.0), (self.comes, -1.0)]
        later = [(part[..., 1:].reshape(-1, 1), value) for part, value in [*states, (self.goes, 1.0)]]
        self.milp.add_sums([*later, (self.rests[..., :-1].reshape(-1, 1), -1.0)], lower=0, upper=0)
        self.milp.add_sums([(part[..., 0].reshape(-1, 1), value) for part, value in states], lower=0, upper=0)

    def _pile_up(self) -> None:
        """One block a level, and none above an empty level."""
        for place in range(len(self.locations)):
            for layer in range(self.horizon):
                for level in range(LEVELS):
                    here = self.rests[:, place, level, layer]
                    below = self.rests[:, place, level - 1, layer] if level else np.zeros(0, dtype=np.int64)
                    upper = 0 if level else 1
                    self.milp.add_row([*here, *below], [*[1] * len(here), *[-1] * len(below)], upper=upper)

    def _keep_off(self, place: int, location: str) -> None:
        """One action a location and layer; what rests there comes first."""
        filled = dict(self.blocks.chains).get(location, ())
        emptied = dict(self.blocks.piles).get(location, ())
        for layer in range(self.horizon):
            actions = self._actions_on(location, filled, emptied, layer)
            moves = [*self.comes[:, place, :, layer].ravel(), *self.goes[:, place, :, layer].ravel()]
            self.milp.add_row([*actions, *moves], [1] * (len(actions) + len(moves)), upper=1)
            if layer and actions:
                resting = self.rests[:, place, 0, layer - 1]
                self.milp.add_row([*actions, *resting], [1] * (len(actions) + len(resting)), upper=1)


def read_resting(model: RestingModel, locations: tuple[str, ...], vector: Floats) -> list[Event]:
    """Return the edges that a solution takes, those to a resting place with its location."""
    events = []
    for event in read_events(model.layered, vector):
        if event.kind == "aside":
            place, _ = taken(model.comes[event.subject, :, :, event.layer], vector)[0]
            events.append(Event(event.layer, event.kind, event.subject, locations[place]))
        else:
            events.append(event)
    return events
