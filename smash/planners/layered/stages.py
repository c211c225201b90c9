"""The methods of `smash-layered` for pick, place and topple at unit costs: the contracted gadget, then positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial

from smash.planners.layered.blocks import MovingBlocks
from smash.planners.layered.events import TRANSFER_COST, LayeredModel, build_layered, read_events
from smash.planners.layered.horizons import Cheaper, enough_layers, short_layers, sound_layers
from smash.planners.layered.packing import Packing
from smash.planners.layered.plain_positions import PlainPositions, build_plain_positions
from smash.planners.layered.positions import read_positions
from smash.planners.layered.resting import RestingModel, build_resting, read_resting
from smash.planners.milp.arrays import Floats
from smash.planners.milp.solving import Solving, Stage, whole
from smash.planners.protocol import Settings, SolveLog
from smash.problem.model import Action
from smash.problem.problem import Problem

EVENT_SECONDS = 2e-4
"""Generous estimate of the time to build and load the rows of one block in one layer (at one place)."""
POSITION_SECONDS = 1e-3
"""The same for a position: the solver's presolve, which keeps to no limit, takes most of it."""
ORIGIN = "layered relaxation"


@dataclass
class ContractedStages:
    """The methods of one solve.

    Attributes:
        problem: what is planned.
        settings: the solver's, and a horizon where one is chosen.
    """

    problem: Problem
    settings: Settings

    @cached_property
    def blocks(self) -> MovingBlocks:
        """The moving blocks."""
        return MovingBlocks.of(self.problem)

    @cached_property
    def horizons(self) -> list[int]:
        """The horizons of the relaxation: the chosen one, or a short and the sound one, in that order."""
        chosen = self.settings.horizon
        return [chosen] if chosen else sorted({short_layers(self.blocks), sound_layers(self.blocks)})

    def first_model(self) -> LayeredModel:
        """Return the relaxation at the last of its horizons."""
        return build_layered(self.problem, self.blocks, self.horizons[-1])

    def moves(self, _problem: Problem, log: SolveLog, _until: float) -> None:
        """Bound the cost of every plan by the moves of misplaced blocks."""
        log.prove(TRANSFER_COST * len(self.blocks.placed), "each misplaced block moves")

    def relaxations(self, _problem: Problem, log: SolveLog, until: float) -> None:
        """Unbounded buffers: a bound where the horizon is sound, and plans where the blocks find places to rest."""
        solving = Solving(self.settings, log, until)

        def decode(model: LayeredModel, vector: Floats) -> Sequence[Action] | None:
            return Packing(self.problem, self.blocks, read_events(model, vector)).actions()

        for horizon in self.horizons:
            if solving.done():
                return
            build = partial(build_layered, self.problem, self.blocks, horizon)
            estimate = len(self.blocks) * horizon * EVENT_SECONDS
            result = solving.run(Stage("unbounded buffers", build, decode, horizon, estimate=estimate))
            bound = None if result is None or horizon < sound_layers(self.blocks) else whole(result.bound)
            if bound is not None:
                log.conclude(bound, ORIGIN)

    def why_not_resting(self, _problem: Problem) -> str | None:
        """Take problems whose goal names locations."""
        return None if self.blocks.located else "a goal chain may be built anywhere"

    def resting(self, _problem: Problem, log: SolveLog, until: float) -> None:
        """The locations that there are, each block moved at most twice."""
        horizon, locations = self.horizons[-1], self.problem.instance.locations

        def decode(model: RestingModel, vector: Floats) -> Sequence[Action] | None:
            return Packing(self.problem, self.blocks, read_resting(model, locations, vector)).actions()

        build = partial(build_resting, self.problem, self.blocks, horizon, log.bound or 0, log.cost)
        estimate = len(self.blocks) * horizon * len(locations) * EVENT_SECONDS
        Solving(self.settings, log, until).run(Stage("resting places", build, decode, horizon, estimate=estimate))

    def positions(self, _problem: Problem, log: SolveLog, until: float) -> None:
        """Solve the model with every resting place at growing horizons."""
        cells = len(self.blocks) ** 2 * len(self.problem.instance.locations)

        def stage(horizon: int, bound: int, best: int | None) -> Stage[PlainPositions]:
            build = partial(build_plain_positions, self.problem, horizon, bound, best)
            estimate = cells * horizon * POSITION_SECONDS
            return Stage("positions", build, partial(read_positions, self.problem), horizon, estimate=estimate)

        Cheaper(stage, lambda: enough_layers(self.blocks, log.cost)).grow(
            Solving(self.settings, log, until), short_layers(self.blocks)
        )
