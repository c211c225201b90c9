"""A job whose plan is to be fast or safe: its planner is asked, with topple and without, and one plan is chosen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from threading import Event
from time import monotonic

from smash.experiments.isolation.caller import run_isolated
from smash.experiments.isolation.job import Job, Report, still_running
from smash.experiments.weighing.apart import NotChosen, chosen_apart
from smash.experiments.weighing.choosing import Choice, Choose, Question, breaks_ties, choose, ready
from smash.forecast.expected import Forecaster
from smash.forecast.model import OutcomeModel, default_model
from smash.planners.protocol import ACTIONS, OnIncumbent
from smash.problem.model import Action
from smash.problem.plan import Incumbent
from smash.problem.problem import Problem
from smash.problem.rules import Verdict
from smash.records.outcomes import OutcomeName

FIRST, SECOND = 0.3, 0.5
"""When the planner's plan and its plan without topple have to be there, as shares of the budget; where neither is there
by then, the planner has all the rest."""
ANSWERS = ("optimal", "feasible", "over-budget", "budget-spent")
"""Ends of a run whose plan is weighed."""
ORIGIN = "seconds"

Solve = Callable[[Job], Report]


def weighs(job: Job) -> bool:
    """Return whether a job asks for more than the fewest actions."""
    return job.settings.objective != ACTIONS or job.settings.robust


def run_job(
    job: Job,
    model: OutcomeModel | None = None,
    on_incumbent: OnIncumbent | None = None,
    stop: Event | None = None,
    *,
    for_this: bool = False,
) -> Report:
    """Run one job in processes of its own (`run_isolated`), and weigh what it found where the job asks for that.

    Args:
        job: what to run, and its limits.
        model: of the scene; of the default scene, where None.
        on_incumbent: called with every better plan of the planner's.
        stop: set from outside, it ends the run.
        for_this: whether this process is there for this run alone: it may then be forked, and weighs the plans itself.
            Else they are weighed in a process of their own, as threads of one would wait for each other.

    Raises:
        Unsupported: where the outcome model does not know the instance.
    """

    def solve(part: Job) -> Report:
        return run_isolated(part, on_incumbent, stop, for_this=for_this)

    if not weighs(job):
        return solve(job)
    stopped = (lambda: False) if stop is None else stop.is_set
    apart = partial(chosen_apart, model=model, stop=stop)
    return weighed(job, solve, model, stopped, choose_by=None if for_this else apart)


def weighed(
    job: Job,
    solve: Solve,
    model: OutcomeModel | None,
    stopped: Callable[[], bool] = lambda: False,
    choose_by: Choose | None = None,
) -> Report:
    """Run a planner, and answer with the plan that its job asks for.

    Args:
        job: what to run, and what its plan is chosen for.
        solve: runs the planner.
        model: of the scene; of the default scene, where None.
        stopped: whether to end early.
        choose_by: chooses the plan; where None, it is chosen here.

    Raises:
        Unsupported: where the outcome model does not know the instance, or its scene has no room for any plan found.
    """
    known = model or default_model()
    forecaster = Forecaster(job.problem, known)

    def choose_here(question: Question) -> Choice:
        return choose(question, forecaster, ready(question, known), stopped)

    asked = _Asked(job, solve)
    by_actions = job.settings.objective == ACTIONS
    first = asked.once(job.problem, job.budget if by_actions else FIRST * job.budget)
    if first.outcome not in ANSWERS or (by_actions and first.plan.actions is None):
        return first
    if not by_actions:
        _ask_on(asked, job, stopped)
    if not asked.plans:
        return asked.report()
    question = Question(job, tuple(asked.plans), asked.spent, first.plan.status == "optimal")
    try:
        if stopped():
            raise NotChosen("stopped from outside", interrupted=True)
        here = by_actions and not breaks_ties(question, forecaster)  # at once: no process is begun for it
        choice = (choose_here if here else choose_by or choose_here)(question)
    except NotChosen as error:
        ended: OutcomeName = "interrupted" if error.interrupted else "crashed"
        return replace(_unweighed(asked, job), outcome=ended, reason=str(error))
    return _robust(asked, choice) if by_actions else _fastest(asked, job, choice, stopped())


def _ask_on(asked: _Asked, job: Job, stopped: Callable[[], bool]) -> None:
    """Ask for the plan without topple, too, and once more where there is no plan yet."""
    bare = Problem(job.instance, replace(job.options, topple=False))
    if job.options.topple and bare.infeasible is None:
        asked.once(bare, max(SECOND * job.budget - asked.spent, 0.05 * job.budget))
    left = job.budget - asked.spent
    if not asked.plans and left > 0.0 and not stopped():
        asked.once(job.problem, left)


def _unweighed(asked: _Asked, job: Job) -> Report:
    """Return the planner's report with the shortest of the plans that it found, with topple or without."""
    law = job.problem.law
    shortest = min(asked.plans, key=lambda actions: law.check(actions).cost or 0)
    return _fastest(asked, job, Choice(shortest, 0.0, {}), stopped=False)


def _robust(asked: _Asked, choice: Choice) -> Report:
    """Return the planner's report with another plan of the same cost."""
    report = asked.report()
    plan = replace(report.plan, actions=choice.actions, details={**report.plan.details, **choice.details})
    return replace(report, plan=plan, wall_seconds=asked.spent + choice.seconds)


def _fastest(asked: _Asked, job: Job, choice: Choice, stopped: bool) -> Report:
    """Return the planner's report with another plan: cost, bound and status speak of actions."""
    report = asked.report()
    verdict = job.problem.law.check(choice.actions)
    cost = verdict.cost
    assert cost is not None, verdict
    bound = report.plan.lower_bound
    proven = bound is not None and bound >= cost
    taken = asked.spent + choice.seconds
    incumbents = report.plan.incumbents
    if not incumbents or cost < incumbents[-1].cost:
        incumbents += (Incumbent(taken, cost, ORIGIN),)
    plan = replace(
        report.plan,
        status="optimal" if proven else "feasible",
        actions=choice.actions,
        incumbents=incumbents,
        stated_cost=cost,
        details={**report.plan.details, **choice.details},
        expected_seconds=choice.expected_seconds,
    )
    return replace(
        report,
        outcome="interrupted" if stopped else "optimal" if proven else "feasible",
        reason="stopped from outside" if stopped else "",
        plan=plan,
        verdict=Verdict(True, cost=cost),
        wall_seconds=taken,
    )


class _Asked:
    """The runs of a planner for one job: what they have answered, and what they have cost of its budget.

    Attributes:
        spent: so far [s]; import and start of processes are not counted.
        incumbents: of all runs, as of one.
    """

    def __init__(self, job: Job, solve: Solve) -> None:
        self._job = job
        self._solve = solve
        self._reports: list[Report] = []
        self._main: list[Report] = []
        self.spent = 0.0
        self.incumbents: tuple[Incumbent, ...] = ()

    def once(self, problem: Problem, budget: float) -> Report:
        """Run the planner, and return its report."""
        begun = monotonic()
        report = self._solve(replace(self._job, problem=problem, settings=self._job.settings.counting, budget=budget))
        for entry in report.plan.incumbents:
            if not self.incumbents or entry.cost < self.incumbents[-1].cost:
                self.incumbents += (entry._replace(seconds=self.spent + entry.seconds),)
        self.spent += monotonic() - begun if report.wall_seconds is None else report.wall_seconds
        self._reports.append(report)
        if problem is self._job.problem:
            self._main.append(report)
        return report

    @property
    def plans(self) -> list[tuple[Action, ...]]:
        """The plans that were found, in order."""
        return [report.plan.actions for report in self._reports if report.plan.actions is not None]

    def report(self) -> Report:
        """Return how the last run for the job's own problem has ended, with the sums over all of them."""
        last = self._reports[-1] if self._reports[-1].outcome == "interrupted" else self._main[-1]
        bounds = [report.plan for report in self._main if report.plan.lower_bound is not None]
        proven = max(bounds, key=lambda plan: plan.lower_bound or 0, default=last.plan)
        processor = [report.cpu_seconds for report in self._reports if report.cpu_seconds is not None]
        return replace(
            last,
            plan=replace(
                last.plan,
                options=self._main[-1].plan.options,
                lower_bound=proven.lower_bound,
                bound_origin=proven.bound_origin,
                incumbents=self.incumbents,
            ),
            reason=still_running(self.spent, self._job.budget) if last.outcome == "over-budget" else last.reason,
            wall_seconds=self.spent,
            cpu_seconds=sum(processor) if processor else None,
            memory_mib=max((r.memory_mib for r in self._reports if r.memory_mib is not None), default=None),
        )
