"""`smash-layered`: the contracted gadget as a MILP, layer by layer, with proofs that no horizon has to be taken for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from math import ceil, isfinite
from time import perf_counter
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from smash.planners.protocol import IncumbentLog, OnIncumbent, PlanResult, ProblemPlanner, Settings, SolveOptions
from smash.problem.model import Action, Instance
from smash.problem.plan import Plan
from smash.problem.problem import Problem

if TYPE_CHECKING:
    from smash.planners.layered.events import LayeredProblem
    from smash.planners.milp.arrays import Floats, Milp, MilpResult, MilpStatus

Model = TypeVar("Model")

SPARE_SECONDS = 0.05
"""Kept back from the budget for the solver to end and the last plan to be checked."""
EVENT_SECONDS = 2e-4
"""Generous estimate of the time to build and load the rows of one block in one layer (at one place)."""
POSITION_SECONDS = 1e-3
"""The same for a position: the solver's presolve, which keeps to no limit, takes most of it."""
BUILD_SHARE = 0.6
"""Share of the time left that the building of a model may take: what takes longer is not solved in the rest."""
BOUND_ORIGIN = "layered relaxation"


class LayeredPlanner(ProblemPlanner):
    """The SMASH gadget with its free chain edges contracted, buffers first unbounded, then as many as there are.

    With unbounded buffers and a horizon that holds every plan, the model's optimum bounds the cost of all plans; a
    solution of that cost whose blocks find a place to rest is optimal. A short horizon comes first: it proves
    nothing, and gives the first plans. Instances with carry, lift or costs have a model of their own (`family`).
    """

    summary: ClassVar[str] = "the SMASH gadget with its free chain edges contracted, as a MILP (HiGHS)"
    proves: ClassVar[bool] = True
    aggregating: ClassVar[frozenset[str]] = frozenset({"topple", "carry", "lift"})
    weighs: ClassVar[bool] = True

    def prepare(self) -> None:
        """Load the solver and the arrays, so that no import is counted as planning."""
        import highspy  # noqa: F401

        from smash.planners.layered import events, packing  # noqa: F401
        from smash.planners.milp.solvers import highs  # noqa: F401

    def plan(
        self, problem: Problem, settings: Settings, budget: float, on_incumbent: OnIncumbent | None = None
    ) -> Plan:
        """Plan for at most `budget` seconds of wall time."""
        instance, options = problem.instance, SolveOptions.of(problem.options, settings)
        log = IncumbentLog(instance, options, on_incumbent, gentle=problem.plain)
        impossible = log.without_plan()
        if impossible is not None:
            return impossible.as_plan(instance, "", options)
        if not problem.plain:
            from smash.planners.layered.family.solve import FamilySolve

            return FamilySolve(instance, options, budget, log, self.solve).run().as_plan(instance, "", options)
        return _Solve(instance, options, budget, log).run().as_plan(instance, "", options)

    def build_model(self, instance: Instance, options: SolveOptions) -> Milp:
        """Return the MILP of the relaxation at the sound horizon (of the family: a short one), or `horizon`."""
        if not Problem(instance, options).plain:
            from smash.planners.layered.family.solve import first_model

            return first_model(instance, options)
        from smash.planners.layered.events import LayeredProblem, build_layered

        problem = LayeredProblem.of(instance, options)
        return build_layered(problem, options, options.horizon or problem.sound_horizon).milp


class _Solve:
    """One solve: the stages, one after the other, until the bound meets the best plan or the budget is spent."""

    def __init__(self, instance: Instance, options: SolveOptions, budget: float, log: IncumbentLog) -> None:
        from smash.planners.layered.events import LayeredProblem

        self.instance = instance
        self.options = options
        self.log = log
        self.deadline = perf_counter() + budget - min(SPARE_SECONDS, budget / 10) - log.elapsed
        self.problem: LayeredProblem = LayeredProblem.of(instance, options)
        self.details: dict[str, Any] = {"stages": []}

    def run(self) -> PlanResult:
        from smash.planners.layered.events import TRANSFER_COST

        if self.problem.demands.met:
            self.log.offer((), "milp")
            self.log.prove(0, "start")
            return self.log.result()
        self.log.prove(TRANSFER_COST * len(self.problem.placed), "each misplaced block moves")
        if self.options.warm_start is not None:
            self._warm_start(self.options.warm_start)
        sound = self.problem.sound_horizon
        chosen = self.options.horizon
        horizons = [self.problem.short_horizon(), sound] if chosen is None else [chosen]
        for horizon in sorted(set(horizons)):
            self._relaxation_stage(horizon, proves=horizon >= sound)
        if all(location is not None for location, _ in self.problem.chains):
            self._resting_stage(max(horizons))
        self._positions(chosen)
        return self.log.result(details=self.details)

    def _buildable(self, horizon: int, places: int, seconds_a_cell: float = EVENT_SECONDS) -> bool:
        """Whether a model of so many cells can be built in the time left; says so in the details where not."""
        cells = len(self.problem.blocks) * horizon * places
        if cells * seconds_a_cell < self.deadline - perf_counter():
            return True
        self.details["stages"].append({"horizon": horizon, "skipped": f"{cells} cells take too long to build"})
        return False

    def _built(self, horizon: int, build: Callable[[float], Model]) -> Model | None:
        """Return what `build` makes, or None where it takes more than its share of the time left."""
        from smash.planners.milp.arrays import OutOfTime

        now = perf_counter()
        try:
            return build(now + BUILD_SHARE * (self.deadline - now))
        except OutOfTime:
            seconds = round(perf_counter() - now, 4)
            self.details["stages"].append({"horizon": horizon, "skipped": "took too long to build", "seconds": seconds})
            return None

    def _done(self) -> bool:
        return self.log.proven or perf_counter() >= self.deadline

    def _warm_start(self, name: str) -> None:
        """Take the first plan from another planner, for a tenth of the time left."""
        from smash.planners.registry import get_planner

        seconds = max(0.05, (self.deadline - perf_counter()) / 10)
        options = replace(self.options, warm_start=None, horizon=None)
        found = get_planner(name).solve(self.instance, options, seconds)
        if found.actions is not None:
            self.log.offer(found.actions, name)

    def _relaxation_stage(self, horizon: int, *, proves: bool) -> None:
        """Unbounded buffers: a bound where the horizon is sound, and plans where the blocks find places to rest."""
        from smash.planners.layered.events import build_layered, read_events
        from smash.planners.layered.packing import Packing

        if self._done() or not self._buildable(horizon, 1):
            return
        model = self._built(horizon, partial(build_layered, self.problem, self.options, horizon))
        if model is None:
            return

        def decode(vector: Floats) -> Sequence[Action] | None:
            return Packing(self.instance, self.problem, read_events(model, vector)).actions()

        result = self._run(horizon, "unbounded", model.milp, decode)
        if proves and isfinite(result.bound):
            self.log.prove(ceil(result.bound - 1e-6), BOUND_ORIGIN)

    def _resting_stage(self, horizon: int) -> None:
        """The locations that there are, each block moved at most twice."""
        from smash.planners.layered.packing import Packing
        from smash.planners.layered.resting import build_resting, read_resting

        if self._done() or not self._buildable(horizon, len(self.instance.locations)):
            return
        most = None if self.log.cost is None else self.log.cost - 1
        bound = self.log.bound or 0
        build = partial(build_resting, self.instance, self.problem, self.options, horizon, bound, most)
        model = self._built(horizon, build)
        if model is None:
            return

        def decode(vector: Floats) -> Sequence[Action] | None:
            events = read_resting(model, self.instance.locations, vector)
            return Packing(self.instance, self.problem, events).actions()

        self._run(horizon, "resting places", model.layered.milp, decode)

    def _run(
        self, horizon: int, buffers: str, model: Milp, decode: Callable[[Floats], Sequence[Action] | None]
    ) -> MilpResult:
        """Solve a stage's model until its end, the deadline, or a plan that meets the bound."""
        from smash.planners.milp.solvers import highs

        def found(vector: Floats) -> None:
            actions = decode(vector)
            if actions is not None:
                self.log.offer(actions, "milp")

        result = highs.solve(
            model,
            time_limit=self.deadline - perf_counter(),
            threads=self.options.threads,
            seed=self.options.seed,
            on_solution=lambda _seconds, _objective, vector: found(vector),
            should_stop=self._done,
        )
        if result.vector is not None:
            found(result.vector)
        stage: dict[str, Any] = {"horizon": horizon, "buffers": buffers, **model.size()}
        stage |= {"status": result.status, "objective": result.objective, "seconds": round(result.seconds, 4)}
        self.details["stages"].append(stage)
        return result

    def _positions(self, chosen: int | None) -> None:
        """Solve the model with every resting place, at growing horizons, until the horizon holds every cheaper plan."""
        horizon = chosen or self.problem.short_horizon()
        while not self._done():
            enough = self._enough_layers()
            if enough is not None and chosen is None:
                horizon = min(horizon, enough)
            places = len(self.instance.locations) * len(self.problem.blocks)
            if not self._buildable(horizon, places, POSITION_SECONDS):
                return
            status = self._positions_stage(horizon)
            if status not in ("optimal", "infeasible") or chosen is not None:
                return
            if enough is not None and horizon >= enough and self.log.cost is not None:
                # No cheaper plan has more layers, and none was left at this horizon.
                self.log.prove(self.log.cost, f"layered positions at a horizon of {horizon}")
                return
            horizon += max(2, horizon // 4)

    def _enough_layers(self) -> int | None:
        """Return a number of layers that holds every plan cheaper than the best one, or None without one.

        Such a plan has at least as many transfers as there are blocks to place; the rest may be topples.
        """
        if self.log.cost is None:
            return None
        cheaper = self.log.cost - 1
        if not self.options.topple:
            return cheaper // 2
        return cheaper - len(self.problem.placed)

    def _positions_stage(self, horizon: int) -> MilpStatus:
        from smash.planners.layered.positions import build_positions, read_positions

        demands, best = self.problem.demands, self.log.cost
        bound = self.log.bound or 0
        build = partial(build_positions, self.instance, demands, self.options, horizon, bound, best)
        model = self._built(horizon, build)
        if model is None:
            return "unknown"
        decode = partial(read_positions, self.instance, model)
        return self._run(horizon, "positions", model.milp, decode).status
