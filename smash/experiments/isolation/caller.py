"""One planner call in processes of its own, with limits, seen from the caller's side.

What the run says arrives line by line, so that a run that is stopped keeps what it had found. Every plan is judged
by the law here, whatever planner made it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from threading import Event
from time import monotonic
from typing import Any

from smash.experiments.isolation.hearing import hear_out
from smash.experiments.isolation.job import STARTUP_LIMIT, Job, Report, load, longest
from smash.planners.protocol import OnIncumbent
from smash.problem.errors import SmashError
from smash.problem.files.plans import action_from_list
from smash.problem.model import Action
from smash.problem.plan import Incumbent, Plan, Status
from smash.problem.rules import Verdict
from smash.records.claims import claimed_infeasible
from smash.records.outcomes import OutcomeName

LATENCY = 0.25
"""Seconds that a line may take on its way: a plan that is said to be older than that counts from its arrival."""

SAID_BY_PLANNERS = frozenset({"crashed", "memory", "not-installed", "malformed", "unsupported"})
"""Outcomes that the process of a planner may name."""


def run_isolated(
    job: Job, on_incumbent: OnIncumbent | None = None, stop: Event | None = None, *, for_this: bool = False
) -> Report:
    """Run one job to its end and report; when this returns or raises, all of its processes are gone.

    Args:
        job: what to run, and its limits.
        on_incumbent: called with every better legal plan as it arrives.
        stop: set from outside, it ends the run, whose outcome is then `interrupted`.
        for_this: whether this process is there for this run alone, as that of `smash plan` is: with one thread it
            may then be forked, which saves loading everything again.
    """
    heard = _Heard(job, on_incumbent)
    hear_out(job, heard, stop, may_fork=for_this)
    return heard.report(interrupted=stop is not None and stop.is_set())


def when(said: float, arrived: float) -> float:
    """Return when a plan was found: as the planner says, within what its line's arrival bears out [s]."""
    return said if arrived - LATENCY <= said <= arrived else arrived


class _Heard:
    """Puts the lines of a run together, judging each plan."""

    def __init__(self, job: Job, on_incumbent: OnIncumbent | None) -> None:
        self._job = job
        self._law = job.problem.law
        self._tell = on_incumbent
        self._best: tuple[Action, ...] | None = None
        self._cost: int | None = None
        self._trace: list[Incumbent] = []
        self._proof: Mapping[str, Any] = {}
        self._refusal: Verdict | None = None
        self._answer: Mapping[str, Any] | None = None
        self._failure: Mapping[str, Any] | None = None
        self._ended: Mapping[str, Any] | None = None
        self._solving = False
        self.until = monotonic() + longest(job.budget)
        """When whoever guards the run is given up."""
        self.silent = False
        """Whether it was."""

    def hear(self, line: bytes) -> bool:
        """Take one line of a run; False where it is none, after which nothing is believed any more."""
        try:
            message = json.loads(line)
            self._take(message)
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError, OverflowError):
            words = f"planner {self._job.planner!r} wrote to the pipe on which its run speaks: {line[:60]!r}"
            self._failure = {"outcome": "crashed", "reason": words}
            return False
        return True

    def _take(self, message: Mapping[str, Any]) -> None:
        arrived = message["at"]
        match message["kind"]:
            case "incumbent":
                seconds = when(message["seconds"], arrived)
                self._plan(message["actions"], message["cost"], seconds, self._job.planner)
            case "bound":
                if message["bound"] > self._proof.get("lower_bound", -1):
                    self._proof = {"lower_bound": message["bound"], "bound_origin": message["origin"]}
            case "result":
                self._answer = message
                self._take_answer(message, arrived)
            case "failed":
                self._failure = self._believed(message)
            case "ended":
                self._ended = self._believed(message)
            case "solving":
                self._solving = True
                self.until = monotonic() + longest(self._job.budget) - STARTUP_LIMIT
            case other:
                raise ValueError(f"no line of a run: {other!r}")

    def _believed(self, message: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return how a run ended, where whoever says so may.

        Raises:
            ValueError: where a planner says what its guardian alone can, or nobody.
        """
        outcome = message["outcome"]
        if message["by"] == "planner" and (
            message["kind"] == "ended" or outcome not in SAID_BY_PLANNERS or (outcome == "malformed" and self._solving)
        ):
            raise ValueError("said by the planner")
        return message

    def report(self, interrupted: bool) -> Report:
        """Return the report, once nothing more is to come.

        Raises:
            SmashError: where the planner's name or an option is wrong.
        """
        outcome, reason = self._outcome(interrupted)
        if outcome == "malformed":
            raise SmashError(reason)
        answer = self._answer or {}
        ended = self._ended or {}
        refused = outcome == "refused"
        proof = {} if self._refusal is not None else self._answer or self._proof
        status: Status = "unknown" if self._best is None else "feasible"
        if not refused and answer.get("status") in ("optimal", "infeasible"):
            status = answer["status"]
        elif self._best is not None and proof.get("lower_bound") == self._cost:
            status = "optimal"
        verdict = self._refusal
        if verdict is None and self._best is not None:
            verdict = Verdict(True)
        plan = Plan(
            instance=self._job.instance.name,
            planner=self._job.planner,
            options=self._job.options,
            status=status,
            actions=self._best,
            lower_bound=self._cost if status == "optimal" else proof.get("lower_bound"),
            bound_origin=proof.get("bound_origin") or (self._job.planner if status == "optimal" else None),
            incumbents=tuple(self._trace),
            stated_cost=self._cost,
            details=answer.get("details", {}),
        )
        return Report(
            outcome=outcome,
            plan=plan,
            reason=reason,
            verdict=verdict,
            wall_seconds=ended.get("wall_seconds"),
            cpu_seconds=ended.get("cpu_seconds"),
            memory_mib=ended.get("memory_mib"),
            log=ended.get("log", ""),
        )

    def _take_answer(self, answer: Mapping[str, Any], arrived: float) -> None:
        origins = {cost: origin for _, cost, origin in answer["incumbents"]}
        self._trace = [entry._replace(origin=origins.get(entry.cost, entry.origin)) for entry in self._trace]
        actions, status, bound = answer["actions"], answer["status"], answer["lower_bound"]
        if (actions is None) != (status in ("infeasible", "unknown")):
            return self._refuse(f"status {status} {'without' if actions is None else 'with'} a plan")
        if actions is not None:
            stated = answer["cost"]
            self._plan(actions, stated, when(answer["seconds"], arrived), origins.get(stated, self._job.planner))
        best = self._cost
        if status == "infeasible" and best is not None:
            return self._refuse("status infeasible, yet it had reported a legal plan")
        if status == "infeasible" and claimed_infeasible(self._job.problem) is False:
            return self._refuse("status infeasible, yet start and goal show that there is a plan")
        if best is not None and bound is not None and bound > best:
            return self._refuse(f"lower bound {bound}, yet there is a legal plan of {best}")
        if status == "optimal" and actions is not None and (answer["cost"] != best or bound not in (None, best)):
            return self._refuse(f"status optimal at cost {answer['cost']}, best legal plan {best}, lower bound {bound}")
        return None

    def _plan(self, entries: list[Any], cost: int, seconds: float, origin: str) -> None:
        """Judge a plan, and keep it where it is legal and the best."""
        try:
            actions = tuple(action_from_list(entry, "plan") for entry in entries)
        except SmashError as error:
            return self._refuse(str(error))
        verdict = self._law.check(actions)
        if not verdict.accepted:
            self._refusal = self._refusal or verdict
        elif cost != verdict.cost:
            self._refuse(f"its cost says {cost}, the law counts {verdict.cost}")
        elif self._cost is None or cost < self._cost:
            self._best, self._cost = actions, cost
            self._trace.append(Incumbent(seconds, cost, origin))
            if self._tell is not None:
                self._tell(seconds, cost, actions)
        return None

    def _refuse(self, reason: str) -> None:
        self._refusal = self._refusal or Verdict(False, reason)

    def _outcome(self, interrupted: bool) -> tuple[OutcomeName, str]:
        if self._cost is not None and self._proof.get("lower_bound", 0) > self._cost:
            self._refuse(f"lower bound {self._proof['lower_bound']}, yet there is a legal plan of {self._cost}")
        if self._ended is not None and self._ended["outcome"] == "memory":
            return "memory", self._ended["reason"]
        if self._failure is not None:
            return self._failure["outcome"], self._failure["reason"]
        if self._refusal is not None:
            return "refused", str(self._refusal)
        if self._answer is not None:
            status: Status = self._answer["status"]
            if status == "infeasible" and claimed_infeasible(self._job.problem) is None:
                return status, f"a claim of planner {self._job.planner!r}: nothing here decides it"
            if status == "unknown" and (refused := _refused_plans(self._answer)):
                return "refused", refused[0]
            return ("budget-spent" if status == "unknown" else status), ""
        if interrupted:
            return "interrupted", "stopped from outside"
        if self._ended is not None:
            return self._ended["outcome"], self._ended["reason"]
        guard = f"stood still ({load()})" if self.silent else "was killed"
        return "crashed", f"the process that guards the run {guard}"


def _refused_plans(answer: Mapping[str, Any]) -> list[str]:
    """Return why the plans of an engine behind the planner were none, which the planner has noted itself."""
    details = answer.get("details")
    noted = details.get("refused") if isinstance(details, Mapping) else None
    return [why for why in noted if isinstance(why, str)] if isinstance(noted, list) else []
