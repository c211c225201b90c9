"""The methods table of a planner, and the one loop that walks it under a budget."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import ClassVar

from smash.planners.protocol.answer import OnIncumbent
from smash.planners.protocol.clock import deadline_of, left
from smash.planners.protocol.first_place import plan_first_places
from smash.planners.protocol.log import SolveLog
from smash.planners.protocol.planner import ProblemPlanner
from smash.planners.protocol.settings import Settings
from smash.problem.plan import Plan
from smash.problem.problem import Problem


def anything(problem: Problem) -> None:
    """Take every problem."""


def plain(problem: Problem) -> str | None:
    """Take problems of pick, place and topple alone, each at cost 1."""
    return None if problem.plain else "it counts picks, places and topples"


def not_plain(problem: Problem) -> str | None:
    """Take the problems that `plain` does not."""
    return "pick, place and topple alone have a faster one" if problem.plain else None


@dataclass(frozen=True, slots=True)
class Method:
    """One of the ways in which a planner plans.

    Attributes:
        name: what it is called, in `details`.
        takes: why it cannot take a problem, in a few words, or None.
        run: plans until a time [s, clock of `perf_counter`], handing what it finds and proves to the log.
        share: share of the time left that it may take, asked when its turn comes.
        most: most seconds that it may take.
    """

    name: str
    takes: Callable[[Problem], str | None]
    run: Callable[[Problem, SolveLog, float], None]
    share: float | Callable[[], float] = 1.0
    most: float = math.inf

    def until(self, deadline: float) -> float:
        """Return when the method has to end if it begins now."""
        share = self.share() if callable(self.share) else self.share
        return min(deadline, perf_counter() + min(self.most, share * left(deadline)))


def walk(methods: Sequence[Method], problem: Problem, log: SolveLog, deadline: float) -> None:
    """Run the methods in turn until the log is settled or the time is over; the first that takes the problem always.

    Args:
        methods: the table of a planner.
        problem: what they plan; its plans are plans of the log's.
        log: takes plans and bounds; its details get the seconds of each method, and why one was left out.
        deadline: when to stop [s, clock of `perf_counter`].
    """
    seconds: dict[str, float] = {}
    for method in methods:
        if log.settled or (seconds and left(deadline) <= 0):
            break
        reason = method.takes(problem)
        if reason is not None:
            log.details.setdefault("left_out", {})[method.name] = reason
            continue
        began = perf_counter()
        method.run(problem, log, method.until(deadline))
        seconds[method.name] = perf_counter() - began
    log.details["seconds"] = seconds


class MethodPlanner(ProblemPlanner):
    """A planner that is a table of methods.

    What start and goal alone decide is decided first: a start that fulfils the goal, a goal that no plan reaches. A
    start with a block in the hand is planned from every first place.
    """

    holds: ClassVar[bool] = True
    gentle: ClassVar[bool] = False
    """Whether its plans let no block fall that can as well be picked from its stack."""
    kept_back: ClassVar[float] = 0.0
    """Share of the budget that is kept back for its last solver to end."""

    @abstractmethod
    def methods(self, problem: Problem, settings: Settings) -> Sequence[Method]:
        """Return the methods of one solve, in their order."""

    def plan(
        self, problem: Problem, settings: Settings, budget: float, on_incumbent: OnIncumbent | None = None
    ) -> Plan:
        """Plan for at most `budget` seconds of wall time; end as soon as the best plan is proven optimal.

        Args:
            problem: what to plan.
            settings: how to solve it.
            budget: seconds of wall time.
            on_incumbent: called with every better plan, its `bound` with every better bound.
        """
        deadline = deadline_of(budget, self.kept_back)
        log = SolveLog(problem, on_incumbent, gentle=self.gentle)
        log.doubt = self.why_doubted(problem, settings)
        self._solve(log, settings, deadline)
        return log.plan()

    def why_doubted(self, problem: Problem, settings: Settings) -> str | None:
        """Return why what the solver behind it concludes of a problem is a claim and no proof; None: it is believed."""
        return None

    def _solve(self, log: SolveLog, settings: Settings, deadline: float) -> None:
        problem = log.problem
        if problem.solved:
            log.offer((), "start")
            log.prove(0, "start")
            return
        if problem.infeasible is not None:
            log.refute("feasibility", problem.infeasible)
            return
        if self.proves:
            log.prove(0, "start")
        if problem.instance.hand is None:
            asked = problem.as_posed
            walk(self.methods(asked, settings), asked, log, deadline)
        else:
            plan_first_places(log, deadline, lambda rest, until: self._solve(rest, settings, until))
