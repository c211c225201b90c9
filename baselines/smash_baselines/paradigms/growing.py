"""Time-indexed models of growing horizon, one step of a plan a time, and what a horizon proves.

Let m blocks have to be transferred. A plan of more than T steps costs at least m + T + 1 where topples are allowed
(they cost 1, transfers 2), 2 (T + 1) without. So the optimum of horizon T bounds all plans as far as that, and where a
horizon has no plan at all, that bounds them alone.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

from smash.planners.protocol import Method, MethodPlanner, Settings, SolveLog, left, plain
from smash.problem.errors import IllegalAction
from smash.problem.extras import install_line, is_there
from smash.problem.problem import Problem
from smash_baselines.paradigms.task import Step, Task, task_of

MOST_CELLS = 3_000_000
"""Blocks times things times steps beyond which a model is not built."""

Ended = Literal["exhausted", "stopped"]
"""How the solve of a horizon ended: all its plans cheaper than the best are ruled out, or the time was over."""
Found = Callable[[Sequence[Step]], bool]
"""Takes the steps of a plan; whether to look for better ones."""


class ParadigmPlanner(MethodPlanner):
    """What the planners of the three paradigms share: all goals, caps, starts on the table and in the hand."""

    proves: ClassVar[bool] = True
    open_goals: ClassVar[bool] = True
    gentle: ClassVar[bool] = True
    kept_back: ClassVar[float] = 0.03
    module: ClassVar[str]
    """The module of the extra that it needs."""
    name: ClassVar[str]
    cells_per_second: ClassVar[int]
    """Cells of its model (transitions, where it has no steps) that are at least built in a second."""

    def missing(self) -> str | None:
        """Return what is not installed, or None."""
        return None if is_there(self.module) else install_line(self.module)

    def methods(self, problem: Problem, settings: Settings) -> Sequence[Method]:
        """Return the model alone."""

        def run(problem: Problem, log: SolveLog, until: float) -> None:
            self.search(task_of(problem), settings, log, until)
            if log.refusals:
                log.details["refusals"] = list(log.refusals)

        return (Method(self.name, plain, run),)

    @abstractmethod
    def search(self, task: Task, settings: Settings, log: SolveLog, until: float) -> None:
        """Plan until `until` [s, clock of `perf_counter`], handing plans and bounds to the log."""

    def why_too_large(self, cells: int, most: int, seconds: float) -> str | None:
        """Return why a model is not built, or None.

        Args:
            cells: its size.
            most: the largest that is built however much time there is.
            seconds: time left for it [s].
        """
        if cells > most:
            return f"the model has {cells:,} cells; {most:,} are built"
        if cells > self.cells_per_second * seconds:
            return f"the model has {cells:,} cells, which takes longer to build than the {seconds:.2g} s left"
        return None

    def offer(self, task: Task, log: SolveLog, steps: Sequence[Step]) -> bool:
        """Hand the plan of some steps to the log; one that the law refuses is recorded as refused.

        Returns:
            Whether something is left to be found.
        """
        try:
            log.offer(task.actions(steps), self.name)
        except IllegalAction as error:
            log.refusals.append(f"{self.name}: {error}")
        return not log.settled


@dataclass(frozen=True, slots=True)
class Horizon:
    """One horizon of a task.

    Attributes:
        task: what is planned.
        steps: number of steps T.
        below: only plans cheaper than this are looked for; None: any.
        settings: threads and seed.
        seconds: for building and solving [s].
    """

    task: Task
    steps: int
    below: int | None
    settings: Settings
    seconds: float


class GrowingPlanner(ParadigmPlanner):
    """A planner whose model has a horizon: the shortest first, then longer ones until one holds every cheaper plan."""

    indexed: ClassVar[bool] = True

    @abstractmethod
    def solve_horizon(self, horizon: Horizon, found: Found) -> Ended:
        """Solve a horizon, handing over each better plan."""

    def search(self, task: Task, settings: Settings, log: SolveLog, until: float) -> None:
        """Solve growing horizons until the best plan is proven; a chosen horizon alone."""
        steps = settings.horizon or max(1, len(task.placed))
        log.prove(task.least_cost(0), "moves")
        while not log.settled and left(until) > 0:
            cells = task.blocks * (task.table + 1) * steps
            reason = self.why_too_large(cells, MOST_CELLS, left(until))
            if reason is not None:
                log.details["stopped"] = reason
                return
            log.details["horizon"] = steps
            horizon = Horizon(task, steps, log.cost, settings, left(until))
            if self.solve_horizon(horizon, lambda found: self.offer(task, log, found)) != "exhausted":
                return
            if log.refusals:  # a model that is wrong about plans is wrong about proofs
                return
            beyond = task.least_cost(steps + 1)
            log.prove(beyond if log.cost is None else min(beyond, log.cost), self.name)
            if settings.horizon is not None:
                return
            steps += 1
