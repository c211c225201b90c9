"""The greedy planner: a feasible plan at any size, wherever one exists, and better ones by a few more passes."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Sequence
from time import perf_counter
from typing import ClassVar

from smash.planners.greedy.construct import NEVER, Construction
from smash.planners.greedy.line import line_steps
from smash.planners.greedy.shorten import shorten
from smash.planners.protocol import BasePlanner, IncumbentLog, OnIncumbent, PlanResult, SolveOptions
from smash.problem.actions.registry import FAMILY, is_plain
from smash.problem.feasibility import why_infeasible
from smash.problem.model import Action, Instance, PlanOptions, State
from smash.problem.rules import Law
from smash.problem.views.numbered import Indexed, Step, cost_of
from smash.problem.views.targets import Piles, target_piles
from smash.problem.views.twin import from_twin, plain_twin

PASSES = 12
"""Passes after the first one, each with what the best plan so far taught (its times, its topples)."""
NOISE = 0.6
"""How much a pass's choices are disturbed, at most."""
LATER_NOISE = (0.3, 0.6, 1.0, 2.0)
"""The same for the passes after those, in turn."""


class GreedyPlanner(BasePlanner):
    """Direct moves first; else topple, or put aside where it costs the least later; then passes that improve."""

    summary: ClassVar[str] = "a plan at any size in near-linear time; infeasibility decided at once"
    aggregating: ClassVar[frozenset[str]] = frozenset(FAMILY)
    weighs: ClassVar[bool] = True

    def solve(
        self,
        instance: Instance,
        options: SolveOptions,
        budget: float,
        on_incumbent: OnIncumbent | None = None,
    ) -> PlanResult:
        """Plan at once; improve for some passes, within `budget` seconds."""
        log = IncumbentLog(instance, options, on_incumbent, gentle=True)
        if not is_plain(instance, options):
            return self._family(instance, options, log, perf_counter() + budget)
        impossible = log.without_plan()
        if impossible is not None:
            return impossible
        problem = Indexed.of(instance)
        for steps in greedy_steps(problem, options, perf_counter() + budget, options.seed):
            log.offer(problem.actions(steps), "greedy")
        if log.cost == 0:
            log.prove(0, "start")
        return log.result()

    def _family(self, instance: Instance, options: SolveOptions, log: IncumbentLog, deadline: float) -> PlanResult:
        """Plan with pick, place and topple alone: whatever else there is, such a plan remains one."""
        for actions in twin_plans(instance, options, deadline):
            log.offer(actions, "greedy")
        if log.cost == 0:
            log.prove(0, "start")
        return log.result()


def twin_plans(
    instance: Instance, options: PlanOptions, deadline: float, seed: int = 0
) -> Iterator[tuple[Action, ...]]:
    """Yield plans of any instance by way of its plain twin; none where pick, place and topple do not suffice."""
    twin = plain_twin(instance)
    if why_infeasible(twin, options) is None:
        problem = Indexed.of(twin)
        for steps in greedy_steps(problem, options, deadline, seed):
            yield tuple(from_twin(instance, problem.actions(steps)))


def greedy_steps(
    problem: Indexed, options: PlanOptions, deadline: float, seed: int = 0, *, patient: bool = False
) -> Iterator[list[Step]]:
    """Yield plans, each better than the one before; none at all only where no plan exists.

    Args:
        problem: the numbered instance.
        options: what a plan may use.
        deadline: when to stop improving, on the clock of `perf_counter` [s]; the first plan always comes, and no
            pass is begun that would not end in time.
        seed: for the passes with disturbed choices.
        patient: whether to go on with disturbed passes until `deadline`.
    """
    state = State.start_of(problem.instance)
    if Law(problem.instance, options).goal_shortfall(state) is None:
        yield []
        return
    if not options.topple and problem.locations <= 2:
        steps = line_steps(problem)
        if steps is not None:
            yield steps
        return
    target = target_piles(problem)
    if target is not None:
        yield from _Passes(problem, target, options, deadline, seed, patient).improving()


class _Passes:
    """Passes of `Construction`, each disturbed otherwise, from what the best one taught."""

    def __init__(
        self, problem: Indexed, target: Piles, options: PlanOptions, deadline: float, seed: int, patient: bool
    ) -> None:
        self.problem = problem
        self.target = target
        self.topple = options.topple
        self.cap = options.max_topple or max(1, problem.blocks)
        self.deadline = deadline
        self.patient = patient
        self.draw = random.Random(seed)
        self.best: list[Step] = []
        self.due: Sequence[float] = self._heights()
        self.toppled: set[int] = set()

    def improving(self) -> Iterator[list[Step]]:
        """Yield the first plan and every better one, beginning no pass that would end too late."""
        began = perf_counter()
        self._better(())
        yield self.best
        longest = perf_counter() - began  # with the time that the plan's taker needs to judge and report it
        for attempt in self._attempts():
            began = perf_counter()
            if began + longest > self.deadline:
                return
            if self._better(*attempt):
                yield self.best
            longest = max(longest, perf_counter() - began)

    def _attempts(self) -> Iterator[tuple[Sequence[int], float]]:
        """Yield (stacks toppled at the start, noise): leave out one topple at a time, then disturb the choices."""
        for stack in sorted(self.toppled):
            if stack in self.toppled:
                yield sorted(self.toppled - {stack}), 0.0
        for number in range(PASSES):
            yield (), NOISE * number / PASSES
        for noise in itertools.cycle(LATER_NOISE if self.patient else ()):
            yield (), noise

    def _better(self, first: Sequence[int], noise: float = 0.0) -> bool:
        """Make one pass; keep its plan, times and topples if it is the best so far."""
        construction = Construction(
            self.problem,
            self.target,
            topple=self.topple,
            cap=self.cap,
            due=self.due,
            noise=noise,
            draw=self.draw,
        )
        steps = shorten(construction.run(first))
        if self.best and cost_of(steps) >= cost_of(self.best):
            return False
        self.best = steps
        self.due = construction.finished_at
        self.toppled = construction.toppled
        return True

    def _heights(self) -> list[float]:
        """Return the first guess of when each block is due: its height in the target."""
        due = [NEVER] * self.problem.blocks
        for pile in self.target:
            for height, block in enumerate(pile):
                due[block] = float(height)
        return due
