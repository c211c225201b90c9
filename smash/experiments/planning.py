"""`plan`: one instance, one planner, one answer, judged by the law; here or in processes of its own."""

from __future__ import annotations

from smash.experiments.isolation.job import Job, Report
from smash.experiments.weighing.weighed import run_job, weighed, weighs
from smash.planners.protocol import ACTIONS, OBJECTIVES, Settings, ask
from smash.planners.registry import DEFAULT, get_planner, make_ready
from smash.problem.arguments import text, truth, whole_number
from smash.problem.errors import PlannerCrashed, PlannerOutOfMemory, SmashError, Unsupported
from smash.problem.files.given import GivenInstance, given_instance
from smash.problem.model import Instance, PlanOptions
from smash.problem.plan import Plan, check_plan
from smash.problem.problem import Problem
from smash.records.claims import claimed_infeasible
from smash.records.outcomes import OutcomeName

LONGEST = 1e9
"""Most seconds of a budget."""
FAILURES: dict[OutcomeName, type[SmashError]] = {
    "unsupported": Unsupported,
    "not-installed": Unsupported,
    "crashed": PlannerCrashed,
    "memory": PlannerOutOfMemory,
    "refused": PlannerCrashed,
}
"""The ends of a run that are no answer. Budget spent is one: a plan of status `unknown`."""


def plan(
    instance: GivenInstance,
    planner: str = DEFAULT,
    *,
    budget: float = 30.0,
    topple: bool = True,
    max_topple: int | None = None,
    seed: int = 0,
    isolated: bool = False,
    objective: str = ACTIONS,
    robust: bool = False,
) -> Plan:
    """Plan one instance.

    Example:
        `smash.plan(instance, "precedence", budget=5, topple=False)`

    Args:
        instance: an instance, or the path of an instance file.
        planner: a name from `planner_names()`.
        budget: wall time of the planner [s], model building and translation included.
        topple: whether topple is allowed.
        max_topple: most blocks of one topple (None: no limit).
        seed: for planners that draw.
        isolated: run it in processes of its own, ended when the budget or 4 GiB of memory are spent, as `smash plan`
            does; else here, where a planner that is stuck is not stopped.
        objective: `actions` for the fewest, `seconds` for the least expected time of the execution in the default
            scene: the plan then has `expected_seconds`.
        robust: of equally good plans the one of least risk in execution; plans for seconds are chosen so in any case.

    Returns:
        The plan: `status` is `optimal`, `feasible`, `infeasible` (proven) or `unknown` (budget spent without a plan).

    Raises:
        UnknownPlanner: where no planner has this name; the message lists those that there are.
        Unsupported: where it does not take the problem, or is not installed.
        PlannerCrashed: where it ends abnormally (isolated), or the law refuses what it answers.
        SmashError: where an argument is wrong.
    """
    _check(budget, max_topple, seed)
    text("planner", planner)
    topple, isolated = truth("topple", topple), truth("isolated", isolated)
    problem = Problem(given_instance(instance), PlanOptions(topple, max_topple))
    job = Job(
        planner, problem, Settings(seed=seed, objective=_one_of(objective), robust=truth("robust", robust)), budget
    )
    if not isolated:
        if weighs(job):
            return weighed(job, _reported_here, None).plan
        return _judged(_planned_here(job), job.instance)
    report = run_job(job)
    error = failure(report, planner)
    if error is not None:
        raise error
    return report.plan


def failure(report: Report, planner: str, where: str = "") -> SmashError | None:
    """Return what a run that ended without an answer failed of, or None where it has one.

    Args:
        report: how the run ended.
        planner: the planner's name.
        where: begins the message.
    """
    if report.outcome not in FAILURES:
        return None
    who = f"planner {planner!r}"
    said = report.reason.startswith(who)
    return FAILURES[report.outcome](where + (report.reason if said else f"{who}: {report.outcome}: {report.reason}"))


def _check(budget: float, max_topple: int | None, seed: int) -> None:
    if not isinstance(budget, int | float) or isinstance(budget, bool) or not 0 < budget <= LONGEST:
        raise SmashError(f"budget: {budget!r} is not allowed; seconds above 0")
    if max_topple is not None:
        whole_number("max_topple", max_topple, 1)
    whole_number("seed", seed, 0)


def _one_of(objective: str) -> str:
    if objective not in OBJECTIVES:
        raise SmashError(f"objective: {objective!r} is not allowed; {' or '.join(OBJECTIVES)}")
    return objective


def _reported_here(job: Job) -> Report:
    """Run a planner in this process, for whoever weighs its plans."""
    found = _judged(_planned_here(job), job.instance)
    return Report("budget-spent" if found.status == "unknown" else found.status, found)


def _planned_here(job: Job) -> Plan:
    """Run a planner in this process."""
    planner, problem, settings = get_planner(job.planner), job.problem, job.settings
    make_ready(planner, job.planner, problem, settings)
    return ask(planner, problem, settings, job.budget, name=job.planner)


def _judged(answer: Plan, instance: Instance) -> Plan:
    """Return the answer of a planner where the law and its own words agree."""
    found = answer.actions is not None
    if found != (answer.status in ("optimal", "feasible")):
        words = f"status {answer.status} {'with' if found else 'without'} a plan"
        raise PlannerCrashed(f"planner {answer.planner!r}: refused: {words}")
    if answer.status == "infeasible" and claimed_infeasible(Problem(instance, answer.options)) is False:
        raise PlannerCrashed(
            f"planner {answer.planner!r}: refused: status infeasible, yet start and goal show that there is a plan"
        )
    verdict = check_plan(instance, answer) if found else None
    if verdict is not None and not verdict.accepted:
        raise PlannerCrashed(f"planner {answer.planner!r}: {verdict}")
    return answer
