"""How a run can end: every end has a name, what it means, and the exit code that `smash plan` gives it."""

from __future__ import annotations

from typing import Literal, NamedTuple

OutcomeName = Literal[
    "optimal",
    "feasible",
    "infeasible",
    "budget-spent",
    "over-budget",
    "unsupported",
    "not-installed",
    "crashed",
    "memory",
    "refused",
    "interrupted",
    "malformed",
]


class Outcome(NamedTuple):
    """What one outcome means, and the exit code of `smash plan` for it."""

    meaning: str
    exit_code: int


OUTCOMES: dict[OutcomeName, Outcome] = {
    "optimal": Outcome("a plan, proven optimal", 0),
    "feasible": Outcome("a plan", 0),
    "infeasible": Outcome("proven that there is no plan", 3),
    "budget-spent": Outcome("budget spent without a plan", 4),
    "over-budget": Outcome("stopped beyond its budget; the plans that it had reported are kept", 4),
    "unsupported": Outcome("the planner does not take this problem", 6),
    "not-installed": Outcome("the planner, or its engine, is not installed", 6),
    "crashed": Outcome("the planner ended abnormally", 7),
    "memory": Outcome("the planner's processes exceeded the memory limit", 7),
    "refused": Outcome("the law refuses what the planner answered", 7),
    "interrupted": Outcome("stopped from outside", 130),
    "malformed": Outcome("not a run: a name or an option that is wrong", 2),
}
"""`over-budget` with a plan kept is exit code 0; without one, 4."""
