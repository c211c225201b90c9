"""What a user has at hand: an instance, a plan, the path of a file, a list of actions."""

from __future__ import annotations

import os
from collections.abc import Iterable

from smash.problem.errors import MalformedFile, SmashError
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import action_from_list, action_list, read_plan
from smash.problem.model import Action, Aggregating, Instance, Pick, Place, PlanOptions
from smash.problem.plan import Plan, check_plan
from smash.problem.rules import Law, Verdict

GivenInstance = Instance | str | os.PathLike[str]
"""An instance, or the path of an instance file."""
GivenPlan = Plan | str | os.PathLike[str] | Iterable[Action]
"""A plan, the path of a plan file, or the actions of a plan."""
BY_HAND = "by hand"
"""The planner of a plan that is given as a list of actions."""


def given_instance(given: GivenInstance) -> Instance:
    """Return the instance that is meant; a path is read.

    Raises:
        SmashError: where the file is malformed, or it is neither an instance nor a path.
    """
    if isinstance(given, Instance):
        return given
    if isinstance(given, str | os.PathLike):
        return read_instance(given)
    raise SmashError(f"{given!r} is neither an instance nor the path of an instance file")


def given_plan(given: GivenPlan, instance: Instance) -> Plan:
    """Return the plan that is meant; a path is read, actions are taken as a plan for `instance`.

    Raises:
        SmashError: where the file is malformed, or it is neither a plan, nor a path, nor a list of actions.
    """
    if isinstance(given, Plan):
        return given
    if isinstance(given, str | os.PathLike):
        return read_plan(given)
    actions = tuple(given) if isinstance(given, Iterable) else (given,)
    for action in actions:
        if not isinstance(action, Pick | Place | Aggregating):
            raise SmashError(f"{action!r} is no action; a plan is a Plan, the path of a plan file or a list of actions")
        try:
            action_from_list(action_list(action), "plan")
        except (MalformedFile, TypeError):
            raise SmashError(f"{action!r} is no action; names are strings, and heights whole numbers") from None
    cost = Law(instance).check(actions).cost
    return Plan(instance.name, BY_HAND, PlanOptions(), "feasible", actions, stated_cost=cost)


def check(instance: GivenInstance, plan: GivenPlan) -> Verdict:
    """Judge a plan by the law: its names, its cost, its options, what it says of itself, and every step.

    Args:
        instance: an instance, or the path of an instance file.
        plan: a plan, the path of a plan file, or a list of actions.

    Returns:
        Whether it is accepted, else the reason and the 1-based step.

    Raises:
        SmashError: where one of both is malformed; a plan that the law refuses is no error.
    """
    problem = given_instance(instance)
    return check_plan(problem, given_plan(plan, problem))
