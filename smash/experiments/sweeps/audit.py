"""The audit of a sweep's records: what a reader must know before any table is made from them.

Nothing is repaired here: a sweep that is started again does what is missing.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

from smash.experiments.sweeps.experiment import Run, instance_hash
from smash.problem.errors import SmashError
from smash.problem.files.instances import instance_from_document
from smash.problem.plan import check_plan
from smash.records.episodes import EpisodeRecord
from smash.records.files import RUNS, RecordFile
from smash.records.reading import NO_JSON, Damaged, Line, Reading, read
from smash.records.runs import RunRecord

NEEDS_REASON = ("crashed", "memory", "over-budget", "refused", "unsupported", "not-installed")
"""Outcomes that say nothing without a reason."""
NOT_RUNS = ("interrupted", "malformed")
"""Outcomes that a sweep never records: such a run is done again."""

Swept = TypeVar("Swept", RunRecord, EpisodeRecord)


class Check(NamedTuple):
    """One question, its answer in a few words, and one line for each thing that is not well."""

    question: str
    answer: str
    findings: Sequence[str] = ()


def audit(results: Path, planned: Sequence[Run] | str) -> list[Check]:
    """Return what was asked of the records in `results/runs.jsonl`, and the answers.

    Args:
        results: the directory that a sweep wrote.
        planned: the runs of its experiment, or in words why they are not known.

    Raises:
        MalformedFile: where there is no file to be read.
    """
    reading = read(results, RUNS)
    lines = reading.lines
    return [
        whole_lines(reading, results, RUNS),
        *_against_plan(lines, planned),
        *sound(lines),
        _outcomes(lines),
        _plans(lines),
    ]


def sound(lines: Sequence[Line[Swept]]) -> list[Check]:
    """Return what is asked of records of every kind: nothing twice, one commit, one version of each package."""
    return [_twice(lines), _commits(lines), _versions(lines)]


def whole_lines(reading: Reading[Swept], results: Path, kind: RecordFile[Swept]) -> Check:
    """Return a check with one line for each line of a file that is no record."""
    damaged = [f"damaged: line {line.number}: {line.reason}{_remedy(line)}" for line in reading.damaged]
    aside = kind.aside(results)
    count = sum(1 for part in aside.read_bytes().split(b"\n") if part) if aside.is_file() else 0
    set_aside = f" ({count} set aside by an earlier start)" if count else ""
    return Check("every line whole", f"{len(reading.lines)} whole, {len(damaged)} damaged{set_aside}", damaged)


def _remedy(line: Damaged) -> str:
    if line.reason != NO_JSON:
        return ""
    return ", as a kill leaves it; start the sweep again" if line.last else ", set it aside and start the sweep again"


def _against_plan(lines: Sequence[Line[RunRecord]], planned: Sequence[Run] | str) -> Iterator[Check]:
    if isinstance(planned, str):
        yield Check("complete", f"not known: {planned}")
        return
    there, meant = {line.record.key for line in lines}, {run.key for run in planned}
    missing = Counter(_setting(run) for run in planned if run.key not in there)
    of = Counter(_setting(run) for run in planned)
    words = [f"missing: {setting}: {count} of {of[setting]} runs" for setting, count in missing.items()]
    yield Check("complete", f"{len(meant & there)} of {len(meant)} planned runs", words)
    strangers = Counter(_recorded_setting(line.record) for line in lines if line.record.key not in meant)
    words = [f"not planned: {setting}: {count} runs" for setting, count in strangers.items()]
    yield Check("nothing but what was planned", f"other records: {strangers.total()}", words)


def _setting(run: Run) -> str:
    return f"{run.label} on {run.suite}, {run.variant}, {run.kind} {run.job.budget:g} s"


def _recorded_setting(record: RunRecord) -> str:
    return f"{record.label} on {record.suite}, {record.variant}, {record.kind} {record.budget:g} s"


def told(line: Line[Swept]) -> str:
    """Return a line in words: its number, and what the record is of."""
    record = line.record
    setting = f"{record.label} on {record.suite}/{record.instance}, {record.variant}"
    if isinstance(record, EpisodeRecord):
        return f"line {line.number} ({setting}, {record.policy}, seed {record.seed})"
    return f"line {line.number} ({setting}, {record.buffers} buffers)"


def _twice(lines: Sequence[Line[Swept]]) -> Check:
    by_key: defaultdict[str, list[Line[Swept]]] = defaultdict(list)
    for line in lines:
        by_key[line.record.key].append(line)
    again = [same for same in by_key.values() if len(same) > 1]
    words = [
        f"twice: {told(same[0])} again in line {', '.join(str(line.number) for line in same[1:])}" for same in again
    ]
    return Check("nothing twice", f"recorded more than once: {len(again)}", words)


def _commits(lines: Sequence[Line[Swept]]) -> Check:
    hashes = Counter(line.record.commit.hash for line in lines)
    changed = sum(line.record.commit.dirty is True for line in lines)
    names = [f"{(found or 'not known')[:12]} ({count} runs)" for found, count in hashes.most_common()]
    words = [f"mixed commits: {', '.join(names)}"] if len(hashes) > 1 else []
    if changed:
        words.append(f"changed files: {changed} of {len(lines)} runs were made with changes that no commit holds")
    return Check("one commit, no changed files", ", ".join(names) or "none", words)


def _versions(lines: Sequence[Line[Swept]]) -> Check:
    found: dict[str, Counter[str]] = defaultdict(Counter)
    for line in lines:
        for package, version in line.record.versions.items():
            found[package][version] += 1
    words = [
        f"mixed versions: {package} {', '.join(f'{version} ({count} runs)' for version, count in several.items())}"
        for package, several in sorted(found.items())
        if len(several) > 1
    ]
    machines = len({line.record.machine for line in lines})
    return Check("one version of each package", f"{len(found)} packages, kinds of machine: {machines}", words)


def _outcomes(lines: Sequence[Line[RunRecord]]) -> Check:
    words = []
    for line in lines:
        outcome, reason = line.record.outcome, line.record.reason
        if outcome in NOT_RUNS:
            words.append(f"unexplained: {told(line)}: {outcome} is no end of a run")
        elif outcome in NEEDS_REASON and not reason.strip():
            words.append(f"unexplained: {told(line)}: {outcome} without a reason")
    ends = Counter(line.record.outcome for line in lines)
    return Check("every outcome explained", ", ".join(f"{n} {end}" for end, n in ends.most_common()) or "none", words)


def _plans(lines: Sequence[Line[RunRecord]]) -> Check:
    """Judge every recorded plan anew, and name those that the law refused when they were made."""
    words = list(_refusals(lines))
    count = sum(line.record.actions is not None for line in lines)
    return Check("the law accepts every plan", f"{count} plans checked again", words)


def _refusals(lines: Sequence[Line[RunRecord]]) -> Iterator[str]:
    for line in lines:
        record, verdict = line.record, line.record.verdict
        if record.outcome == "refused" or (verdict is not None and not verdict.accepted):
            yield f"refused: {told(line)}: {record.reason or (verdict and verdict.reason)}"
            continue
        try:
            problem = _shortcoming(record)
        except SmashError as error:
            problem = str(error)
        if problem:
            yield f"refused now: {told(line)}: {problem}"


def _shortcoming(record: RunRecord) -> str:
    """Return what is wrong with a record's instance or plan; empty where nothing is.

    Raises:
        SmashError: where either is malformed.
    """
    instance = instance_from_document(record.instance_document)
    if instance_hash(instance) != record.instance_hash:
        return "its instance does not fit its hash"
    plan = record.plan
    if plan.actions is None:
        return ""
    verdict = check_plan(instance, plan)
    return "" if verdict.accepted else str(verdict)
