"""Plans chosen for what their execution takes: `--objective seconds` and `--robust`.

Planners count actions. Here their plans are weighed: with topple and without, what annealing makes of them, and of the
fastest of these those whose motions, rehearsed, take the least time. The plan without topple is always among them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from random import Random
from threading import Event
from time import monotonic
from typing import TYPE_CHECKING

from smash.experiments.isolation.caller import run_isolated
from smash.experiments.isolation.job import Job, Report, still_running
from smash.forecast.expected import Forecaster
from smash.forecast.model import OutcomeModel, default_model
from smash.forecast.robust import least_risk
from smash.forecast.search import Candidate, faster, neighbours
from smash.planners.protocol import ACTIONS, OnIncumbent
from smash.problem.extras import EXECUTION, MissingExtra, is_there
from smash.problem.model import Action
from smash.problem.plan import Incumbent, Plan
from smash.problem.problem import Problem
from smash.problem.rules import Verdict
from smash.problem.words import counted

if TYPE_CHECKING:
    from smash.execution.rehearsal import Rehearsal

FIRST, SECOND, ANNEALED = 0.3, 0.5, 0.6
"""When the planner's plan, its plan without topple and the annealing have to be there, as shares of the budget; where
neither plan is there by then, the planner has all the rest."""
SEEDS = (0, 1)
"""Each of the fastest plans is rehearsed with these."""
FINALISTS = 3
AN_ACTION = 0.025
"""A rehearsal takes about so long for each action of a plan [s]."""
CLIMBED = 0.93
"""When the last neighbour of the best plan has to be rehearsed, as a share of the budget."""
CLIMBS, TRIES = 2000, 300
"""Neighbours that are looked at, in all and of one plan."""
WORTH_A_TRY = 2.0
"""A neighbour that the forecast holds for so much slower than the best plan is not rehearsed [s]."""
MODEL_ALONE = "by the outcome model alone"
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
        for_this: whether this process is there for this run alone.

    Raises:
        Unsupported: where the outcome model does not know the instance.
    """

    def solve(part: Job) -> Report:
        return run_isolated(part, on_incumbent, stop, for_this=for_this)

    return weighed(job, solve, model, (lambda: False) if stop is None else stop.is_set) if weighs(job) else solve(job)


def weighed(job: Job, solve: Solve, model: OutcomeModel | None, stopped: Callable[[], bool] = lambda: False) -> Report:
    """Run a planner, and answer with the plan that its job asks for.

    Args:
        job: what to run, and what its plan is chosen for.
        solve: runs the planner.
        model: of the scene; of the default scene, where None.
        stopped: whether to end early.

    Raises:
        Unsupported: where the outcome model does not know the instance.
    """
    forecaster = Forecaster(job.problem, model or default_model())
    asked = _Asked(job, solve)
    if job.settings.objective == ACTIONS:
        report = asked.once(job.problem, job.budget)
        return _Weighing(job, forecaster, None, asked, monotonic() - asked.spent, stopped).robust(report)
    first = asked.once(job.problem, FIRST * job.budget)
    if first.outcome not in ANSWERS:
        return first
    bare = Problem(job.instance, replace(job.options, topple=False))
    if job.options.topple and bare.infeasible is None:
        asked.once(bare, max(SECOND * job.budget - asked.spent, 0.05 * job.budget))
    left = job.budget - asked.spent
    if not asked.plans and left > 0.0 and not stopped():
        asked.once(job.problem, left)
    if not asked.plans:
        return asked.report()
    rehearsal = None if stopped() else _rehearsal(job, forecaster.model)
    return _Weighing(job, forecaster, rehearsal, asked, monotonic() - asked.spent, stopped).fastest()


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


def _rehearsal(job: Job, model: OutcomeModel) -> Rehearsal | None:
    """Make the scene's rehearsal ready; None where motions cannot be planned here, or the model is of another scene."""
    if not all(is_there(module) for module in EXECUTION) or job.instance.hand is not None:
        return None
    from smash.execution.actions.arm_motions import ArmMotions
    from smash.execution.rehearsal import Rehearsal
    from smash.execution.scene.scene_file import default_scene

    if default_scene().fingerprint != model.layout:
        return None
    ArmMotions(default_scene()).warm_up()
    return Rehearsal(default_scene(), model)


@dataclass(frozen=True)
class _Weighing:
    """What is weighed of one job: the plans that a planner was asked for; `begun` counts what that has cost."""

    job: Job
    forecaster: Forecaster
    rehearsal: Rehearsal | None
    asked: _Asked
    begun: float
    stopped: Callable[[], bool]

    def fastest(self) -> Report:
        """Return the report of the plan that takes the least time."""
        starts = self.asked.plans
        candidates = faster(
            self.forecaster,
            starts,
            seed=self.job.settings.seed,
            until=self.begun + ANNEALED * self.job.budget,
            stopped=self.stopped,
        )
        given = [Candidate(start, self.forecaster.of(start)) for start in starts]
        chosen, how = self._rehearsed([*given, *candidates])
        details: dict[str, object] = {"weighed": how}
        if how == MODEL_ALONE:
            details["note"] = f"expected_seconds is {how}: {self._why_not_rehearsed()}"
        return self._report(chosen, details)

    def robust(self, report: Report) -> Report:
        """Return the report with the plan of least risk among those of its cost."""
        plan = report.plan
        if plan.actions is None or report.outcome == "interrupted":
            return report
        risk = self.forecaster.of(plan.actions).risk
        lacking = self._no_ties(plan)
        if lacking is not None:
            note = f"ties are not broken by risk: that takes {lacking}"
            return replace(report, plan=replace(plan, details={**plan.details, "risk": risk, "note": note}))
        found = least_risk(self.forecaster, plan.actions, self.begun + self.job.budget, self.stopped)
        details = {**plan.details, **self._weighed_seconds(), "risk": found.risk, "risk_before": risk}
        if not found.exact:
            details["note"] = "not all optimal plans could be looked at: there may be one of less risk"
        plan = replace(plan, actions=found.actions, details=details)
        return replace(report, plan=plan, wall_seconds=monotonic() - self.begun)

    def _no_ties(self, plan: Plan) -> str | None:
        """Return what is missing for ties to be broken by risk, or None."""
        if plan.status != "optimal":
            return "a proven optimum"
        if not self.job.problem.plain:
            return "actions of cost 1"
        return None if self.job.instance.hand is None else "an empty hand at the start"

    def _weighed_seconds(self) -> dict[str, float]:
        """Return what weighing has taken, in the words of `details`."""
        return {"weighed_seconds": round(monotonic() - self.begun - self.asked.spent, 3)}

    def _why_not_rehearsed(self) -> str:
        missing = next((module for module in EXECUTION if not is_there(module)), None)
        if missing is not None:
            return str(MissingExtra("a rehearsal of its motions", missing))
        if self.rehearsal is None:
            return "no motion was rehearsed, which takes the built-in scene and an empty hand"
        return "the budget did not suffice to rehearse motions"

    def _rehearsed(self, candidates: Sequence[Candidate]) -> tuple[Candidate, str]:
        """Return the plan that takes the least time, by rehearsal as far as time allows; and how it was found."""
        until = self.begun + self.job.budget
        seen: dict[tuple[Action, ...], list[float]] = {}
        plans = {candidate.actions: candidate for candidate in candidates}

        def rehearse(actions: Iterable[tuple[Action, ...]], seed: int) -> None:
            longest = 0.0
            for plan in actions:
                begun, longest = monotonic(), max(longest, AN_ACTION * len(plan))
                if begun + longest > until or self.stopped():
                    return
                seen.setdefault(plan, []).append(self._seconds(plans[plan], seed))
                longest = max(longest, monotonic() - begun)

        def mean(actions: tuple[Action, ...]) -> tuple[float, float]:
            return round(sum(seen[actions]) / len(seen[actions]), 1), plans[actions].expected.risk

        if self.rehearsal is not None:
            rehearse(list(plans), SEEDS[0])
            self._climb(plans, seen, rehearse, mean, self.begun + CLIMBED * self.job.budget)
            for seed in SEEDS[1:]:
                rehearse(sorted(seen, key=mean)[:FINALISTS], seed)
        if not seen:
            best = min(plans.values(), key=lambda plan: (round(plan.expected.seconds, 1), plan.expected.risk))
            return best, MODEL_ALONE
        twice = [plan for plan, values in seen.items() if len(values) == len(SEEDS)] or list(seen)
        best = plans[min(twice, key=mean)]
        seconds = sum(seen[best.actions]) / len(seen[best.actions])
        how = f"{counted(len(seen), 'plan')} rehearsed"
        return replace(best, expected=replace(best.expected, seconds=seconds)), how

    def _climb(
        self,
        plans: dict[tuple[Action, ...], Candidate],
        seen: Mapping[tuple[Action, ...], list[float]],
        rehearse: Callable[[Iterable[tuple[Action, ...]], int], None],
        mean: Callable[[tuple[Action, ...]], tuple[float, float]],
        until: float,
    ) -> None:
        """Rehearse neighbours of the best plan, and of what is better than it in turn, as long as there is time."""
        random, left = Random(self.job.settings.seed), CLIMBS
        while seen and left and monotonic() < until and not self.stopped():
            best = min(seen, key=mean)
            most = plans[best].expected.seconds + WORTH_A_TRY
            for candidate in neighbours(self.forecaster, best, random, TRIES):
                left -= 1
                if candidate.actions not in plans and candidate.expected.seconds <= most:
                    plans[candidate.actions] = candidate
                    rehearse([candidate.actions], SEEDS[0])
                if not left or monotonic() > until or self.stopped() or min(seen, key=mean) != best:
                    break
            else:
                return

    def _seconds(self, candidate: Candidate, seed: int) -> float:
        """Return what a plan takes in one rehearsal, what it risks included [s]."""
        assert self.rehearsal is not None
        trouble = self.forecaster.model.trouble
        rehearsed = self.rehearsal.of(self.job.problem, candidate.actions, seed)
        foreseen = list(self.forecaster.steps(candidate.actions))
        return sum(
            expected.seconds + (1.0 - expected.risk) * trouble  # a missed action is trouble for sure
            if done.seconds is None
            else done.seconds + expected.risk * trouble
            for done, expected in zip(rehearsed, foreseen, strict=True)
        )

    def _report(self, chosen: Candidate, details: dict[str, object]) -> Report:
        """Return the planner's report with another plan: cost, bound and status speak of actions."""
        asked = self.asked.report()
        verdict = self.forecaster.law.check(chosen.actions)
        cost = verdict.cost
        assert cost is not None, verdict
        bound = asked.plan.lower_bound
        proven = bound is not None and bound >= cost
        taken = monotonic() - self.begun
        incumbents = asked.plan.incumbents
        if not incumbents or cost < incumbents[-1].cost:
            incumbents += (Incumbent(taken, cost, ORIGIN),)
        plan = replace(
            asked.plan,
            status="optimal" if proven else "feasible",
            actions=chosen.actions,
            incumbents=incumbents,
            stated_cost=cost,
            details={**asked.plan.details, **details, **self._weighed_seconds(), "risk": chosen.expected.risk},
            expected_seconds=chosen.expected.seconds,
        )
        return replace(
            asked,
            outcome="interrupted" if self.stopped() else "optimal" if proven else "feasible",
            reason="stopped from outside" if self.stopped() else "",
            plan=plan,
            verdict=Verdict(True, cost=cost),
            wall_seconds=taken,
        )
