"""A plan as it is filed, and the check of a whole plan against an instance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, get_args

from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.rules import Law, Verdict

Status = Literal["optimal", "feasible", "infeasible", "unknown"]
STATUSES: tuple[str, ...] = get_args(Status)


class Incumbent(NamedTuple):
    """A plan found on the way: `seconds` from the call of `solve` (build and translation included), cost, origin."""

    seconds: float
    cost: int
    origin: str


@dataclass(frozen=True, slots=True)
class Plan:
    """What a planner answered for one instance.

    `status` is `optimal` (proven), `feasible`, `infeasible` (proven) or `unknown` (budget spent).
    `lower_bound` is None where the planner proves none; `bound_origin` names the proof. Without a plan
    `actions` and `cost` are None. `details` holds what only this planner measures (model size, translation seconds); it
    is in records, not in plan files.
    """

    instance: str
    planner: str
    options: PlanOptions
    status: Status
    actions: tuple[Action, ...] | None
    lower_bound: int | None = None
    bound_origin: str | None = None
    incumbents: tuple[Incumbent, ...] = ()
    stated_cost: int | None = None
    details: Mapping[str, Any] = field(default_factory=dict, compare=False)

    @property
    def cost(self) -> int | None:
        """The plan's cost: the stated one, or its length where none is stated (every action then counts 1)."""
        if self.actions is None:
            return None
        return len(self.actions) if self.stated_cost is None else self.stated_cost


def check_plan(instance: Instance, plan: Plan) -> Verdict:
    """Judge a filed plan against `instance`: its names, its cost, its options, and every step by the law."""
    if plan.instance != instance.name:
        return Verdict(False, f"the plan is for instance {plan.instance!r}, not {instance.name!r}")
    if plan.actions is None:
        return Verdict(False, f"the file holds no plan (status {plan.status})")
    verdict = Law(instance, plan.options).check(plan.actions)
    if not verdict.accepted:
        return verdict
    if plan.cost != verdict.cost:
        counted = "its length" if instance.costs.plain else "what its actions cost"
        return Verdict(False, f"its cost says {plan.cost}, {counted} is {verdict.cost}")
    if plan.lower_bound is None or plan.cost is None:
        return verdict
    if plan.lower_bound > plan.cost:
        return Verdict(False, f"its lower bound {plan.lower_bound} is above its cost {plan.cost}")
    if plan.status == "optimal" and plan.lower_bound < plan.cost:
        return Verdict(False, f"it says optimal, but its lower bound {plan.lower_bound} is below its cost")
    return verdict
