"""What of a sweep's runs is believed: every plan is judged by the law again, every claim held against all plans.

Tables and figures are made of believed runs alone. A plan that the law refuses is none; a planner that has been caught
with a false claim proves nothing there, its plans count as such.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import msgspec

from smash.problem.errors import MalformedFile, SmashError
from smash.problem.files.instances import instance_from_document
from smash.problem.model import PlanOptions
from smash.problem.plan import check_plan
from smash.problem.problem import Problem
from smash.records.claims import Claim, Contradiction, Fact, Posed, contradictions
from smash.records.files import RUNS
from smash.records.reading import NoRecords, finished
from smash.records.record import shown
from smash.records.runs import RunRecord, instance_hash
from smash.records.sharing import kept_objects
from smash.records.variants import variant_options


@dataclass(frozen=True)
class Judged:
    """A run and what the law says of it.

    Attributes:
        record: the run as it was recorded.
        problem: what was asked; None where the record does not say it.
        refusal: why its plan or what it says of itself cannot be true; empty where nothing is wrong.
    """

    record: RunRecord
    problem: Problem | None
    refusal: str = ""

    @property
    def counts(self) -> bool:
        """Whether its plan and its proofs count."""
        verdict = self.record.verdict
        return not self.refusal and self.record.outcome != "refused" and (verdict is None or verdict.accepted)


@dataclass(frozen=True)
class Believed:
    """Runs as they are believed.

    Attributes:
        judged: the runs as they were recorded.
        contradictions: claims that are false.
        unproven: in words, who says of which problems that they have no plan, where nothing here can say whether.
        notes: in words, what of the file does not count.
    """

    judged: Sequence[Judged]
    contradictions: Sequence[Contradiction]
    unproven: Sequence[str] = ()
    notes: Sequence[str] = ()

    @property
    def liars(self) -> frozenset[str]:
        """The labels of the planners with a false claim."""
        return frozenset(found.claim.who for found in self.contradictions)

    @cached_property
    def records(self) -> list[RunRecord]:
        """The runs as tables show them: without plans that the law refuses, without the proofs of liars."""
        return [shown(_as_believed(judged, self.liars)) for judged in self.judged]

    def lines(self) -> Iterator[str]:
        """Yield in words what tables made of them leave out: first what contradicts, then what the law refuses."""
        yield from (f"contradiction: {found}" for found in self.contradictions)
        yield from self.rest()

    def rest(self) -> Iterator[str]:
        """Yield in words what else than contradictions tables leave out, or could not decide."""
        if self.liars:
            yield f"left out: every proof of {', '.join(sorted(self.liars))}"
        for judged in self.judged:
            if judged.refusal:
                yield f"refused now: {named(judged.record)}: {judged.refusal}"
        yield from (f"not decided: {words}" for words in self.unproven)
        yield from self.notes

    def only(self, keys: Collection[str]) -> Believed:
        """Return the runs with these keys, as they are believed beside the others."""
        return replace(self, judged=[run for run in self.judged if run.record.key in keys])


def named(record: RunRecord) -> str:
    """Return what a run is of, for people."""
    return f"{record.label} on {where(record)}"


def where(record: RunRecord) -> str:
    """Return a run's problem, for people."""
    return f"{record.suite}/{record.instance}, {record.variant}, {record.buffers} buffers"


def judge(records: Iterable[RunRecord]) -> list[Judged]:
    """Have the law judge runs; equal instances are read once."""
    read: dict[tuple[str, PlanOptions], list[tuple[dict[str, Any], Problem | str]]] = {}
    judged = []
    with kept_objects():
        for record in records:
            options = PlanOptions(record.topple, record.max_topple, without=tuple(record.without))
            known = read.setdefault((record.instance_hash, options), [])
            problem = next((made for document, made in known if document == record.instance_document), None)
            if problem is None:
                problem = _problem(record, options)
                known.append((record.instance_document, problem))
            if isinstance(problem, str):
                judged.append(Judged(record, None, problem))
            else:
                judged.append(Judged(record, problem, _mismatch(record, problem) or _shortcoming(record, problem)))
    return judged


def believed_runs(results: Path, keys: Collection[str] | None = None) -> Believed:
    """Return the runs of a results directory, or those of them that are meant, as they are believed.

    Raises:
        NoRecords: where there are none.
        MalformedFile: where they cannot be read, or runs under one label are of several solvers.
    """
    reading = finished(results, RUNS)
    _expect_one_solver((run for run in reading.records if keys is None or run.key in keys), str(reading.path))
    found = replace(believed(reading.records), notes=tuple(reading.notes()))
    if keys is not None:
        found = found.only(keys)
    if not found.judged:
        raise NoRecords(str(reading.path), f"no finished {RUNS.one}")
    return found


def _expect_one_solver(runs: Iterable[RunRecord], where: str) -> None:
    """Refuse runs that stand under one label and were solved by several solvers: a table would mix them."""
    solvers: dict[str, str] = {}
    for run in runs:
        other = solvers.setdefault(run.label, run.solver)
        if other != run.solver:
            words = f"runs labelled {run.label!r} are of the solvers {other} and {run.solver}"
            raise MalformedFile(where, f"{words}; tables do not mix solvers, give each a label of its own")


def believed(records: Iterable[RunRecord], further: Iterable[Claim] = ()) -> Believed:
    """Judge runs and hold their claims against their plans.

    Args:
        records: the runs.
        further: claims from elsewhere, certificates say, to be held against the plans too.
    """
    return believe(judge(records), further)


def believe(judged: Sequence[Judged], further: Iterable[Claim] = ()) -> Believed:
    """Hold the claims of judged runs, and further ones, against their plans."""
    posed: dict[int, Posed] = {}

    def posed_of(problem: Problem) -> Posed:
        made = posed.get(id(problem))
        if made is None:
            made = posed[id(problem)] = Posed.of(problem.instance, problem.options)
        return made

    plans, claims = [], [*further]
    with kept_objects():
        for run in judged:
            record, problem = run.record, run.problem
            if problem is None or not run.counts:
                continue
            told = where(record)
            if record.cost is not None:
                plans.append(Fact(posed_of(problem), record.cost, record.label, told))
            bound = claimed_bound(record)
            if bound is not None or record.status == "infeasible":
                claims.append(Claim(problem, posed_of(problem), bound, record.label, told))
        found = list(dict.fromkeys(contradictions(plans, claims)))
    false = {contradiction.claim for contradiction in found}
    open_claims = [claim for claim in claims if claim.bound is None and claim.decided is None and claim not in false]
    unproven = [f"{claim.where}: {claim.who} says that there is no plan" for claim in open_claims]
    return Believed(judged, found, list(dict.fromkeys(unproven)))


def claimed_bound(record: RunRecord) -> int | None:
    """Return the lower bound that a run claims, an optimal plan's being its cost; None where it claims none."""
    if record.status == "infeasible":
        return None
    return record.cost if record.status == "optimal" else record.lower_bound


def _problem(record: RunRecord, options: PlanOptions) -> Problem | str:
    """Return the problem that a run says it was put, or why it says none."""
    try:
        instance = instance_from_document(record.instance_document)
    except SmashError as error:
        return str(error)
    fits = instance_hash(instance) == record.instance_hash
    return Problem(instance, options) if fits else "its instance does not fit its hash"


def _mismatch(record: RunRecord, problem: Problem) -> str:
    """Return what a run says of its problem that is not so; empty where nothing is."""
    if variant_options(record.variant) != problem.options:
        return f"its variant is {record.variant!r}, its options say otherwise"
    instance = problem.instance
    said = {"instance": record.instance, "buffers": record.buffers, "blocks": record.blocks, "stacks": record.stacks}
    true: dict[str, str | int] = {"instance": instance.name, "buffers": len(instance.buffers)}
    true |= {"blocks": len(instance.blocks), "stacks": len(instance.stacks)}
    wrong = next((name for name in said if said[name] != true[name]), None)
    return "" if wrong is None else f"`{wrong}` says {said[wrong]!r}, its instance {true[wrong]!r}"


def _shortcoming(record: RunRecord, problem: Problem) -> str:
    """Return what cannot be true of a run whose problem is known; empty where nothing is wrong."""
    try:
        plan = record.plan
    except SmashError as error:
        return str(error)
    if record.outcome in ("optimal", "feasible", "infeasible") and record.outcome != record.status:
        return f"its outcome is {record.outcome}, its status {record.status}"
    costs = [cost for _, cost, _ in record.incumbents]
    least = costs[-1:]
    if record.objective == "seconds" and least and record.cost is not None:
        least = [max(record.cost, *least)]
    if costs != sorted(set(costs), reverse=True) or least != ([] if record.cost is None else [record.cost]):
        return f"its incumbents cost {costs}, its plan {'is missing' if record.cost is None else record.cost}"
    if plan.actions is None:
        return ""
    verdict = check_plan(problem.instance, plan)
    return "" if verdict.accepted else str(verdict)


def _as_believed(judged: Judged, liars: frozenset[str]) -> RunRecord:
    record = judged.record
    changes: dict[str, Any] = {}
    if not judged.counts:
        if record.outcome != "refused":
            changes |= {"outcome": "refused", "reason": judged.refusal or "the law refused its plan"}
        changes |= {"status": "unknown" if record.cost is None else "feasible"}
    elif record.label in liars:
        if record.status == "infeasible":
            changes |= {"status": "unknown", "outcome": "refused", "reason": f"{record.label} has made a false claim"}
        elif record.status == "optimal":
            changes |= {"status": "feasible"} | ({"outcome": "feasible"} if record.outcome == "optimal" else {})
    elif record.status == "optimal" and record.lower_bound is None:
        return _changed(record, {"lower_bound": record.cost})
    if not judged.counts or record.label in liars:
        changes |= {"lower_bound": None, "bound_origin": None}
    return _changed(record, changes)


def _changed(record: RunRecord, changes: dict[str, Any]) -> RunRecord:
    if all(getattr(record, name) == value for name, value in changes.items()):
        return record
    made = msgspec.structs.replace(record, **changes)
    made.__dict__["document"] = record.document | changes
    return made
