"""`smash-layered`: the contracted gadget as a MILP, layer by layer, with proofs that no horizon has to be taken for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

from smash.planners.milp.planner import MilpPlanner
from smash.planners.milp.warm_start import warm_starts
from smash.planners.protocol import (
    Method,
    Settings,
    SolveLog,
    left,
    not_plain,
    plain,
    plan_options,
    settings_of,
)
from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.problem import Problem
from smash.problem.views.twin import from_twin

if TYPE_CHECKING:
    from smash.planners.milp.arrays import Milp

WARM_SHARE = 0.1
"""Share of the budget that the planner of a warm start may take."""
TWIN_SHARE = 0.1
"""Share of the time left for the first plans of the plain twin."""


class LayeredPlanner(MilpPlanner):
    """The SMASH gadget with its free chain edges contracted, buffers first unbounded, then as many as there are.

    With unbounded buffers and a horizon that holds every plan, the model's optimum bounds the cost of all plans; a
    solution of that cost whose blocks find a place to rest is optimal. A short horizon comes first: it proves
    nothing, and gives the first plans. Problems with carry, lift or costs have models on a network of places.
    """

    summary: ClassVar[str] = "the SMASH gadget with its free chain edges contracted, as a MILP"
    proves: ClassVar[bool] = True
    aggregating: ClassVar[frozenset[str]] = frozenset({"topple", "carry", "lift"})
    weighs: ClassVar[bool] = True
    gentle: ClassVar[bool] = True

    def prepare(self) -> None:
        """Load the arrays and the models, so that no import is counted as planning."""
        from smash.planners.layered import stages  # noqa: F401
        from smash.planners.layered.network import stages as network_stages  # noqa: F401

    def methods(self, problem: Problem, settings: Settings) -> Sequence[Method]:
        """Return the stages of the contracted gadget, and those of the network of places."""
        from smash.planners.layered.network.stages import NetworkStages
        from smash.planners.layered.stages import ContractedStages

        contracted, network = ContractedStages(problem, settings), NetworkStages(problem, settings)

        def twin(problem: Problem, log: SolveLog, until: float) -> None:
            """Take first plans from the plain twin."""

            def found(_seconds: float, _cost: int, actions: Sequence[Action]) -> None:
                log.offer(tuple(from_twin(problem.instance, actions)), "milp")

            self.plan(problem.twin, settings.cold, left(until), found)

        def twin_serves(problem: Problem) -> str | None:
            return not_plain(problem) if settings.horizon is None else "the horizon is chosen"

        return (
            Method("moves", plain, contracted.moves),
            *warm_starts(settings, WARM_SHARE),
            Method("relaxation", plain, contracted.relaxations),
            Method("resting places", lambda p: plain(p) or contracted.why_not_resting(p), contracted.resting),
            Method("positions", plain, contracted.positions),
            Method("flow without order", not_plain, network.flow),
            Method("plain twin", twin_serves, twin, TWIN_SHARE),
            Method("relaxation of the network", not_plain, network.relaxations),
            Method("positions of the network", not_plain, network.positions),
        )

    def build_model(self, instance: Instance, options: PlanOptions) -> Milp:
        """Return the MILP that planning starts with: a relaxation at the horizon of `options`.

        Without one it is the sound horizon of the contracted gadget, a short one of the network of places.
        """
        from smash.planners.layered.network.stages import NetworkStages
        from smash.planners.layered.stages import ContractedStages

        problem, settings = Problem(instance, plan_options(options)), settings_of(options)
        models = (
            (plain, ContractedStages(problem, settings).first_model),
            (not_plain, NetworkStages(problem, settings).first_model),
        )
        return next(first().milp for takes, first in models if takes(problem) is None)
