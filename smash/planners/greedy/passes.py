"""Greedy plans, each better than the one before: a first pass, then passes from what the best one taught."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Iterator, Sequence
from time import perf_counter

from smash.planners.greedy.construct import NEVER, Construction
from smash.planners.greedy.line import line_steps
from smash.planners.greedy.shorten import shorten
from smash.planners.greedy.sorting import sorted_steps
from smash.problem.model import Action
from smash.problem.problem import Problem
from smash.problem.views.numbered import Numbered, Step, cost_of
from smash.problem.views.targets import Piles, target_piles
from smash.problem.views.twin import from_twin

PASSES = 12
"""Passes after the first one, each with what the best plan so far taught (its times, its topples)."""
NOISE = 0.6
"""How much a pass's choices are disturbed, at most."""
GRACE = 0.3
"""Seconds that a first plan may take longer than there is time: budgets are kept within half a second."""
LATER_NOISE = (0.3, 0.6, 1.0, 2.0)
"""The same for the passes after those, in turn."""
LONG = 2_000
"""A first plan of more steps is told before it is shortened: that takes as long as making it."""
SORTED_BLOCKS = 200
"""With more blocks and no topple the first plan is one that sorts (`sorting.py`): where locations are few, digging
takes many times as long, to a plan many times as long."""
HOPELESS = 2.0
"""A first pass is given up at so many times the steps of the sorting plan: passes were not seen to make that good."""
SORTED_SHARE = 0.2
"""Share of the time for the first plan in which the sorting one is shortened."""


def greedy_plans(
    problem: Problem, deadline: float, seed: int = 0, *, patient: bool = False
) -> Iterator[tuple[Action, ...]]:
    """Yield plans of any problem, each better than the one before, by way of its plain twin.

    Args:
        problem: what to plan.
        deadline: when to stop [s, clock of `perf_counter`]; a first plan may take `GRACE` longer, and no pass is begun
            that would not end in time.
        seed: for the passes with disturbed choices.
        patient: whether to go on with disturbed passes until `deadline`.
    """
    yield from GreedyRun(problem, seed).plans(deadline, patient=patient)


class GreedyRun:
    """The greedy plans of one problem; `plans` goes on where it was stopped before.

    None at all only where pick, place and topple alone reach the goal by no plan, or where there was no time for one.
    """

    def __init__(self, problem: Problem, seed: int = 0) -> None:
        self._problem = problem
        self._twin = problem.twin
        self._steps = _run_of(self._twin, seed)

    def plans(
        self, deadline: float, *, patient: bool = False, first_until: float = -math.inf
    ) -> Iterator[tuple[Action, ...]]:
        """Yield better plans.

        Args:
            deadline: when to stop [s, `perf_counter`].
            patient: whether to go on with disturbed passes until then.
            first_until: when to give up the first plan, and `GRACE` later; not before `deadline`.
        """
        if self._steps is not None:
            for steps in self._steps.improving(deadline, patient, first_until):
                yield tuple(from_twin(self._problem.instance, self._twin.numbered.actions(steps)))

    def seconds_left(self) -> float:
        """Return about how long the passes take that are not for the patient."""
        return self._steps.seconds_left() if self._steps is not None else 0.0


def greedy_steps(problem: Problem, deadline: float, seed: int = 0, *, patient: bool = False) -> Iterator[list[Step]]:
    """Yield the steps of plans of a plain problem; arguments as in `greedy_plans`."""
    run = _run_of(problem, seed)
    if run is not None:
        yield from run.improving(deadline, patient, deadline)


def _run_of(problem: Problem, seed: int) -> _Known | _Passes | None:
    if problem.infeasible is not None:
        return None
    if problem.solved:
        return _Known([])
    numbered = problem.numbered
    if not problem.options.topple and numbered.locations <= 2:
        steps = line_steps(numbered)
        return None if steps is None else _Known(steps)
    target = target_piles(numbered, falls=problem.options.topple)
    return None if target is None else _Passes(problem, target, seed)


class _Known:
    """One plan, to be told once."""

    def __init__(self, steps: list[Step]) -> None:
        self._steps: list[Step] | None = steps

    def improving(self, deadline: float, patient: bool, first_until: float) -> Iterator[list[Step]]:
        if self._steps is not None:
            steps, self._steps = self._steps, None
            yield steps

    def seconds_left(self) -> float:
        return 0.0


class _Passes:
    """Passes of `Construction`, each disturbed otherwise, from what the best one taught."""

    def __init__(self, problem: Problem, target: Piles, seed: int) -> None:
        self.problem: Numbered = problem.numbered
        self.target = target
        self.topple = problem.options.topple
        self.cap = problem.options.max_topple or max(1, self.problem.blocks)
        self.draw = random.Random(seed)
        self.best: list[Step] = []
        self.due: Sequence[float] = self._heights()
        self.toppled: set[int] = set()
        self._attempts = self._all_attempts()
        self._waiting: tuple[Sequence[int], float, bool] | None = None
        self._sorts = not self.topple and self.problem.blocks > SORTED_BLOCKS
        self._sorted: list[Step] = []
        self._hopeless = False
        self._longest = 0.0
        self._passes, self._spent = 0, 0.0

    def improving(self, deadline: float, patient: bool, first_until: float) -> Iterator[list[Step]]:
        """Yield the first plan and every better one; begin no pass that would end too late, and end one that does."""
        if not self.best:
            yield from self._first_plans(max(deadline, first_until))
            if not self.best:
                return
        while True:
            attempt = self._waiting or next(self._attempts)
            self._waiting = attempt
            first, noise, later = attempt
            began = perf_counter()
            if began + self._longest > deadline or (later and not patient):
                return
            before = self.draw.getstate()
            made = self._construct(first, noise, deadline)
            if made is None:
                self.draw.setstate(before)  # the same pass again when there is time
                return
            self._waiting = None
            self._passes += not later
            if self._keep(made, deadline) and self._is_new(self.best):
                yield self.best
            took = perf_counter() - began
            self._longest, self._spent = max(self._longest, took), self._spent + (0.0 if later else took)

    def _first_plans(self, latest: float) -> Iterator[list[Step]]:
        """Yield what there is before the passes that learn; `best` is empty where the first pass was given up."""
        if self._sorts:
            self._sorts = False
            yield from self._sorting(latest)
        if self._hopeless:
            return
        began = perf_counter()
        most = HOPELESS * len(self._sorted) if self._sorted else math.inf
        made = self._construct((), 0.0, latest if self._sorted else max(latest, began) + GRACE, most)
        if made is None:
            self._hopeless = perf_counter() < latest
            return
        self._learn(made, made.steps)  # before it is told: whoever stops there goes on from it
        if len(made.steps) > LONG and self._is_new(made.steps):
            yield made.steps
        if (self._keep(made, latest) or len(made.steps) <= LONG) and self._is_new(self.best):
            yield self.best
        # With the time that the plan's taker needs to judge and report it.
        self._longest = perf_counter() - began

    def _sorting(self, latest: float) -> Iterator[list[Step]]:
        """Yield the plan that sorts, and what comes of shortening it; passes learn nothing from it."""
        steps = sorted_steps(self.problem, self.target)
        if steps is None:
            return
        self._sorted = steps
        yield steps
        began = perf_counter()
        self._sorted = shorten(steps, began + SORTED_SHARE * (latest - began))
        if len(self._sorted) < len(steps):
            yield self._sorted

    def _is_new(self, steps: list[Step]) -> bool:
        """Return whether a plan is better than the one that sorts."""
        return not self._sorted or cost_of(steps) < cost_of(self._sorted)

    def seconds_left(self) -> float:
        if self._hopeless:
            return 0.0
        mean = self._spent / self._passes if self._passes else self._longest
        return mean * max(0, PASSES + len(self.toppled) - self._passes)

    def _all_attempts(self) -> Iterator[tuple[Sequence[int], float, bool]]:
        """Yield (stacks toppled at the start, noise, whether for the patient alone).

        First one topple at a time is left out, then the choices are disturbed.
        """
        for stack in sorted(self.toppled):
            if stack in self.toppled:
                yield sorted(self.toppled - {stack}), 0.0, False
        for number in range(PASSES):
            yield (), NOISE * number / PASSES, False
        for noise in itertools.cycle(LATER_NOISE):
            yield (), noise, True

    def _construct(
        self, first: Sequence[int], noise: float, give_up: float, most_steps: float = math.inf
    ) -> Construction | None:
        construction = Construction(
            self.problem,
            self.target,
            topple=self.topple,
            cap=self.cap,
            due=self.due,
            noise=noise,
            draw=self.draw,
        )
        return None if construction.run(first, give_up, most_steps) is None else construction

    def _keep(self, made: Construction, shorten_until: float) -> bool:
        """Shorten a pass's plan and keep it if it is the best so far."""
        steps = shorten(made.steps, shorten_until)
        if self.best and cost_of(steps) >= cost_of(self.best):
            return False
        self._learn(made, steps)
        return True

    def _learn(self, made: Construction, steps: list[Step]) -> None:
        self.best = steps
        self.due = made.finished_at
        self.toppled = made.toppled

    def _heights(self) -> list[float]:
        """Return the first guess of when each block is due: its height in the target."""
        due = [NEVER] * self.problem.blocks
        for pile in self.target:
            for height, block in enumerate(pile):
                due[block] = float(height)
        return due
