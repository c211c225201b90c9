"""Instances as unified-planning problems, and that library's validator as a second judge of plans.

The library is imported inside the functions: it takes a second, and only its engines need it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from smash.problem.model import Action, Instance, PlanOptions
from smash_baselines.names import Step
from smash_baselines.steps import steps_of
from smash_baselines.task import PddlTask, compile_instance

if TYPE_CHECKING:
    from unified_planning.model import Problem
    from unified_planning.plans import SequentialPlan


def up_problem(instance: Instance, options: PlanOptions, wanted: str) -> Problem:
    """Return the unified-planning problem of an instance in the encoding `wanted` (`conditional` or `chain`).

    It is read from the PDDL text, so that both worlds plan in the very same domain.

    Raises:
        Unsupported: where that encoding cannot say the problem.
    """
    return problem_of_task(compile_instance(instance, options, wanted))


def problem_of_task(task: PddlTask) -> Problem:
    """Return the unified-planning problem of a compiled instance."""
    from unified_planning.io import PDDLReader

    return PDDLReader().parse_problem_string(task.domain_text, task.problem_text)


def up_plan(steps: Iterable[Step], problem: Problem) -> SequentialPlan:
    """Return the unified-planning plan of PDDL steps."""
    from unified_planning.plans import ActionInstance, SequentialPlan

    return SequentialPlan(
        [ActionInstance(problem.action(name), tuple(problem.object(item) for item in items)) for name, *items in steps]
    )


def steps_of_up_plan(plan: SequentialPlan) -> list[Step]:
    """Return the PDDL steps of a unified-planning plan."""
    return [(action.action.name, *(str(item) for item in action.actual_parameters)) for action in plan.actions]


def up_accepts(actions: Sequence[Action], task: PddlTask) -> bool:
    """Return whether unified-planning's sequential validator accepts a legal plan of the law.

    Raises:
        IllegalAction: where the law refuses an action.
    """
    from unified_planning.engines import SequentialPlanValidator
    from unified_planning.engines.results import ValidationResultStatus

    problem = problem_of_task(task)
    result = SequentialPlanValidator().validate(problem, up_plan(steps_of(actions, task), problem))
    return bool(result.status == ValidationResultStatus.VALID)
