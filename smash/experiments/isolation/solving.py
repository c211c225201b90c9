"""Inside a run's own process: load the planner, call it, and say what it finds as JSON lines on a pipe.

Lines: `solving` (the clock starts), `incumbent` and `bound` (at once), then `result` or `failed`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from time import perf_counter
from typing import Any, NoReturn

from smash.experiments.isolation.job import Job
from smash.experiments.isolation.voice import Voice, to_its_end
from smash.planners.protocol import ask
from smash.planners.registry import get_planner, make_ready, planner_names, why_unknown
from smash.problem.errors import SmashError, Unsupported
from smash.problem.extras import MissingExtra
from smash.problem.files.plans import action_list
from smash.problem.model import Action
from smash.problem.plan import STATUSES, Plan


def load() -> None:
    """Load what runs need in common: entry points are read once for all of them; no planner is imported."""
    planner_names()


def solve(job: Job, pipe: int) -> NoReturn:
    """Run the job and end the process."""
    voice = _Voice(pipe)
    to_its_end(voice, lambda: _solve(job, voice))


def _solve(job: Job, voice: _Voice) -> None:
    try:
        planner = get_planner(job.planner)
    except Unsupported as error:
        return voice.say(kind="failed", outcome="not-installed", reason=str(error))
    except SmashError as error:  # no such planner, or no such encoding for it
        return voice.say(kind="failed", outcome="malformed", reason=str(error))
    warm_start = job.settings.warm_start
    if warm_start is not None and (unknown := why_unknown(warm_start)) is not None:
        return voice.say(kind="failed", outcome="malformed", reason=unknown)
    try:
        make_ready(planner, job.planner, job.problem, job.settings)
        voice.say(kind="solving")
        voice.started = perf_counter()
        plan = ask(planner, job.problem, job.settings, job.budget, voice, name=job.planner)
    except MissingExtra as error:  # the solver that it is told to use
        return voice.say(kind="failed", outcome="not-installed", reason=str(error))
    except Unsupported as error:
        return voice.say(kind="failed", outcome="unsupported", reason=str(error))
    seconds = perf_counter() - voice.started
    voice.say(kind="result", seconds=seconds, **_answer(plan))
    return None


class _Voice(Voice):
    """The pipe to the guardian, and the planner's `on_incumbent`; planners may report from any thread."""

    def __init__(self, pipe: int) -> None:
        super().__init__(pipe)
        self.started = 0.0

    def __call__(self, seconds: float, cost: int, actions: Sequence[Action]) -> None:
        """Report a plan."""
        at = self._time(seconds)
        self.say(kind="incumbent", seconds=at, cost=int(cost), actions=[action_list(action) for action in actions])

    def bound(self, seconds: float, bound: int, origin: str) -> None:
        """Report a lower bound; one that is not finite says nothing."""
        if math.isfinite(bound):
            self.say(kind="bound", seconds=self._time(seconds), bound=int(bound), origin=str(origin))

    def _time(self, seconds: float) -> float:
        """Return when it was; a time that is negative or still to come is replaced by now."""
        now = perf_counter() - self.started
        return float(seconds) if 0 <= seconds <= now else now


def _answer(result: Plan) -> dict[str, Any]:
    try:
        if result.status not in STATUSES:
            raise ValueError(f"status {result.status!r} is not one of {', '.join(STATUSES)}")
        bound = result.lower_bound
        return {
            "status": result.status,
            "actions": None if result.actions is None else [action_list(action) for action in result.actions],
            "cost": result.cost,
            "lower_bound": None if bound is None or not math.isfinite(bound) else int(bound),
            "bound_origin": None if result.bound_origin is None else str(result.bound_origin),
            "incumbents": [[float(at), int(cost), str(origin)] for at, cost, origin in result.incumbents],
            "details": jsonable(dict(result.details)),
        }
    except (AttributeError, OverflowError, TypeError, ValueError) as error:
        raise TypeError(f"solve returned no valid PlanResult: {error}") from error


def jsonable(value: Any) -> Any:
    """Return `value` as plain JSON data: numbers that are not finite become None, unknown objects their words."""
    match value:
        case None | bool() | int() | str():
            return value
        case float():
            return value if math.isfinite(value) else None
        case dict():
            return {str(key): jsonable(part) for key, part in value.items()}
        case list() | tuple() | set() | frozenset():
            return [jsonable(part) for part in value]
    plain = getattr(value, "item", None)
    return jsonable(plain()) if plain is not None and getattr(value, "ndim", 1) == 0 else str(value)
