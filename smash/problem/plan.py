"""A plan as it is filed (`smash-plan/1`), and the check of a whole plan against an instance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

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
    `actions` and `cost` are None.
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

    @property
    def cost(self) -> int | None:
        """The plan's cost: its length (every action counts 1)."""
        return None if self.actions is None else len(self.actions)


def check_plan(instance: Instance, plan: Plan) -> Verdict:
    """Judge a filed plan against `instance`: its names, its cost, its options, and every step by the law."""
    if plan.instance != instance.name:
        return Verdict(False, f"the plan is for instance {plan.instance!r}, not {instance.name!r}")
    if plan.actions is None:
        return Verdict(False, f"the file holds no plan (status {plan.status})")
    if plan.stated_cost is not None and plan.stated_cost != len(plan.actions):
        return Verdict(False, f"its cost says {plan.stated_cost}, its length is {len(plan.actions)}")
    verdict = Law(instance, plan.options).check(plan.actions)
    if not verdict.accepted or plan.lower_bound is None:
        return verdict
    if plan.lower_bound > len(plan.actions):
        return Verdict(False, f"its lower bound {plan.lower_bound} is above its cost {len(plan.actions)}")
    if plan.status == "optimal" and plan.lower_bound < len(plan.actions):
        return Verdict(False, f"it says optimal, but its lower bound {plan.lower_bound} is below its cost")
    return verdict
