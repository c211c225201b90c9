"""What a planner is: one object with `solve(instance, options, budget, on_incumbent) -> PlanResult`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, ClassVar, Literal, Protocol, runtime_checkable

from smash.problem.actions.registry import is_plain, kinds_of
from smash.problem.feasibility import why_infeasible
from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.plan import Incumbent, Plan, Status
from smash.problem.rules import Law

OnIncumbent = Callable[[float, int, Sequence[Action]], None]
"""`on_incumbent(seconds, cost, actions)`: called at once with every better plan; seconds since the call of `solve`.

It may have a method `bound(seconds, bound, origin)` too: then that is called at once with every better lower bound,
so that a run that is stopped keeps its proof. `IncumbentLog` does both.
"""


MOST_THREADS = 256
"""Threads that a solver may be given; with some thousands it does nothing but start them."""


@dataclass(frozen=True, slots=True)
class SolveOptions(PlanOptions):
    """The law's plan options, and the settings of a solve that a planner may use.

    `warm_start` names the planner whose plan starts a model (None: cold); `horizon` overrides the number of
    time steps or layers of the time-indexed models; `threads` bounds the solver's threads; `seed` is for
    whatever draws at random.
    """

    warm_start: str | None = None
    horizon: int | None = None
    threads: int = 1
    seed: int = 0


@dataclass(frozen=True, slots=True)
class PlanResult:
    """A planner's answer. `details` holds what only this planner measures (model size, translation seconds)."""

    status: Status
    actions: tuple[Action, ...] | None = None
    lower_bound: int | None = None
    bound_origin: str | None = None
    incumbents: tuple[Incumbent, ...] = ()
    details: Mapping[str, Any] = field(default_factory=dict)
    priced: int | None = None
    """The plan's cost where that is not its length."""

    @property
    def cost(self) -> int | None:
        """The plan's cost: its length, unless it is `priced`."""
        if self.actions is None:
            return None
        return len(self.actions) if self.priced is None else self.priced

    def as_plan(self, instance: Instance, planner: str, options: PlanOptions) -> Plan:
        """Return the filed form."""
        return Plan(
            instance=instance.name,
            planner=planner,
            options=PlanOptions(options.topple, options.max_topple, without=options.without),
            status=self.status,
            actions=self.actions,
            lower_bound=self.lower_bound,
            bound_origin=self.bound_origin,
            incumbents=self.incumbents,
            stated_cost=self.cost,
        )


Support = Literal["yes", "no"]


@runtime_checkable
class Planner(Protocol):
    """A planner. Third parties add one by the `smash.planners` entry-point group; only `solve` is required.

    A planner may also define, and the testbed then uses:

    - `summary: str`, one line for `smash planners`;
    - `unsupported(instance, options) -> str | None`, why it cannot take this problem, asked before it starts;
    - `anytime: bool`, whether it improves a first plan until the budget ends (its incumbents then stand for
      every smaller budget);
    - `budget_dependent: bool`, whether what it does in its first seconds depends on how many it is given (it
      shares its budget out among parts, say); it is then run at every budget by itself. Where the attribute is
      missing, a planner that is not `anytime` counts as dependent;
    - `prepare() -> None`, loads libraries and compiles what is compiled once, before the clock starts;
    - `proves: bool`, whether it can report `optimal`;
    - `aggregating: frozenset[str]`, the aggregating actions that it plans with (`topple` alone, where it says nothing);
    - `weighs: bool`, whether it takes instances whose actions do not all cost 1;
    - `missing() -> str | None`, what is not installed that it needs;
    - `with_encoding(name) -> Planner`, the same planner on another PDDL encoding (`NAME:ENCODING`);
    - `build_model(instance, options) -> Milp`, the MILP that `solve` starts with, for `smash model`.
    """

    def solve(
        self,
        instance: Instance,
        options: SolveOptions,
        budget: float,
        on_incumbent: OnIncumbent | None = None,
    ) -> PlanResult:
        """Plan for at most `budget` seconds of wall time."""
        ...


class BasePlanner:
    """Defaults for the optional parts of the protocol."""

    summary: ClassVar[str] = ""
    anytime: ClassVar[bool] = True
    proves: ClassVar[bool] = False
    budget_dependent: ClassVar[bool] = False
    aggregating: ClassVar[frozenset[str]] = frozenset({"topple"})
    weighs: ClassVar[bool] = False

    def prepare(self) -> None:
        """Load what is loaded once and compile what is compiled once; not counted in the planner's time."""

    def unsupported(self, instance: Instance, options: SolveOptions) -> str | None:
        """Return why this planner cannot take the problem, or None."""
        return None

    def missing(self) -> str | None:
        """Return what is not installed that this planner needs, or None."""
        return None


def why_unsupported(planner: Planner, instance: Instance, options: SolveOptions) -> str | None:
    """Return why a planner cannot take a problem, or None: asked before it starts.

    An action that it does not know, or costs that it does not weigh, would make its proofs wrong.
    """
    known = getattr(planner, "aggregating", BasePlanner.aggregating)
    for kind in kinds_of(instance, options):
        if kind.name not in known:
            return f"it does not plan with {kind.name} (`--without {kind.name}` leaves that out)"
    if any(carrier.holds for carrier in instance.carriers) and "carry" not in known:
        return "blocks start on a carrier"
    if not instance.costs.plain and not getattr(planner, "weighs", False):
        return f"it counts actions, and the instance's costs are in {instance.costs.unit}"
    ask = getattr(planner, "unsupported", None)
    return None if ask is None else ask(instance, options)


class IncumbentLog:
    """Collects strictly better plans with their times, checks each by the law, and passes it on at once.

    It keeps the best lower bound in the same way. One log a solve: make it first, so that its clock counts build
    and translation too.
    """

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
        self._started = perf_counter()
        self._instance = instance
        self._options = options
        self._law = Law(instance, options)
        self._report = on_incumbent
        self._report_bound = getattr(on_incumbent, "bound", None)
        self._gentle = gentle and is_plain(instance, options)
        self.entries: list[Incumbent] = []
        self.best: tuple[Action, ...] | None = None
        self.cost: int | None = None
        self.bound: int | None = None
        self.bound_origin: str | None = None
        self.refusals: list[str] = []

    @property
    def elapsed(self) -> float:
        """Seconds since the log was made."""
        return perf_counter() - self._started

    @property
    def proven(self) -> bool:
        """Whether the best plan meets the best lower bound."""
        return self.cost is not None and self.bound is not None and self.bound >= self.cost

    def offer(self, actions: Sequence[Action], origin: str, seconds: float | None = None) -> bool:
        """Take a plan if it is legal and better than the best; report it at once.

        Args:
            actions: the plan.
            origin: what found it (`greedy`, `milp`, `exact`, the engine).
            seconds: when it was found, since the start of the solve; now, where None.

        Returns:
            Whether it became the best plan. A plan that the law refuses goes to `refusals`.
        """
        plain = self._instance.costs.plain
        if self.cost is not None and plain and len(actions) >= self.cost:
            return False
        verdict = self._law.check(actions)
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

    def _softened(self, actions: Sequence[Action]) -> tuple[Action, ...]:
        if self._gentle:
            from smash.planners.protocol.gentle import gentle_topples

            softened = gentle_topples(self._instance, actions)
            if self._law.check(softened).accepted:
                return softened
        return tuple(actions)

    def without_plan(self) -> PlanResult | None:
        """Return the result where start and goal alone show that no plan exists, or None."""
        reason = why_infeasible(self._instance, self._options)
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
        status: Status
        if self.best is not None:
            status = "optimal" if self.proven else "feasible"
        else:
            status = "infeasible" if infeasible else "unknown"
        return PlanResult(
            status=status,
            actions=self.best,
            lower_bound=self.bound,
            bound_origin=bound_origin if infeasible else self.bound_origin,
            incumbents=tuple(self.entries),
            details=details or {},
            priced=self.cost,
        )


@dataclass(frozen=True, slots=True)
class Relay:
    """An `on_incumbent` that hands what another planner finds and proves to the log of the planner that asked it."""

    log: IncumbentLog
    origin: str

    def __call__(self, seconds: float, cost: int, actions: Sequence[Action]) -> None:
        """Take a plan, under the origin of this relay."""
        self.log.offer(actions, self.origin)

    def bound(self, seconds: float, bound: int, origin: str) -> None:
        """Take a lower bound."""
        self.log.prove(bound, origin)
