"""`smash-layered`: the contracted gadget as a MILP, layer by layer, with proofs that no horizon has to be taken for."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from time import perf_counter
from typing import TYPE_CHECKING, Any, ClassVar

from smash.planners.protocol import BasePlanner, IncumbentLog, OnIncumbent, PlanResult, SolveOptions
from smash.problem.feasibility import why_infeasible
from smash.problem.model import Action, Instance

if TYPE_CHECKING:
    from smash.planners.layered.events import LayeredModel, LayeredProblem
    from smash.planners.milp import Floats, Milp

SPARE_SECONDS = 0.05
"""Kept back from the budget for the solver to end and the last plan to be checked."""
BOUND_ORIGIN = "layered relaxation"


class LayeredPlanner(BasePlanner):
    """The SMASH gadget with its free chain edges contracted, buffers first unbounded, then as many as there are.

    With unbounded buffers and a horizon that holds every plan, the model's optimum bounds the cost of all plans; a
    solution of that cost whose blocks find a place to rest is optimal. A short horizon comes first: it proves
    nothing, and gives the first plans.
    """

    summary: ClassVar[str] = "the SMASH gadget with its free chain edges contracted, as a MILP (HiGHS)"
    proves: ClassVar[bool] = True

    def prepare(self) -> None:
        """Load the solver and the arrays, so that no import is counted as planning."""
        import highspy  # noqa: F401
        import scipy.sparse  # noqa: F401

        from smash.planners import highs  # noqa: F401
        from smash.planners.layered import events, packing  # noqa: F401

    def solve(
        self,
        instance: Instance,
        options: SolveOptions,
        budget: float,
        on_incumbent: OnIncumbent | None = None,
    ) -> PlanResult:
        """Plan for at most `budget` seconds of wall time."""
        log = IncumbentLog(instance, options, on_incumbent)
        reason = why_infeasible(instance, options)
        if reason is not None:
            return log.result(infeasible=True, bound_origin="feasibility", details={"reason": reason})
        return _Solve(instance, options, budget, log).run()

    def build_model(self, instance: Instance, options: SolveOptions) -> Milp:
        """Return the MILP at the sound horizon (or `options.horizon`) with the buffers that there are."""
        from smash.planners.layered.events import LayeredProblem, build_layered

        problem = LayeredProblem.of(instance, options)
        horizon = options.horizon or problem.sound_horizon
        occupied = {at: len(instance.start[at]) for at in instance.buffers if instance.start[at]}
        return build_layered(problem, options, horizon, buffers=len(instance.buffers), occupied=occupied).milp


class _Solve:
    """One solve: the stages, one after the other, until the bound meets the best plan or the budget is spent."""

    def __init__(self, instance: Instance, options: SolveOptions, budget: float, log: IncumbentLog) -> None:
        from smash.planners.layered.events import LayeredProblem

        self.instance = instance
        self.options = options
        self.log = log
        self.deadline = perf_counter() + budget - min(SPARE_SECONDS, budget / 10) - log.elapsed
        self.problem: LayeredProblem = LayeredProblem.of(instance, options)
        self.bound = 0
        self.details: dict[str, Any] = {"stages": []}
        self._unpacked = 0

    def run(self) -> PlanResult:
        if self.problem.demands.met:
            self.log.offer((), "milp")
            return self.log.result(lower_bound=0, bound_origin="start")
        if self.options.warm_start is not None:
            self._warm_start(self.options.warm_start)
        sound = self.problem.sound_horizon
        chosen = self.options.horizon
        horizons = [self.problem.short_horizon(), sound] if chosen is None else [chosen]
        for horizon in sorted(set(horizons)):
            self._stage(horizon, proves=horizon >= sound, limited=False)
        if self._unpacked and not self._done():
            self._stage(max(horizons), proves=False, limited=True)
        return self.log.result(lower_bound=self.bound, bound_origin=BOUND_ORIGIN, details=self.details)

    def _done(self) -> bool:
        return (self.log.cost is not None and self.log.cost <= self.bound) or perf_counter() >= self.deadline

    def _warm_start(self, name: str) -> None:
        """Take the first plan from another planner, for a tenth of the time left."""
        from smash.planners.registry import get_planner

        seconds = max(0.05, (self.deadline - perf_counter()) / 10)
        found = get_planner(name).solve(self.instance, self.options, seconds)
        if found.actions is not None:
            self.log.offer(found.actions, name)

    def _stage(self, horizon: int, *, proves: bool, limited: bool) -> None:
        """Build and solve one model; `limited`: with as many buffers as there are."""
        from smash.planners import highs
        from smash.planners.layered.events import build_layered

        if self._done():
            return
        occupied = {at: len(self.instance.start[at]) for at in self.instance.buffers if self.instance.start[at]}
        model = build_layered(
            self.problem,
            self.options,
            horizon,
            buffers=len(self.instance.buffers) if limited else None,
            occupied=occupied,
        )

        def found(_seconds: float, _objective: float, vector: Floats) -> None:
            self._offer(model, vector)

        result = highs.solve(
            model.milp,
            time_limit=self.deadline - perf_counter(),
            threads=self.options.threads,
            seed=self.options.seed,
            on_solution=found,
            should_stop=self._done,
            cutoff=None if self.log.cost is None or not limited else self.log.cost - 0.5,
        )
        if result.vector is not None:
            self._offer(model, result.vector)
        stage: dict[str, Any] = {
            "horizon": horizon,
            "buffers": "limited" if limited else "unbounded",
            **model.milp.size(),
        }
        stage |= {"status": result.status, "objective": result.objective, "seconds": round(result.seconds, 4)}
        self.details["stages"].append(stage)
        if proves:
            self.bound = max(self.bound, ceil(result.bound - 1e-6))

    def _offer(self, model: LayeredModel, vector: Floats) -> None:
        actions = self._decode(model, vector)
        if actions is None:
            self._unpacked += 1
        else:
            self.log.offer(actions, "milp")

    def _decode(self, model: LayeredModel, vector: Floats) -> Sequence[Action] | None:
        from smash.planners.layered.events import read_events
        from smash.planners.layered.packing import Packing

        return Packing(self.instance, self.problem, read_events(model, vector)).actions()
