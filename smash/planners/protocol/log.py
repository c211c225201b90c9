"""The log of a solve: better plans and better bounds, judged, timed and passed on at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

from smash.planners.protocol.answer import OnIncumbent, PlanResult
from smash.planners.protocol.gentle import gentle_topples
from smash.planners.protocol.settings import plan_options
from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.plan import Incumbent, Plan, Status
from smash.problem.problem import Problem


class SolveLog:
    """Collects strictly better plans with their times, checks each by the law, and passes it on at once.

    It keeps the best lower bound in the same way. One log a solve: make it first, so that its clock counts build
    and translation too.

    Attributes:
        problem: what is planned.
        best: the best plan so far, at `cost`.
        bound: the best lower bound so far, proven by `bound_origin`.
        refuted: what proves that there is no plan, or None.
        entries: every plan that was better than those before it.
        refusals: what was offered and the law refused.
        details: what only this planner measures.
        doubt: why what a solver behind the planner concludes is a claim and no proof, None where it is believed.
        claimed: the best lower bound that is only claimed.
        gentle: whether topples of its plans are softened.
        worth: a plan that costs so much or more helps nobody, None where every plan does.
    """

    def __init__(
        self,
        problem: Problem,
        on_incumbent: OnIncumbent | None = None,
        *,
        gentle: bool = False,
        worth: int | None = None,
    ) -> None:
        """Start the clock.

        Args:
            problem: what is planned.
            on_incumbent: called with every better plan; its `bound`, where it has one, with every better bound.
            gentle: let no block fall that can as well be picked from its stack (`gentle_topples`).
            worth: a plan that costs so much or more helps nobody.
        """
        self._started = perf_counter()
        self.problem = problem
        self._report = on_incumbent
        self._report_bound = getattr(on_incumbent, "bound", None)
        self.gentle = gentle and problem.plain
        self.worth = worth
        self.entries: list[Incumbent] = []
        self.best: tuple[Action, ...] | None = None
        self.cost: int | None = None
        self.bound: int | None = None
        self.bound_origin: str | None = None
        self.refuted: str | None = None
        self.refusals: list[str] = []
        self.details: dict[str, Any] = {}
        self.doubt: str | None = None
        self.claimed: int | None = None

    @property
    def elapsed(self) -> float:
        """Seconds since the log was made."""
        return perf_counter() - self._started

    @property
    def proven(self) -> bool:
        """Whether the best plan meets the best lower bound."""
        return self.cost is not None and self.bound is not None and self.bound >= self.cost

    @property
    def upper(self) -> int | None:
        """What a plan has to cost less than to be of use: the best cost, or what any plan is worth."""
        return min((cost for cost in (self.cost, self.worth) if cost is not None), default=None)

    @property
    def settled(self) -> bool:
        """Whether nothing is left to be found: no plan is better than the best, or of use, or there is none.

        A claim settles it, too: who claims it looks no further.
        """
        least = max((bound for bound in (self.bound, self.claimed) if bound is not None), default=None)
        upper = self.upper
        return self.refuted is not None or (upper is not None and least is not None and least >= upper)

    def offer(self, actions: Sequence[Action], origin: str, seconds: float | None = None) -> bool:
        """Take a plan if it is legal and better than the best; report it at once.

        Args:
            actions: the plan.
            origin: what found it (`greedy`, `milp`, `exact`, the engine).
            seconds: when it was found, since the start of the solve; now, where None.

        Returns:
            Whether it became the best plan. A plan that the law refuses goes to `refusals`.
        """
        plain = self.problem.instance.costs.plain
        if self.cost is not None and plain and len(actions) >= self.cost:
            return False
        verdict = self.problem.law.check(actions)
        if not verdict.accepted or verdict.cost is None:
            self.refusals.append(f"{origin}: {verdict}")
            return False
        if self.cost is not None and verdict.cost >= self.cost:
            return False
        self.best = self._softened(actions)
        self.cost = len(self.best) if plain else verdict.cost
        at = self.elapsed if seconds is None else seconds
        self.entries.append(Incumbent(at, self.cost, origin))
        if self._report is not None:
            self._report(at, self.cost, self.best)
        return True

    def prove(self, bound: int, origin: str) -> None:
        """Take a lower bound on the cost of every plan if it is better than the best; report it at once.

        Args:
            bound: no plan costs less.
            origin: what proves it.
        """
        if self.bound is not None and bound <= self.bound:
            return
        self.bound, self.bound_origin = bound, origin
        if self._report_bound is not None:
            self._report_bound(self.elapsed, bound, origin)

    def conclude(self, bound: int, origin: str) -> None:
        """Take a lower bound of a solver: proven, or where it is doubted a claim in `details`.

        Args:
            bound: no plan costs less, it says.
            origin: what says so.
        """
        if self.doubt is None:
            self.prove(bound, origin)
        elif bound > (self.bound or 0) and (self.claimed is None or bound > self.claimed):
            self.claimed = bound
            self._claim("lower_bound", bound)

    def conclude_none(self, origin: str) -> None:
        """Take it from a solver that there is no plan: proven, or where it is doubted a claim in `details`."""
        if self.doubt is None:
            self.refute(origin)
        else:
            self._claim("status", "infeasible")

    def _claim(self, what: str, said: object) -> None:
        self.details["claimed"] = {**self.details.get("claimed", {}), what: said, "not_believed": self.doubt}

    def refute(self, origin: str, reason: str = "") -> None:
        """Take it that there is no plan.

        Args:
            origin: what proves it.
            reason: why, in one line.
        """
        self.refuted = origin
        if reason:
            self.details["reason"] = reason

    def plan(self) -> Plan:
        """Return the answer: `optimal` where the best bound meets the best cost."""
        status: Status
        if self.best is not None:
            status = "optimal" if self.proven else "feasible"
        else:
            status = "unknown" if self.refuted is None else "infeasible"
        return Plan(
            instance=self.problem.instance.name,
            planner="",
            options=self.problem.options,
            status=status,
            actions=self.best,
            lower_bound=self.bound,
            bound_origin=self.refuted if status == "infeasible" else self.bound_origin,
            incumbents=tuple(self.entries),
            stated_cost=self.cost,
            details=self.details,
        )

    def _softened(self, actions: Sequence[Action]) -> tuple[Action, ...]:
        if self.gentle:
            softened = gentle_topples(self.problem.law, actions)
            if self.problem.law.check(softened).accepted:
                return softened
        return tuple(actions)


class IncumbentLog(SolveLog):
    """The log for planners from outside, which know an instance and options and answer with a `PlanResult`."""

    def __init__(
        self,
        instance: Instance,
        options: PlanOptions,
        on_incumbent: OnIncumbent | None = None,
        *,
        gentle: bool = False,
    ) -> None:
        """Start the clock.

        Args:
            instance: the problem.
            options: what a plan may use.
            on_incumbent: called with every better plan; its `bound`, where it has one, with every better bound.
            gentle: let no block fall that can as well be picked from its stack (`gentle_topples`).
        """
        super().__init__(Problem(instance, plan_options(options)), on_incumbent, gentle=gentle)

    def without_plan(self) -> PlanResult | None:
        """Return the result where start and goal alone show that no plan exists, or None."""
        reason = self.problem.infeasible
        if reason is None:
            return None
        return self.result(infeasible=True, bound_origin="feasibility", details={"reason": reason})

    def result(
        self,
        *,
        infeasible: bool = False,
        bound_origin: str | None = None,
        details: Mapping[str, Any] | None = None,
    ) -> PlanResult:
        """Return the result: `optimal` where the best bound meets the best cost.

        Args:
            infeasible: whether it is proven that there is no plan.
            bound_origin: what proves that.
            details: what only this planner measures.
        """
        plan = self.plan()
        return PlanResult(
            status="infeasible" if infeasible and plan.actions is None else plan.status,
            actions=plan.actions,
            lower_bound=plan.lower_bound,
            bound_origin=bound_origin if infeasible else plan.bound_origin,
            incumbents=plan.incumbents,
            details=details or {},
            priced=plan.stated_cost,
        )


@dataclass(frozen=True, slots=True)
class Relay:
    """An `on_incumbent` that hands what another planner finds and proves to the log of the planner that asked it."""

    log: SolveLog
    origin: str

    def __call__(self, seconds: float, cost: int, actions: Sequence[Action]) -> None:
        """Take a plan, under the origin of this relay."""
        self.log.offer(actions, self.origin)

    def bound(self, seconds: float, bound: int, origin: str) -> None:
        """Take a lower bound."""
        self.log.prove(bound, origin)
