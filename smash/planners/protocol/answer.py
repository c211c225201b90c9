"""What a planner answers: a `Plan`, or the `PlanResult` of planners from outside, which `ask` alone makes a plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.plan import Incumbent, Plan, Status

OnIncumbent = Callable[[float, int, Sequence[Action]], None]
"""`on_incumbent(seconds, cost, actions)`: called at once with every better plan; seconds since the call of `solve`.

It may have a method `bound(seconds, bound, origin)` too: then that is called at once with every better lower bound,
so that a run that is stopped keeps its proof. `IncumbentLog` does both.
"""


@dataclass(frozen=True, slots=True)
class PlanResult:
    """What `Planner.solve` returns; `details` holds what only this planner measures (model size, seconds)."""

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

    @classmethod
    def of(cls, plan: Plan) -> PlanResult:
        """Return the answer of a plan, which no longer says whose it is."""
        return cls(
            plan.status,
            plan.actions,
            plan.lower_bound,
            plan.bound_origin,
            plan.incumbents,
            plan.details,
            plan.stated_cost,
        )

    def as_plan(self, instance: Instance, planner: str, options: PlanOptions) -> Plan:
        """Return the plan that this answers."""
        return Plan(
            instance=instance.name,
            planner=planner,
            options=PlanOptions(options.topple, options.max_topple, without=options.without),
            status=self.status,
            actions=None if self.actions is None else tuple(self.actions),
            lower_bound=self.lower_bound,
            bound_origin=self.bound_origin,
            incumbents=self.incumbents,
            stated_cost=self.cost,
            details=self.details,
        )
