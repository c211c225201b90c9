"""Solves flow models of growing horizon: a short one for plans, then one that holds every cheaper plan.

What a horizon of T steps proves: no plan is cheaper than the model's bound unless it needs more than T steps, and
every plan of cost c or less fits into `StepBound.steps(c)` steps. So the bound that counts is the smaller of the
model's and of c + 1, c the largest cost whose plans all fit.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from smash.gadget.decode import decode
from smash.planners.flow.arcs import count_arcs, reaches_of
from smash.planners.flow.horizon import step_bound
from smash.planners.flow.model import FlowModel, build
from smash.planners.flow.scope import scope_of
from smash.planners.flow.warm import motion_of
from smash.planners.milp.arrays import Floats, MilpResult
from smash.planners.milp.solving import Solving, Stage, whole
from smash.planners.protocol import Settings, SolveLog, left
from smash.problem.errors import SmashError
from smash.problem.model import Action, Instance
from smash.problem.problem import Problem
from smash.problem.rules import Law

MOST_ARCS = 1_500_000
"""Arcs beyond which a model is not built: it would need some 10 GB and no solver would start on it in time."""
ARCS_PER_SECOND = 100_000
"""Arcs that are at least built in a second; a model that would take half the time left is not begun."""
MOST_EDGES = 4_000_000
"""Edges of the gadget times pebbles beyond which the gadget itself is not walked through."""
EDGES_PER_SECOND = 300_000
"""Such edges that are at least looked at in a second; a gadget that would take half the time left is not begun."""

OPTIONS = {"highs": {"presolve_rule_off": 1 << 15}}
"""HiGHS' presolve without probing, which costs more than it brings here: seconds before the first incumbent."""
LINEAR = {"cpsat": {"linearization_level": 2}}
"""CP-SAT with all rows in its LPs: it proves in half the time, and finds plans of its own later."""
CLIMBING = frozenset({"cpsat"})
"""Solvers that settle the shortest horizons in no time: they begin there and go up. With topple a step at a time, each
time from the best plan so far. Without, plans of the shortest horizons are far from the cheapest and lead
nowhere: after some steps it is a jump, and each horizon is begun anew. Other solvers begin where most plans fit, for
they find none in a tight horizon."""
STEPS_BEFORE_JUMP = 2
"""Steps beyond the first horizon with a plan that are taken one by one; then one is left out."""
CLIMB_SECONDS, ANEW_SECONDS = 5.0, 10.0
"""For a horizon beyond the first with a plan, or begun anew, of a solver that climbs: whatever the budget is, so
that what it finds within it is what it finds with less."""


class TooLarge(SmashError):
    """The flow model is too large to build."""

    exit_code = 6


class FlowSearch:
    """One solve: models of growing horizon; the log takes the plans and the bounds.

    Bounds come from `moves` (each misplaced block moves once) or `milp`.
    """

    def __init__(self, problem: Problem, settings: Settings, log: SolveLog, until: float) -> None:
        """Work out the gadget and what each pebble may reach.

        Args:
            problem: what is planned.
            settings: the solver's, and a horizon where one is chosen.
            log: takes plans and bounds.
            until: when to end [s, clock of `perf_counter`].

        Raises:
            TooLarge: where the gadget is too large to look at.
        """
        check_gadget_size(problem.instance, left(until))
        self.problem = problem
        self.log = log
        self.horizon = settings.horizon
        self.solving = Solving(settings, log, until)
        self.scope = scope_of(problem)
        self._law = Law(self.scope.instance, problem.options, problem.kinds)  # idle buffers change no kind
        self.bound = step_bound(problem, self.scope)
        self.reaches = reaches_of(self.scope)
        self._first_with_plan = 0
        log.prove(self.bound.least_cost, "moves")

    def first_horizon(self) -> int:
        """Return the horizon that plans are looked for with.

        It is the longest way of a pebble, a step per move, a topple, and a third of the moves more: with less slack
        the solver's heuristics often find no first plan, with more the models grow.
        """
        shortest = max(reach.shortest for reach in self.reaches.values())
        moves = self.bound.moves or len(self.scope.moving)
        horizon = max(1, shortest + moves + moves // 3 + (2 if self.scope.gadget.staging else 0))
        return horizon if self.log.best is None else max(horizon, self._steps_of_best())

    def shortest_horizon(self) -> int:
        """Return the longest way of a pebble alone: no plan needs fewer steps."""
        return max(1, *(reach.shortest for reach in self.reaches.values()))

    def run(self) -> None:
        """Solve until proven, out of time, or, with a given horizon, once.

        Raises:
            TooLarge: where a model cannot be built.
        """
        horizon = self.horizon or (self.shortest_horizon() if self._climbs else self.first_horizon())
        while not self.solving.done():
            patient = not self._climbs or self.log.cost is None
            seconds = math.inf if patient else ANEW_SECONDS if self._begins_anew(horizon) else CLIMB_SECONDS
            result = self._solve(horizon, seconds)
            if result is None or self.horizon is not None:
                return
            if result.status not in ("optimal", "infeasible") and not (self._climbs and self.log.cost is not None):
                return
            if patient:
                self._first_with_plan = horizon
            horizon = self._next_horizon(horizon)
        if not self.log.details.get("stages"):
            self.log.details["stopped"] = f"the time was up before the model of horizon {horizon} was begun"

    @property
    def _climbs(self) -> bool:
        return self.solving.settings.solver in CLIMBING and self.horizon is None

    @property
    def _topples(self) -> bool:
        return bool(self.scope.gadget.staging)

    def _begins_anew(self, horizon: int) -> bool:
        """Whether a solver that climbs gets no plan to start from."""
        return self._climbs and not self._topples and horizon > self._first_with_plan + STEPS_BEFORE_JUMP

    def _next_horizon(self, horizon: int) -> int:
        if self._climbs:
            jumps = not self._topples and horizon == self._first_with_plan + STEPS_BEFORE_JUMP
            return horizon + (2 if jumps else 1)
        if self.log.cost is None:
            return horizon + max(2, horizon // 4)
        return max(horizon + 1, self.bound.steps(self.log.cost - 1))

    def model(self, horizon: int) -> FlowModel:
        """Build the model of a horizon.

        Raises:
            TooLarge: where it has too many arcs for the memory or the time left.
        """
        arcs = count_arcs(self.scope, self.reaches, horizon)
        most = min(MOST_ARCS, ARCS_PER_SECOND * left(self.solving.until) / 2)
        if arcs > most:
            raise TooLarge(f"the flow model has {arcs:,} arcs at horizon {horizon}; at most {most:,.0f} are built here")
        return build(self.scope, self.reaches, horizon)

    def _solve(self, horizon: int, seconds: float) -> MilpResult | None:
        anew = self._begins_anew(horizon)
        stage = Stage(
            name="flow",
            build=lambda _until: self.model(horizon),
            decode=self._decode,
            horizon=horizon,
            most=seconds,
            start=None if anew else self._start,
            options=OPTIONS if anew else OPTIONS | LINEAR,
        )
        result = self.solving.run(stage)
        if result is not None:
            self._raise_bound(horizon, result)
        return result

    def _decode(self, model: FlowModel, vector: Floats) -> Sequence[Action]:
        return decode(model.motion(vector), self._law)

    def _start(self, model: FlowModel) -> Floats | None:
        return None if self.log.best is None else model.vector(motion_of(self.problem, self.scope, self.log.best))

    def _steps_of_best(self) -> int:
        return motion_of(self.problem, self.scope, self.log.best or ()).steps

    def _raise_bound(self, horizon: int, result: MilpResult) -> None:
        """Take the model's bound as far as the horizon holds all plans below it."""
        most = self.log.cost if self.log.cost is not None else self._most_in(horizon)
        fits = self.bound.fitting_cost(horizon, most) + 1
        proven = None if result.status == "infeasible" else whole(result.bound)
        self.log.conclude(fits if result.status == "infeasible" else min(fits, proven or 0), "milp")

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
