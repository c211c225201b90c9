"""The methods of `smash-layered` for problems with costs, carriers or lifts: bounds without order, then layers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from math import floor, isfinite

from smash.planners.layered.horizons import Cheaper, direct_layers
from smash.planners.layered.network.decode import read_relaxed
from smash.planners.layered.network.moving import Moving
from smash.planners.layered.network.positions import NetworkPositions, build_network_positions
from smash.planners.layered.network.relaxed import RelaxedModel, build_relaxed
from smash.planners.layered.network.unordered import UnorderedModel, build_cheapest, build_longest
from smash.planners.layered.positions import read_positions
from smash.planners.milp.arrays import Floats
from smash.planners.milp.solving import Solving, Stage, whole
from smash.planners.protocol import Settings, SolveLog
from smash.problem.model import Action
from smash.problem.problem import Problem

FLOW_SHARE = 0.2
"""Share of the time left that a program without order may take."""
RELAXATION_SHARE = 0.5
"""Share of the time left that one relaxation may take."""
UNPROBED = {"highs": {"presolve": "off"}}
"""For the relaxation: HiGHS' presolve takes most of its time, keeps to no limit, and saves no search."""
ORIGIN = "layered flow without order"


@dataclass
class NetworkStages:
    """The methods of one solve, and what they tell each other.

    Attributes:
        problem: what is planned.
        settings: the solver's, and a horizon where one is chosen.
    """

    problem: Problem
    settings: Settings
    _most_actions: dict[int, int | None] = field(default_factory=dict)

    @cached_property
    def moving(self) -> Moving:
        """The moving blocks and the places."""
        return Moving.of(self.problem)

    @cached_property
    def short(self) -> int:
        """A number of layers that plans of few detours fit: empty the piles, carry, fill the longest chain."""
        carries = bool((self.moving.places.carry >= 0).any())
        return direct_layers(self.moving.blocks) + (2 if carries else 1)

    def first_model(self) -> RelaxedModel:
        """Return the relaxation at the horizon of the settings, else at a short one."""
        return build_relaxed(self.problem, self.moving, self.settings.horizon or self.short)

    def flow(self, _problem: Problem, log: SolveLog, until: float) -> None:
        """Bound the cost of every plan by the flow without order."""
        build = partial(build_cheapest, self.problem, self.moving)
        stage: Stage[UnorderedModel] = Stage("flow without order", build, None, share=FLOW_SHARE)
        result = Solving(self.settings, log, until).run(stage)
        if result is not None and result.status == "infeasible":
            log.conclude_none(ORIGIN)
        elif result is not None:
            bound = whole(result.bound)
            if bound is not None:
                log.conclude(bound, ORIGIN)

    def relaxations(self, _problem: Problem, log: SolveLog, until: float) -> None:
        """Solve the relaxation at a short horizon, for plans, then at one that holds all cheaper ones, for the bound.

        The order of what rests on one another is added where a solution without it is no plan.
        """
        solving = Solving(self.settings, log, until)
        chosen = self.settings.horizon
        ordered = False
        for sound in (False, True):
            while not solving.done():
                horizon = self._enough(solving) if sound and chosen is None else chosen or self.short
                if horizon is None or solving.done():
                    return
                result = self._relaxed(solving, ordered=ordered).solve(solving, horizon)
                met = result is None or result.objective is None or _is_met(log, result.objective)
                if ordered or met:
                    break
                ordered = True
            if chosen is not None:
                return

    def positions(self, _problem: Problem, log: SolveLog, until: float) -> None:
        """Solve the model of positions at growing horizons."""
        solving = Solving(self.settings, log, until)

        def stage(horizon: int, bound: int, best: int | None) -> Stage[NetworkPositions]:
            build = partial(build_network_positions, self.problem, horizon, bound, best)
            return Stage("positions", build, partial(read_positions, self.problem), horizon)

        Cheaper(stage, partial(self._enough, solving)).grow(solving, self.short)

    def _relaxed(self, solving: Solving, *, ordered: bool) -> Cheaper[RelaxedModel]:
        name = "ordered relaxation" if ordered else "relaxation"

        def decode(model: RelaxedModel, vector: Floats) -> Sequence[Action]:
            return read_relaxed(self.problem, model, vector)

        def stage(horizon: int, bound: int, best: int | None) -> Stage[RelaxedModel]:
            def build(until: float) -> RelaxedModel:
                return build_relaxed(self.problem, self.moving, horizon, bound, best, until, ordered=ordered)

            return Stage(name, build, decode, horizon, share=RELAXATION_SHARE, options=UNPROBED)

        return Cheaper(stage, partial(self._enough, solving))

    def _enough(self, solving: Solving) -> int | None:
        """Return a number of layers that holds a cheapest plan, if it is cheaper than the best; None: not known."""
        log, best = solving.log, solving.log.cost
        if best is None:
            return None
        if best not in self._most_actions:
            build = partial(build_longest, self.problem, self.moving, best)
            stage: Stage[UnorderedModel] = Stage("most actions", build, None, share=FLOW_SHARE)
            result = solving.run(stage)
            if result is None:
                return None
            if result.status == "infeasible":
                log.conclude(best, ORIGIN)
            most = -result.bound if isfinite(result.bound) else None
            self._most_actions[best] = None if most is None else max(1, floor(most + 1e-6))
        return self._most_actions[best]


def _is_met(log: SolveLog, objective: float) -> bool:
    """Whether a solution of this cost was a plan."""
    return log.cost is not None and log.cost <= objective + 0.5
