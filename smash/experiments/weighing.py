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
from smash.experiments.isolation.job import Job, Report
from smash.forecast.expected import Forecaster
from smash.forecast.model import OutcomeModel, default_model
from smash.forecast.robust import least_risk
from smash.forecast.search import Candidate, faster, neighbours
from smash.planners.protocol import ACTIONS, OnIncumbent
from smash.problem.extras import EXECUTION, MissingExtra, is_there
from smash.problem.model import TABLE, Action, Pick
from smash.problem.plan import Incumbent, Plan
from smash.problem.problem import Problem
from smash.problem.rules import Verdict

if TYPE_CHECKING:
    from smash.execution.rehearsal import Rehearsal

FIRST, SECOND, ANNEALED = 0.3, 0.5, 0.6
"""When the planner's plan, its plan without topple and the annealing have to be there, as shares of the budget."""
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
    counted = replace(job, settings=job.settings.counting)
    if job.settings.objective == ACTIONS:
        report, spent = _timed(solve, replace(counted, budget=ANNEALED * job.budget))
        return _Weighing(job, forecaster, None, monotonic() - spent, stopped).robust(report)
    rehearsal = _rehearsal(job, forecaster.model)
    first, spent = _timed(solve, replace(counted, budget=FIRST * job.budget))
    reports = [first]
    if reports[0].outcome not in ANSWERS:
        return reports[0]
    bare = Problem(job.instance, replace(job.options, topple=False))
    if job.options.topple and bare.infeasible is None:
        left = max(SECOND * job.budget - spent, 0.05 * job.budget)
        second, more = _timed(solve, replace(counted, problem=bare, budget=left))
        reports.append(second)
        spent += more
    return _Weighing(job, forecaster, rehearsal, monotonic() - spent, stopped).fastest(reports)


def _timed(solve: Solve, job: Job) -> tuple[Report, float]:
    """Return a report, and how much of the budget it has cost [s]: import and start of processes are not counted."""
    begun = monotonic()
    report = solve(job)
    return report, monotonic() - begun if report.wall_seconds is None else report.wall_seconds


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
    """What is weighed of one job."""

    job: Job
    forecaster: Forecaster
    rehearsal: Rehearsal | None
    begun: float
    stopped: Callable[[], bool]

    def fastest(self, reports: Sequence[Report]) -> Report:
        """Return the report of the plan that takes the least time."""
        first = reports[0]
        starts = [report.plan.actions for report in reports if report.plan.actions is not None]
        if not starts:
            return first
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
        return self._report(reports, chosen, details)

    def robust(self, report: Report) -> Report:
        """Return the report with the plan of least risk among those of its cost."""
        plan = report.plan
        if plan.actions is None or report.outcome == "interrupted":
            return report
        risk = self.forecaster.of(plan.actions).risk
        if plan.status != "optimal" or not self.job.problem.plain or self.job.instance.hand is not None:
            note = "ties are not broken by risk: that takes a proven optimum, actions of cost 1 and an empty hand"
            return replace(report, plan=replace(plan, details={**plan.details, "risk": risk, "note": note}))
        found = least_risk(self.forecaster, plan.actions, self.begun + self.job.budget, self.stopped)
        details = {**plan.details, "risk": found.risk, "risk_before": risk}
        if not found.exact:
            details["note"] = "not all optimal plans could be looked at: there may be one of less risk"
        return replace(report, plan=replace(plan, actions=found.actions, details=details))

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
        return replace(best, expected=replace(best.expected, seconds=seconds)), f"{len(seen)} plans rehearsed"

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
        missed = [done.action for done in rehearsed if done.seconds is None]
        stuck = sum(isinstance(action, Pick) and action.source == TABLE for action in missed)
        known = sum(
            expected.seconds if done.seconds is None else done.seconds + expected.risk * trouble
            for done, expected in zip(rehearsed, foreseen, strict=True)
        )
        return known + stuck * trouble

    def _report(self, reports: Sequence[Report], chosen: Candidate, details: dict[str, object]) -> Report:
        """Return the first report with another plan: cost, bound and status speak of actions."""
        first = reports[0]
        verdict = self.forecaster.law.check(chosen.actions)
        cost = verdict.cost
        assert cost is not None, verdict
        bound = first.plan.lower_bound
        proven = bound is not None and bound >= cost
        taken = monotonic() - self.begun
        earlier = tuple(entry for entry in first.plan.incumbents if entry.cost > cost)
        plan = Plan(
            instance=first.plan.instance,
            planner=first.plan.planner,
            options=first.plan.options,
            status="optimal" if proven else "feasible",
            actions=chosen.actions,
            lower_bound=bound,
            bound_origin=first.plan.bound_origin,
            incumbents=(*earlier, Incumbent(taken, cost, ORIGIN)),
            stated_cost=cost,
            details={**first.plan.details, **details, "risk": chosen.expected.risk},
            expected_seconds=chosen.expected.seconds,
        )
        return replace(
            first,
            outcome="interrupted" if self.stopped() else "optimal" if proven else "feasible",
            reason="stopped from outside" if self.stopped() else "",
            plan=plan,
            verdict=Verdict(True, cost=cost),
            wall_seconds=taken,
        )
