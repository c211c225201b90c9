"""Solves flow models of growing horizon: a short one for plans, then one that holds every cheaper plan.

What a horizon of T steps proves: no plan is cheaper than the model's bound unless it needs more than T steps, and
every plan of cost c or less fits into `StepBound.steps(c)` steps. So the bound that counts is the smaller of the
model's and of c + 1, c the largest cost whose plans all fit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

from smash.gadget.decode import decode
from smash.planners.flow.arcs import count_arcs, reaches_of
from smash.planners.flow.horizon import step_bound
from smash.planners.flow.model import FlowModel, build
from smash.planners.flow.scope import scope_of
from smash.planners.flow.warm import motion_of
from smash.planners.milp.arrays import Floats, MilpResult
from smash.planners.milp.solvers import highs
from smash.planners.protocol import IncumbentLog, SolveOptions
from smash.problem.errors import IllegalAction, SmashError
from smash.problem.model import Instance

MOST_ARCS = 1_500_000
"""Arcs beyond which a model is not built: it would need some 10 GB and no solver would start on it in time."""
ARCS_PER_SECOND = 100_000
"""Arcs that are at least built in a second; a model that would take half the time left is not begun."""
MOST_EDGES = 4_000_000
"""Edges of the gadget times pebbles beyond which the gadget itself is not walked through."""
EDGES_PER_SECOND = 300_000
"""Such edges that are at least looked at in a second; a gadget that would take half the time left is not begun."""

NO_PROBING = 1 << 15
"""HiGHS' presolve without probing, which costs more than it brings here: seconds before the first incumbent."""


class TooLarge(SmashError):
    """The flow model is too large to build."""

    exit_code = 6


@dataclass
class FlowSearch:
    """One solve: the models tried; `log` takes the plans and the bounds.

    Bounds come from `moves` (each misplaced block moves once) or `milp`.

    Attributes:
        details: sizes, horizons and times, for the result.
    """

    instance: Instance
    options: SolveOptions
    log: IncumbentLog
    deadline: float
    details: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_gadget_size(self.instance, self.deadline - perf_counter())
        self.scope = scope_of(self.instance, self.options)
        self.bound = step_bound(self.scope, self.options)
        self.reaches = reaches_of(self.scope)
        self.log.prove(self.bound.least_cost, "moves")
        self.details["models"] = []

    def first_horizon(self) -> int:
        """Return the horizon that plans are looked for with.

        It is the longest way of a pebble, a step per move, a topple, and a third of the moves more: with less slack
        the solver's heuristics often find no first plan, with more the models grow.
        """
        shortest = max(reach.shortest for reach in self.reaches.values())
        moves = self.bound.moves or len(self.scope.moving)
        horizon = max(1, shortest + moves + moves // 3 + (2 if self.scope.gadget.staging else 0))
        return horizon if self.log.best is None else max(horizon, self._steps_of_best())

    def run(self) -> None:
        """Solve until proven, out of time, or, with a given horizon, once.

        Raises:
            TooLarge: where the first model cannot be built.
        """
        horizon = self.options.horizon or self.first_horizon()
        while not self.log.proven and perf_counter() < self.deadline:
            try:
                result = self._solve(horizon)
            except TooLarge as error:
                if not self.details["models"]:
                    raise
                self.details["stopped"] = str(error)
                return
            if result.status not in ("optimal", "infeasible") or self.options.horizon is not None:
                return
            horizon = self._next_horizon(horizon)
        if not self.details["models"]:
            self.details["stopped"] = f"the time was up before the model of horizon {horizon} was begun"

    def _next_horizon(self, horizon: int) -> int:
        if self.log.cost is None:
            return horizon + max(2, horizon // 4)
        return max(horizon + 1, self.bound.steps(self.log.cost - 1))

    def model(self, horizon: int) -> FlowModel:
        """Build the model of a horizon.

        Raises:
            TooLarge: where it has too many arcs for the memory or the time left.
        """
        arcs = count_arcs(self.scope, self.reaches, horizon)
        most = min(MOST_ARCS, ARCS_PER_SECOND * (self.deadline - perf_counter()) / 2)
        if arcs > most:
            raise TooLarge(f"the flow model has {arcs:,} arcs at horizon {horizon}; at most {most:,.0f} are built here")
        return build(self.scope, self.reaches, horizon)

    def _solve(self, horizon: int) -> MilpResult:
        began = perf_counter()
        model = self.model(horizon)
        built = perf_counter()
        start = self._start(model)

        def report(_seconds: float, _objective: float, vector: Floats) -> None:
            self._offer(model, vector)

        result = highs.solve(
            model.milp,
            time_limit=self.deadline - perf_counter(),
            threads=self.options.threads,
            seed=self.options.seed,
            start=start,
            on_solution=report,
            should_stop=lambda: perf_counter() > self.deadline or self.log.proven,
            options={"presolve_rule_off": NO_PROBING},
        )
        if result.vector is not None:
            self._offer(model, result.vector)
        self._raise_bound(horizon, result)
        self.details["models"].append(
            {
                "horizon": horizon,
                **model.milp.size(),
                "build_seconds": round(built - began, 3),
                "solve_seconds": round(result.seconds, 3),
                "nodes": result.nodes,
                "status": result.status,
                "started_from_a_plan": start is not None,
            }
        )
        return result

    def _offer(self, model: FlowModel, vector: Floats) -> None:
        try:
            self.log.offer(decode(model.motion(vector), self.scope.instance, self.options), "milp")
        except IllegalAction as error:
            self.log.refusals.append(f"milp: {error}")

    def _start(self, model: FlowModel) -> Floats | None:
        if self.log.best is None:
            return None
        return model.vector(motion_of(self.scope, self.instance, self.log.best))

    def _steps_of_best(self) -> int:
        return motion_of(self.scope, self.instance, self.log.best or ()).steps

    def _raise_bound(self, horizon: int, result: MilpResult) -> None:
        """Take the model's bound as far as the horizon holds all plans below it."""
        most = self.log.cost if self.log.cost is not None else self._most_in(horizon)
        fits = self.bound.fitting_cost(horizon, most) + 1
        proves = fits if result.status == "infeasible" else min(fits, _rounded(result.bound))
        self.log.prove(proves, "milp")

    def _most_in(self, horizon: int) -> int:
        """Return a cost that no motion of `horizon` steps exceeds."""
        gadget = self.scope.gadget
        transfer = max((edge.cost for edge in gadget.edges if edge.kind.picks), default=0)
        activation = max((aggregate.cost for aggregate in gadget.aggregates), default=0)
        return horizon * (activation + transfer * len(gadget.locations))


def check_gadget_size(instance: Instance, seconds: float = math.inf) -> None:
    """Refuse a gadget that is too large to walk through, or that would take half of the `seconds` left.

    Raises:
        TooLarge: naming its size.
    """
    blocks, locations = len(instance.blocks), len(instance.stacks) + min(len(instance.buffers), len(instance.blocks))
    edges = blocks * (2 * locations * blocks + locations * locations + blocks * locations)
    if edges > min(MOST_EDGES, EDGES_PER_SECOND * seconds / 2):
        raise TooLarge(f"the gadget of {blocks} blocks and {locations} locations has {edges:,} edges to look at")


def _rounded(bound: float) -> int:
    """Round a dual bound up: costs are whole numbers."""
    return math.ceil(bound - 1e-6) if math.isfinite(bound) else 0
