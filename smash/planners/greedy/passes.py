"""Greedy plans, each better than the one before: a first pass, then passes from what the best one taught."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator, Sequence
from time import perf_counter

from smash.planners.greedy.construct import NEVER, Construction
from smash.planners.greedy.line import line_steps
from smash.planners.greedy.shorten import shorten
from smash.problem.model import Action
from smash.problem.problem import Problem
from smash.problem.views.numbered import Numbered, Step, cost_of
from smash.problem.views.targets import Piles, target_piles
from smash.problem.views.twin import from_twin

PASSES = 12
"""Passes after the first one, each with what the best plan so far taught (its times, its topples)."""
NOISE = 0.6
"""How much a pass's choices are disturbed, at most."""
LATER_NOISE = (0.3, 0.6, 1.0, 2.0)
"""The same for the passes after those, in turn."""


def greedy_plans(
    problem: Problem, deadline: float, seed: int = 0, *, patient: bool = False
) -> Iterator[tuple[Action, ...]]:
    """Yield plans of any problem, each better than the one before, by way of its plain twin.

    None at all only where pick, place and topple alone reach the goal by no plan.

    Args:
        problem: what to plan.
        deadline: when to stop improving [s, clock of `perf_counter`]; the first plan always comes, and no pass is
            begun that would not end in time.
        seed: for the passes with disturbed choices.
        patient: whether to go on with disturbed passes until `deadline`.
    """
    twin = problem.twin
    if twin.infeasible is None:
        for steps in greedy_steps(twin, deadline, seed, patient=patient):
            yield tuple(from_twin(problem.instance, twin.numbered.actions(steps)))


def greedy_steps(problem: Problem, deadline: float, seed: int = 0, *, patient: bool = False) -> Iterator[list[Step]]:
    """Yield the steps of plans of a plain problem; arguments as in `greedy_plans`."""
    if problem.solved:
        yield []
        return
    numbered = problem.numbered
    if not problem.options.topple and numbered.locations <= 2:
        steps = line_steps(numbered)
        if steps is not None:
            yield steps
        return
    target = target_piles(numbered, falls=problem.options.topple)
    if target is not None:
        yield from _Passes(problem, target, deadline, seed, patient).improving()


class _Passes:
    """Passes of `Construction`, each disturbed otherwise, from what the best one taught."""

    def __init__(self, problem: Problem, target: Piles, deadline: float, seed: int, patient: bool) -> None:
        self.problem: Numbered = problem.numbered
        self.target = target
        self.topple = problem.options.topple
        self.cap = problem.options.max_topple or max(1, self.problem.blocks)
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
