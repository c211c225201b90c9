"""The layered model with the locations that there are: every block that is put aside rests somewhere.

Added to the three-node model: for each block that is put aside a location and a level on it (1: on whatever lies
there). What rests at a location forbids all else there until it has left; levels keep the order of a pile. Plans
that move a block more than twice are not in this model, so that it gives plans and no bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from smash.planners.layered.events import Event, EventsBuilder, LayeredModel, LayeredProblem, read_events
from smash.planners.milp.arrays import Floats, Ints
from smash.problem.model import Instance, PlanOptions

LEVELS = 3
"""Blocks that may rest on one another at one location."""


@dataclass(frozen=True, slots=True)
class RestingModel:
    """The layered model and `comes`: (blocks, locations, levels, layers) columns of the places where blocks rest."""

    layered: LayeredModel
    comes: Ints


def build_resting(
    instance: Instance,
    problem: LayeredProblem,
    options: PlanOptions,
    horizon: int,
    lower_bound: int,
    most: int | None,
    deadline: float = math.inf,
) -> RestingModel:
    """Build the model.

    Args:
        instance: the problem.
        problem: its moving blocks; no goal chain may float.
        options: topple or not, and its cap.
        horizon: number of layers.
        lower_bound: a proven bound on the cost of every plan, as a row.
        most: plans above this cost are of no interest (None: all are).
        deadline: when to give up [s, clock of `perf_counter`].

    Raises:
        OutOfTime: where the deadline has passed.
    """
    builder = _RestingBuilder(instance, problem, options, horizon, lower_bound, most, deadline)
    layered = builder.build()
    return RestingModel(layered, builder.comes)


class _RestingBuilder(EventsBuilder):
    def __init__(
        self,
        instance: Instance,
        problem: LayeredProblem,
        options: PlanOptions,
        horizon: int,
        lower_bound: int,
        most: int | None,
        deadline: float,
    ) -> None:
        super().__init__(problem, options, horizon, deadline)
        self.locations = instance.locations
        self.bounds = (lower_bound, np.inf if most is None else most)

    def _detours(self) -> None:
        super()._detours()
        shape = (len(self.problem.blocks), len(self.locations), LEVELS, self.horizon)
        self.comes = self._new(shape)
        self.goes = self._new(shape)
        self.rests = self._new(shape)
        self._come_and_go()
        self._pile_up()
        for place, location in enumerate(self.locations):
            self._keep_off(place, location)
        self._cost()

    def _new(self, shape: tuple[int, ...]) -> Ints:
        return self.milp.add_columns(int(np.prod(shape)), integral=True).reshape(shape)

    def _come_and_go(self) -> None:
        blocks, _, _, layers = self.comes.shape
        for block in range(blocks):
            for layer in range(layers):
                for kind, parts in (("aside", self.comes), ("from_aside", self.goes)):
                    edge = self.edges[kind][block, layer]
                    columns = parts[block, :, :, layer].ravel()
                    whole = [edge] if edge >= 0 else []
                    self.milp.add_row([*columns, *whole], [*[1] * len(columns), *[-1] * len(whole)], lower=0, upper=0)
        size = self.rests[..., 1:].size
        rows = np.arange(size)
        now, before = self.rests[..., 1:].ravel(), self.rests[..., :-1].ravel()
        comes, goes = self.comes[..., 1:].ravel(), self.goes[..., 1:].ravel()
        self.milp.add_rows(
            np.concatenate([rows] * 4),
            np.concatenate([now, before, comes, goes]),
            np.repeat([1.0, -1.0, -1.0, 1.0], size),
            count=size,
            lower=0,
            upper=0,
        )
        first, came = self.rests[..., 0].ravel(), self.comes[..., 0].ravel()
        rows = np.arange(len(first))
        self.milp.add_rows(
            np.concatenate([rows, rows]),
            np.concatenate([first, came]),
            np.repeat([1.0, -1.0], len(first)),
            count=len(first),
            lower=0,
            upper=0,
        )

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
        filled = dict(self.problem.chains).get(location, ())
        emptied = dict(self.problem.piles).get(location, ())
        for layer in range(self.horizon):
            actions = self._actions_on(location, filled, emptied, layer)
            moves = [*self.comes[:, place, :, layer].ravel(), *self.goes[:, place, :, layer].ravel()]
            self.milp.add_row([*actions, *moves], [1] * (len(actions) + len(moves)), upper=1)
            if layer and actions:
                resting = self.rests[:, place, 0, layer - 1]
                self.milp.add_row([*actions, *resting], [1] * (len(actions) + len(resting)), upper=1)

    def _cost(self) -> None:
        columns = [
            (c, 2.0) for kind in ("direct", "aside", "from_aside", "from_table") for c in self.edges[kind].ravel()
        ]
        columns += [(c, 1.0) for cuts in self.topples.values() for c in cuts.ravel()]
        there = [(column, value) for column, value in columns if column >= 0]
        lower, upper = self.bounds
        self.milp.add_row([c for c, _ in there], [v for _, v in there], lower=lower, upper=upper)


def read_resting(model: RestingModel, locations: tuple[str, ...], vector: Floats) -> list[Event]:
    """Return the edges that a solution takes, those to a resting place with its location."""
    events = []
    for event in read_events(model.layered, vector):
        if event.kind == "aside":
            place = int(np.argwhere(vector[model.comes[event.subject, :, :, event.layer]] > 0.5)[0][0])
            events.append(Event(event.layer, event.kind, event.subject, locations[place]))
        else:
            events.append(event)
    return events
