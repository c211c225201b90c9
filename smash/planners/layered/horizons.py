"""How many layers a model gets: few for first plans, enough for every plan, and the growing ones in between."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic

from smash.planners.layered.blocks import MovingBlocks
from smash.planners.milp.arrays import MilpResult
from smash.planners.milp.solving import Model, Solving, Stage, whole

DETOURS = 2
"""Layers of the contracted gadget beside those that empty and fill."""


def direct_layers(blocks: MovingBlocks) -> int:
    """Return layers that empty the highest pile, by one topple if it can fall, and then fill the longest chain."""
    highest = max((1 if at in blocks.toppled else len(pile) for at, pile in blocks.piles), default=0)
    return highest + max((len(chain) for _, chain in blocks.chains), default=0)


def sound_layers(blocks: MovingBlocks) -> int:
    """Return layers that hold every plan of the contracted gadget: one for each removal and each placement."""
    return max(1, len(blocks) - len(blocks.lying) + len(blocks.placed))


def short_layers(blocks: MovingBlocks) -> int:
    """Return layers of the contracted gadget that plans of few detours fit."""
    return min(sound_layers(blocks), direct_layers(blocks) + DETOURS)


def enough_layers(blocks: MovingBlocks, cost: int | None) -> int | None:
    """Return layers that hold every plan of transfers and topples that costs less than `cost`; None: not known.

    Such a plan has at least as many transfers, at 2 each, as there are blocks to place; the rest may be topples.
    """
    if cost is None:
        return None
    return cost - 1 - len(blocks.placed) if blocks.toppled else (cost - 1) // 2


@dataclass(frozen=True, slots=True)
class Cheaper(Generic[Model]):
    """A model at any horizon, whose solutions are the plans that are cheaper than the best one and fit it.

    Attributes:
        stage: the stage of (a horizon, a bound on the cost as a row, the cost of the best plan).
        enough: asked for layers that hold every plan cheaper than the best one, None: not known.
    """

    stage: Callable[[int, int, int | None], Stage[Model]]
    enough: Callable[[], int | None]

    def solve(self, solving: Solving, horizon: int) -> MilpResult | None:
        """Solve the model at a horizon; None where it takes too long to build.

        Where the horizon holds every plan cheaper than the best one, what bounds the solutions bounds all plans.
        """
        log = solving.log
        best, bound, enough = log.cost, log.bound or 0, self.enough()
        stage = self.stage(horizon, bound, best)
        result = solving.run(stage)
        if result is not None and best is not None and enough is not None and horizon >= enough:
            least = best if result.status == "infeasible" else whole(result.bound)
            if least is not None:
                log.conclude(min(best, least), f"layered {stage.name} at a horizon of {horizon}")
        return result

    def grow(self, solving: Solving, first: int) -> None:
        """Solve at growing horizons until one holds every cheaper plan; at the settings' alone where they have one."""
        chosen = solving.settings.horizon
        horizon = chosen or first
        while not solving.done():
            enough = self.enough()
            if solving.done():
                return
            if enough is not None and chosen is None:
                horizon = min(horizon, enough)
            result = self.solve(solving, horizon)
            if result is None or result.status not in ("optimal", "infeasible") or chosen is not None:
                return
            horizon += max(2, horizon // 4)
