"""A plan as it is filed, and the check of a whole plan against an instance."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, get_args

from smash.problem.model import Action, Aggregating, Instance, Pick, Place, PlanOptions
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
    is in records, not in plan files. `expected_seconds` is what the execution is expected to take, in a plan that was
    chosen for that; cost, bound and status speak of actions all the same.
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
    expected_seconds: float | None = None

    @property
    def cost(self) -> int | None:
        """The plan's cost: the stated one, or its length where none is stated (every action then counts 1)."""
        if self.actions is None:
            return None
        return len(self.actions) if self.stated_cost is None else self.stated_cost

    def __repr__(self) -> str:
        return f"<Plan {self}>"

    def __str__(self) -> str:
        found = "no plan" if self.actions is None else f"cost {self.cost}"
        bound = "" if self.lower_bound is None else f", lower bound {self.lower_bound}"
        return f"for {self.instance!r} by {self.planner}: {self.status}, {found}{bound}"

    def _repr_svg_(self) -> str:
        """Return the plan as a strip of its steps, for notebooks; a pick and its place are one."""
        from smash.problem.pictures import Chip, chips_svg  # solving needs none

        chips = [Chip(words, several) for words, several in _steps_in_words(self.actions or ())]
        return chips_svg(f"Plan {self}", chips)


def _steps_in_words(actions: Sequence[Action]) -> Iterator[tuple[str, bool]]:
    """Yield the numbered steps, a pick and its place as one, and whether a step moves several blocks at once."""
    following: list[Action | None] = [*actions[1:], None]
    before: Action | None = None
    for step, (action, after) in enumerate(zip(actions, following, strict=False), start=1):
        if isinstance(action, Pick) and isinstance(after, Place):
            yield f"{step}–{step + 1} · {action.block}: {action.source} → {after.target}", False
        elif not (isinstance(action, Place) and isinstance(before, Pick)):
            yield f"{step} · {action}".replace("'", ""), isinstance(action, Aggregating)
        before = action


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
