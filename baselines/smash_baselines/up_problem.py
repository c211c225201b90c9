"""Instances as unified-planning problems, plans of that library as ours, and its validator as a second judge of plans.

The library is imported inside the functions: it takes a second, and only its engines need it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from smash.problem.errors import IllegalAction, Unsupported
from smash.problem.model import Action, Instance, PlanOptions
from smash.problem.plan import Plan
from smash.problem.rules import Law
from smash_baselines.names import Step
from smash_baselines.steps import actions_of, steps_of
from smash_baselines.task import PddlTask, compile_instance

NAME = "unified-planning"
"""Whom a plan that came from that library is ascribed to."""

if TYPE_CHECKING:
    from unified_planning.model import Problem
    from unified_planning.plans import Plan as UpPlan
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


def sequential_plan(plan: UpPlan, problem: Problem) -> SequentialPlan:
    """Return a plan of any kind as the sequence that it allows.

    Raises:
        Unsupported: where it allows none: one with times or branches.
    """
    from unified_planning.exceptions import UPUsageError
    from unified_planning.plans import PlanKind, SequentialPlan

    if isinstance(plan, SequentialPlan):
        return plan
    try:
        return plan.convert_to(PlanKind.SEQUENTIAL_PLAN, problem)
    except (UPUsageError, AssertionError, NotImplementedError) as error:
        raise Unsupported(f"a {type(plan).__name__} comes to no sequence of actions ({error})") from None


def plan_of_up_plan(plan: UpPlan, problem: Problem, task: PddlTask | None = None) -> Plan:
    """Return a unified-planning plan as ours, in the names of the instance, judged by the law.

    Args:
        plan: a plan of any kind that comes to a sequence.
        problem: what it solves: any problem of our domains, or a classical blocks world.
        task: the compiled instance that the problem was made from by `problem_of_task`; the plan is then in the names
            of that instance. None: the instance is read from the problem, and its names are the problem's.

    Returns:
        A plan of status `feasible`; that an engine calls it optimal is for the engine to prove.

    Raises:
        Unsupported: where the problem or the kind of plan is none of these.
        MalformedFile: where the problem's facts describe no instance.
        Infeasible: where the goal of a blocks world asks for what cannot be.
        IllegalAction: where the law refuses the plan.
    """
    from smash_baselines.read_up import reading_of

    steps = steps_of_up_plan(sequential_plan(plan, problem))
    if task is None:
        reading = reading_of(problem)
        instance, options, actions = reading.instance, reading.options, reading.actions(steps)
    else:
        instance, options, actions = task.instance, task.options, actions_of(steps, task)
    verdict = Law(instance, options).check(actions)
    if not verdict.accepted:
        raise IllegalAction(f"plan of {instance.name!r}: {verdict}")
    return Plan(instance.name, NAME, options, "feasible", tuple(actions), stated_cost=verdict.cost)


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
