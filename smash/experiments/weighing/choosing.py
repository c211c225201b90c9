"""One plan is chosen of those that planners found, and of what is near them: the fastest, or that of least risk."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from random import Random
from time import monotonic
from typing import TYPE_CHECKING

from smash.experiments.isolation.job import Job
from smash.forecast.expected import Forecaster
from smash.forecast.model import OutcomeModel
from smash.forecast.robust import least_risk
from smash.forecast.search import Candidate, faster, neighbours
from smash.planners.protocol import ACTIONS
from smash.problem.errors import Unsupported
from smash.problem.extras import EXECUTION, MissingExtra, is_there
from smash.problem.model import Action
from smash.problem.words import counted

if TYPE_CHECKING:
    from smash.execution.rehearsal import Rehearsal

ANNEALED = 0.6
"""When the annealing has to be done, as a share of the budget."""
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


@dataclass(frozen=True, slots=True)
class Question:
    """What is chosen from, and what for.

    Attributes:
        job: what the plan is for; its settings have the objective, its budget is what is left of after `spent`.
        starts: legal plans, at least one.
        spent: of the budget, by whoever found them [s].
        proven: whether the first of them has the fewest actions possible.
    """

    job: Job
    starts: tuple[tuple[Action, ...], ...]
    spent: float
    proven: bool


@dataclass(frozen=True, slots=True)
class Choice:
    """The plan that is chosen.

    Attributes:
        actions: the plan.
        seconds: what choosing it took [s].
        details: what is to be said of it.
        expected_seconds: what its execution is expected to take [s]; None where it was chosen for its risk.
    """

    actions: tuple[Action, ...]
    seconds: float
    details: Mapping[str, object]
    expected_seconds: float | None = None


Choose = Callable[[Question], Choice]


def ready(question: Question, model: OutcomeModel) -> Rehearsal | None:
    """Make the scene's rehearsal ready, where one is wanted.

    Returns:
        None where motions cannot be planned here, the model is of another scene, or no time is asked for.
    """
    job = question.job
    if job.settings.objective == ACTIONS or job.instance.hand is not None:
        return None
    if not all(is_there(module) for module in EXECUTION):
        return None
    from smash.execution.actions.arm_motions import ArmMotions
    from smash.execution.rehearsal import Rehearsal
    from smash.execution.scene.scene_file import default_scene

    if default_scene().fingerprint != model.layout:
        return None
    ArmMotions(default_scene()).warm_up()
    return Rehearsal(default_scene(), model)


def breaks_ties(question: Question, forecaster: Forecaster) -> bool:
    """Return whether plans of the first one's cost have to be looked at for one of less risk.

    Args:
        question: what from, and what for.
        forecaster: of its problem.
    """
    if question.job.settings.objective != ACTIONS or why_no_ties(question) is not None:
        return False
    first = question.starts[0]
    return forecaster.of(first).risk > 0.0 or forecaster.misfit(first) is not None


def why_no_ties(question: Question) -> str | None:
    """Return what is missing for ties to be broken by risk, or None."""
    if not question.proven:
        return "a proven optimum"
    if not question.job.problem.plain:
        return "actions of cost 1"
    return None if question.job.instance.hand is None else "an empty hand at the start"


def choose(
    question: Question, forecaster: Forecaster, rehearsal: Rehearsal | None, stopped: Callable[[], bool] = lambda: False
) -> Choice:
    """Choose a plan, within what is left of the budget.

    Args:
        question: what from, and what for.
        forecaster: of its problem.
        rehearsal: of the scene, as `ready` makes it.
        stopped: whether to end early.
    """
    choosing = _Choosing(question, forecaster, rehearsal, monotonic(), stopped)
    return choosing.robust() if question.job.settings.objective == ACTIONS else choosing.fastest()


@dataclass(frozen=True)
class _Choosing:
    """How one question is answered; the clock of its budget stood at `question.spent` when it was `started`."""

    question: Question
    forecaster: Forecaster
    rehearsal: Rehearsal | None
    started: float
    stopped: Callable[[], bool]

    @property
    def _begun(self) -> float:
        """When the clock of the whole budget would have started."""
        return self.started - self.question.spent

    def fastest(self) -> Choice:
        """Return the plan that takes the least time.

        Raises:
            Unsupported: where the scene has no room for any plan that was found.
        """
        starts, job = self.question.starts, self.question.job
        candidates = faster(
            self.forecaster,
            starts,
            seed=job.settings.seed,
            until=self._begun + ANNEALED * job.budget,
            stopped=self.stopped,
        )
        misfits = {start: self.forecaster.misfit(start) for start in starts}
        given = [Candidate(start, self.forecaster.of(start)) for start in starts if misfits[start] is None]
        if not given and not candidates:
            raise Unsupported(f"expected times and risk: no plan was found that fits; one has {misfits[starts[0]]}")
        chosen, how = self._rehearsed([*given, *candidates])
        details: dict[str, object] = {"weighed": how}
        if how == MODEL_ALONE:
            details["note"] = f"expected_seconds is {how}: {self._why_not_rehearsed()}"
        details |= {**self._weighed_seconds(), "risk": chosen.expected.risk}
        return Choice(chosen.actions, monotonic() - self.started, details, chosen.expected.seconds)

    def robust(self) -> Choice:
        """Return the plan of least risk among those of the first one's cost."""
        actions = self.question.starts[0]
        risk = self.forecaster.of(actions).risk
        lacking = why_no_ties(self.question)
        if lacking is not None:
            note = f"ties are not broken by risk: that takes {lacking}"
            return Choice(actions, monotonic() - self.started, {"risk": risk, "note": note})
        found = least_risk(self.forecaster, actions, self._begun + self.question.job.budget, self.stopped)
        details = {**self._weighed_seconds(), "risk": found.risk, "risk_before": risk}
        misfit = self.forecaster.misfit(found.actions)
        if misfit is not None:
            details["note"] = f"no plan of this cost was found that fits the scene; this one has {misfit}"
        elif not found.exact:
            details["note"] = "not all optimal plans could be looked at: there may be one of less risk"
        return Choice(found.actions, monotonic() - self.started, details)

    def _weighed_seconds(self) -> dict[str, object]:
        """Return what choosing has taken, in the words of `details`."""
        return {"weighed_seconds": round(monotonic() - self.started, 3)}

    def _why_not_rehearsed(self) -> str:
        missing = next((module for module in EXECUTION if not is_there(module)), None)
        if missing is not None:
            return str(MissingExtra("a rehearsal of its motions", missing))
        if self.rehearsal is None:
            return "no motion was rehearsed, which takes the built-in scene and an empty hand"
        return "the budget did not suffice to rehearse motions"

    def _rehearsed(self, candidates: Sequence[Candidate]) -> tuple[Candidate, str]:
        """Return the plan that takes the least time, by rehearsal as far as time allows; and how it was found."""
        until = self._begun + self.question.job.budget
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
            self._climb(plans, seen, rehearse, mean, self._begun + CLIMBED * self.question.job.budget)
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
        random, left = Random(self.question.job.settings.seed), CLIMBS
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
        rehearsed = self.rehearsal.of(self.question.job.problem, candidate.actions, seed)
        foreseen = list(self.forecaster.steps(candidate.actions))
        return sum(
            expected.seconds + (1.0 - expected.risk) * trouble  # a missed action is trouble for sure
            if done.seconds is None
            else done.seconds + expected.risk * trouble
            for done, expected in zip(rehearsed, foreseen, strict=True)
        )
