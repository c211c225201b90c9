"""The loop of every planner that has a MILP: build under a deadline, solve, hand each solution to the log.

Build and solve stay separate steps: a `Stage` says how a model is built and read, `Solving.run` solves it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, inf, isfinite
from time import perf_counter
from typing import Any, Generic, Protocol, TypeVar

from smash.planners.milp.arrays import Floats, Milp, MilpResult, OutOfTime
from smash.planners.milp.solvers import solver_of
from smash.planners.protocol import Settings, SolveLog, left
from smash.problem.errors import IllegalAction, Unsupported
from smash.problem.model import Action

BUILD_SHARE = 0.6
"""Share of the time left that the building of a model may take: what takes longer is not solved in the rest."""
TOLERANCE = 1e-6
"""Of solvers, relative: the costs of actions may be tens of thousands."""


class Built(Protocol):
    """What a stage builds: the MILP, beside whatever its solutions are read by."""

    @property
    def milp(self) -> Milp:
        """The model to solve."""
        ...


Model = TypeVar("Model", bound=Built)


@dataclass(frozen=True, slots=True)
class Stage(Generic[Model]):
    """One model of a solve.

    Attributes:
        name: what it is called, in the details of the solve.
        build: builds it until a time [s, clock of `perf_counter`]; past it, it raises `OutOfTime`.
        decode: reads the plan off a solution, None where it is no plan; it may raise `IllegalAction` for that too.
            None: its solutions are no plans.
        horizon: number of layers or steps; None: it has no time.
        share: share of the time left that the solver may take, and building at the most.
        most: most seconds for the solver.
        estimate: a generous estimate of how long it takes to build and to load [s]: with less left it is not begun.
        start: the solution that the solver starts from, None where there is none.
        options: further options, by solver.
    """

    name: str
    build: Callable[[float], Model]
    decode: Callable[[Model, Floats], Sequence[Action] | None] | None
    horizon: int | None = None
    share: float = 1.0
    most: float = inf
    estimate: float = 0.0
    start: Callable[[Model], Floats | None] | None = None
    options: Mapping[str, dict[str, Any]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Solving:
    """What the stages of a method share.

    Attributes:
        settings: the solver's.
        log: takes plans; its details get a line for each stage.
        until: when to end [s, clock of `perf_counter`].
    """

    settings: Settings
    log: SolveLog
    until: float

    def done(self) -> bool:
        """Whether nothing is left to find, or no time to find it in."""
        return self.log.settled or left(self.until) <= 0

    def run(self, stage: Stage[Model]) -> MilpResult | None:
        """Build and solve a model.

        Returns:
            The result; None where there is not the time to build it or the solver does not take it, which is noted in
            the details.
        """
        began = perf_counter()
        if stage.estimate >= left(self.until):
            self._note(stage, {"skipped": f"it would take some {stage.estimate:.2g} s to build"})
            return None
        try:
            model = stage.build(began + min(BUILD_SHARE, stage.share) * left(self.until))
        except OutOfTime:
            seconds = round(perf_counter() - began, 4)
            self._note(stage, {"skipped": "took too long to build", "seconds": seconds})
            return None
        built = perf_counter()
        start = None if stage.start is None else stage.start(model)

        def found(vector: Floats) -> None:
            self._offer(stage, model, vector)

        try:
            result = solver_of(self.settings)(
                model.milp,
                time_limit=min(stage.most, stage.share * left(self.until)),
                threads=self.settings.threads,
                seed=self.settings.seed,
                start=start,
                on_solution=None if stage.decode is None else lambda _seconds, _objective, vector: found(vector),
                should_stop=self.done,
                options=stage.options.get(self.settings.solver),
            )
        except Unsupported as error:  # the licence of a solver, or what it takes of numbers, ends with this model
            self._note(stage, model.milp.size() | {"refused": str(error)})
            return None
        if result.vector is not None:
            found(result.vector)
        note = model.milp.size() | {"build_seconds": round(built - began, 4)}
        note |= {} if stage.start is None else {"started_from_a_plan": start is not None}
        outcome = {"status": result.status, "objective": result.objective, "bound": result.bound}
        self._note(stage, note | outcome | {"nodes": result.nodes, "seconds": round(result.seconds, 4)})
        return result

    def _offer(self, stage: Stage[Model], model: Model, vector: Floats) -> None:
        if stage.decode is None:
            return
        try:
            actions = stage.decode(model, vector)
        except IllegalAction as error:
            self.log.refusals.append(f"milp: {error}")
            return
        if actions is not None:
            self.log.offer(actions, "milp")

    def _note(self, stage: Stage[Model], what: dict[str, Any]) -> None:
        horizon = {} if stage.horizon is None else {"horizon": stage.horizon}
        self.log.details.setdefault("stages", []).append({"model": stage.name} | horizon | what)


def whole(bound: float) -> int | None:
    """Return the whole number that a solver's bound on whole costs proves, its tolerance left out; None: nothing."""
    return ceil(bound - TOLERANCE * max(1.0, abs(bound))) if isfinite(bound) else None
