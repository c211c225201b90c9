"""One solve of an instance with further aggregating actions or costs: models at growing horizons."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import ceil, floor, isfinite
from time import perf_counter
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from smash.planners.layered.family.moving import Moving
from smash.planners.layered.family.places import Places
from smash.planners.layered.family.unordered import Unordered
from smash.planners.protocol import IncumbentLog, OnIncumbent, PlanResult, SolveOptions
from smash.problem.model import Action, Instance
from smash.problem.problem import Problem
from smash.problem.views.demands import Demands, demands_of

if TYPE_CHECKING:
    from smash.planners.layered.family.model import FamilyModel
    from smash.planners.layered.family.relaxed import RelaxedModel
    from smash.planners.milp.arrays import Floats, Milp, MilpResult

SPARE_SECONDS = 0.05
"""Kept back from the budget for the solver to end and the last plan to be checked."""
BUILD_SHARE = 0.6
"""Share of the time left that the building of a model may take."""
FLOW_SHARE = 0.2
"""Share of the time left that a program without order may take."""
TWIN_SHARE = 0.1
"""Share of the time left for the first plans."""
RELAXATION_SHARE = 0.5
"""Share of the time left that one relaxation may take."""
UNPROBED = {"presolve": "off"}
"""For the relaxation: the solver's presolve takes most of its time, keeps to no limit, and saves no search."""
TOLERANCE = 1e-6
"""Of the solver, relative: the costs of actions may be tens of thousands."""
BOUND_ORIGIN = "layered flow without order"


def short_horizon(demands: Demands, places: Places) -> int:
    """Return a number of layers that plans of few detours fit: empty the piles, carry, fill the longest chain."""
    piles = [
        1 if number < places.toppled else len(demands.leaving[at])
        for number, at in enumerate(places.locations)
        if demands.leaving[at]
    ]
    chains = [*demands.build.values(), *(chain.blocks for chain in demands.floating)]
    longest = max((len(chain) for chain in chains), default=0)
    return max(piles, default=0) + longest + (2 if (places.carry >= 0).any() else 1)


def first_model(instance: Instance, options: SolveOptions) -> Milp:
    """Return the relaxation's MILP at a short horizon, or at `options.horizon`."""
    from smash.planners.layered.family.relaxed import build_relaxed

    demands = demands_of(instance)
    horizon = options.horizon or short_horizon(demands, Places.of(instance, options))
    return build_relaxed(instance, demands, options, horizon).milp


def _whole(bound: float) -> int:
    """Return the whole number that a solver's bound on whole costs proves, its tolerance left out."""
    return ceil(bound - TOLERANCE * max(1.0, abs(bound)))


class _Built(Protocol):
    """A model of either kind."""

    @property
    def milp(self) -> Milp: ...


Model = TypeVar("Model", bound=_Built)

Solve = Callable[[Instance, SolveOptions, float, OnIncumbent | None], PlanResult]
"""The `solve` of a planner."""


class FamilySolve:
    """Stages, one after the other, until the bound meets the best plan or the budget is spent.

    Args:
        instance: the problem.
        options: what plans may use, and the solver's settings.
        budget: seconds of wall time.
        log: takes plans and bounds.
        plain: plans instances of pick, place and topple alone: its plans of the plain twin come first.
    """

    def __init__(
        self, instance: Instance, options: SolveOptions, budget: float, log: IncumbentLog, plain: Solve
    ) -> None:
        self.instance = instance
        self.options = options
        self.log = log
        self._plain = plain
        self.deadline = perf_counter() + budget - min(SPARE_SECONDS, budget / 10) - log.elapsed
        self.demands = demands_of(instance)
        moving = Moving.of(instance, self.demands, options)
        self.places = moving.places
        self.flow = Unordered(instance, options, moving)
        self.impossible = False
        self.horizons: dict[int, int | None] = {}
        self.details: dict[str, Any] = {"stages": []}

    def run(self) -> PlanResult:
        """Solve."""
        if self.demands.met:
            self.log.offer((), "milp")
            self.log.prove(0, "start")
            return self.log.result()
        if self.options.warm_start is not None:
            self._warm_start(self.options.warm_start)
        self._flow_bound()
        if self.impossible:
            return self.log.result(infeasible=True, bound_origin=BOUND_ORIGIN, details=self.details)
        if self.options.horizon is None:
            self._twin()
        self._relaxations()
        self._grow()
        return self.log.result(details=self.details)

    def _done(self) -> bool:
        return self.log.proven or perf_counter() >= self.deadline

    def _warm_start(self, name: str) -> None:
        """Take the first plan from another planner, for a tenth of the time left."""
        from smash.planners.protocol import plan_options, settings_of, why_unsupported
        from smash.planners.registry import get_planner

        planner = get_planner(name)
        options = replace(self.options, warm_start=None, horizon=None)
        if why_unsupported(planner, Problem(self.instance, plan_options(options)), settings_of(options)) is not None:
            return
        found = planner.solve(self.instance, options, max(0.05, (self.deadline - perf_counter()) / 10))
        if found.actions is not None:
            self.log.offer(found.actions, name)

    def _twin(self) -> None:
        """Take first plans from the three-node model of the plain twin, for a share of the time left."""
        from smash.problem.views.twin import from_twin, plain_twin

        def found(_seconds: float, _cost: int, actions: Sequence[Action]) -> None:
            self.log.offer(tuple(from_twin(self.instance, actions)), "milp")

        options = replace(self.options, warm_start=None, horizon=None)
        self._plain(plain_twin(self.instance), options, TWIN_SHARE * (self.deadline - perf_counter()), found)

    def _relaxations(self) -> None:
        """Solve the relaxation at a short horizon, for plans, then at one that holds all cheaper ones, for the bound.

        The order of what rests on one another is added where a solution without it is no plan.
        """
        chosen = self.options.horizon
        short = chosen or short_horizon(self.demands, self.places)
        ordered = False
        for sound in (False, True):
            while not self._done():
                horizon = self._enough() if sound and chosen is None else short
                if horizon is None or self._done():
                    return
                result = self._relaxed_stage(horizon, ordered=ordered)
                if ordered or result is None or result.objective is None or self._is_met(result.objective):
                    break
                ordered = True
            if chosen is not None:
                return

    def _is_met(self, objective: float) -> bool:
        """Whether a solution of this cost was a plan."""
        return self.log.cost is not None and self.log.cost <= objective + 0.5

    def _grow(self) -> None:
        """Solve the model at growing horizons, until the horizon holds every cheaper plan."""
        chosen = self.options.horizon
        horizon = chosen or short_horizon(self.demands, self.places)
        while not self._done():
            enough = self._enough()
            if self._done():
                return
            if enough is not None and chosen is None:
                horizon = min(horizon, enough)
            result = self._positions_stage(horizon)
            if result is None or result.status not in ("optimal", "infeasible") or chosen is not None:
                return
            horizon += max(2, horizon // 4)

    def _flow_bound(self) -> None:
        """Bound the cost of every plan by the flow without order."""
        result = self._program("flow without order", self.flow.cheapest)
        if result is not None and result.status == "infeasible":
            self.impossible = True
        elif result is not None and isfinite(result.bound):
            self.log.prove(_whole(result.bound), BOUND_ORIGIN)

    def _enough(self) -> int | None:
        """Return a number of layers that holds a cheapest plan, if it is cheaper than the best; None: not known."""
        best = self.log.cost
        if best is None:
            return None
        if best not in self.horizons:
            result = self._program("most actions", partial(self.flow.longest, best))
            if result is None:
                return None
            if result.status == "infeasible":
                self.log.prove(best, BOUND_ORIGIN)
            most = -result.bound if isfinite(result.bound) else None
            self.horizons[best] = None if most is None else max(1, floor(most + 1e-6))
        return self.horizons[best]

    def _program(self, name: str, build: Callable[[float], Milp]) -> MilpResult | None:
        """Solve a program without order, in a share of the time left; None where it took too long to build."""
        from smash.planners.milp.arrays import OutOfTime
        from smash.planners.milp.solvers import highs

        seconds = FLOW_SHARE * (self.deadline - perf_counter())
        try:
            milp = build(perf_counter() + seconds)
        except OutOfTime:
            return None
        options = self.options
        result = highs.solve(milp, time_limit=seconds, threads=options.threads, seed=options.seed)
        self._note({"model": name, **milp.size()}, result)
        return result

    def _note(self, stage: dict[str, Any], result: MilpResult) -> None:
        outcome = {"status": result.status, "objective": result.objective, "bound": result.bound}
        self.details["stages"].append(stage | outcome | {"nodes": result.nodes, "seconds": round(result.seconds, 4)})

    def _relaxed_stage(self, horizon: int, *, ordered: bool) -> MilpResult | None:
        from smash.planners.layered.family.decode import RelaxedReader
        from smash.planners.layered.family.relaxed import build_relaxed

        def decode(model: RelaxedModel, vector: Floats) -> Sequence[Action] | None:
            return RelaxedReader(self.instance, self.options, model, vector).actions()

        build = partial(build_relaxed, ordered=ordered)
        name = "ordered relaxation" if ordered else "relaxation"
        return self._stage(horizon, name, build, decode, share=RELAXATION_SHARE, solver=UNPROBED)

    def _positions_stage(self, horizon: int) -> MilpResult | None:
        from smash.planners.layered.family.decode import read_family
        from smash.planners.layered.family.model import build_family

        def decode(model: FamilyModel, vector: Floats) -> Sequence[Action] | None:
            return read_family(self.instance, self.options, model, vector)

        return self._stage(horizon, "positions", build_family, decode)

    def _stage(
        self,
        horizon: int,
        name: str,
        build: Callable[..., Model],
        decode: Callable[[Model, Floats], Sequence[Action] | None],
        *,
        share: float = 1.0,
        solver: dict[str, str] | None = None,
    ) -> MilpResult | None:
        """Build and solve a model whose every plan is cheaper than the best one; None where building took too long."""
        from smash.planners.milp.arrays import OutOfTime
        from smash.planners.milp.solvers import highs

        now = perf_counter()
        until = now + BUILD_SHARE * (self.deadline - now)
        best, bound, enough = self.log.cost, self.log.bound or 0, self._enough()
        try:
            model = build(self.instance, self.demands, self.options, horizon, bound, best, until)
        except OutOfTime:
            self.details["stages"].append({"horizon": horizon, "skipped": "took too long to build"})
            return None

        def found(vector: Floats) -> None:
            actions = decode(model, vector)
            if actions is not None:
                self.log.offer(actions, "milp")

        result = highs.solve(
            model.milp,
            time_limit=share * (self.deadline - perf_counter()),
            threads=self.options.threads,
            seed=self.options.seed,
            options=solver,
            on_solution=lambda _seconds, _objective, vector: found(vector),
            should_stop=self._done,
        )
        if result.vector is not None:
            found(result.vector)
        self._note({"horizon": horizon, "model": name, **model.milp.size()}, result)
        if best is not None and enough is not None and horizon >= enough:
            # Every plan cheaper than `best` is a solution: what bounds the solutions, or `best`, bounds all plans.
            least = best if result.status == "infeasible" else result.bound
            if isfinite(least):
                self.log.prove(min(best, _whole(least)), f"layered {name} at a horizon of {horizon}")
        return result
