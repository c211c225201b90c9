"""The audit of a sweep's records: what a reader must know before any table is made from them.

Nothing is repaired here: a sweep that is started again does what is missing.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

from smash.experiments.sweeps.certified import certified
from smash.experiments.sweeps.experiment import Run
from smash.records.believing import Judged, believe, judge
from smash.records.episodes import EpisodeRecord
from smash.records.files import RUNS, RecordFile
from smash.records.reading import Damaged, Line, Reading, read
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


def audit(results: Path, planned: Callable[[Sequence[RunRecord]], Sequence[Run] | str]) -> list[Check]:
    """Return what was asked of the records in `results/runs.jsonl`, and the answers.

    Args:
        results: the directory that a sweep wrote.
        planned: from its records to the runs of its experiment, or in words why they are not known.

    Raises:
        MalformedFile: where there is no file to be read.
    """
    reading = read(results, RUNS)
    lines = reading.lines
    judged = judge(line.record for line in lines)
    return [
        whole_lines(reading, results, RUNS),
        *_against_plan(lines, planned(reading.records)),
        *sound(lines),
        _outcomes(lines),
        _plans(judged, [line.number for line in lines]),
        *_claims(results, judged),
    ]


def sound(lines: Sequence[Line[Swept]]) -> list[Check]:
    """Return what is asked of records of every kind: nothing twice, one commit, one version of each package."""
    return [_twice(lines), _commits(lines), _versions(lines)]


def whole_lines(reading: Reading[Swept], results: Path, kind: RecordFile[Swept]) -> Check:
    """Return a check with one line for each line of a file that is no record."""
    damaged = [f"damaged: line {line.number}: {line.reason}{_remedy(line, reading.ended)}" for line in reading.damaged]
    aside = kind.aside(results)
    count = sum(1 for part in aside.read_bytes().split(b"\n") if part) if aside.is_file() else 0
    set_aside = f" ({count} set aside by an earlier start)" if count else ""
    return Check("every line whole", f"{len(reading.lines)} whole, {len(damaged)} damaged{set_aside}", damaged)


def _remedy(line: Damaged, ended: bool) -> str:
    kill = ", as a kill leaves it" if line.last and not ended else ""
    return f"{kill}; start the sweep again: it is set aside, its run done"


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
    return _told(line.record, line.number)


def _told(record: RunRecord | EpisodeRecord, number: int) -> str:
    setting = f"{record.label} on {record.suite}/{record.instance}, {record.variant}"
    if isinstance(record, EpisodeRecord):
        return f"line {number} ({setting}, {record.policy}, seed {record.seed})"
    return f"line {number} ({setting}, {record.buffers} buffers)"


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


def _plans(judged: Sequence[Judged], numbers: Sequence[int]) -> Check:
    """Name the plans that the law refused when they were made, and those that it refuses now."""
    words = []
    for run, number in zip(judged, numbers, strict=True):
        record, verdict = run.record, run.record.verdict
        if record.outcome == "refused" or (verdict is not None and not verdict.accepted):
            words.append(f"refused: {_told(record, number)}: {record.reason or (verdict and verdict.reason)}")
        elif run.refusal:
            words.append(f"refused now: {_told(record, number)}: {run.refusal}")
    count = sum(run.record.actions is not None for run in judged)
    return Check("the law accepts every plan", f"{count} plans checked again", words)


def _claims(results: Path, judged: Sequence[Judged]) -> Iterator[Check]:
    """Hold what is claimed of all plans against the plans that there are, and against start and goal."""
    proofs, unproven = certified(results, [run.problem for run in judged if run.counts and run.problem is not None])
    found = believe(judged, proofs)
    words = [f"contradiction: {contradiction}" for contradiction in found.contradictions]
    claims = sum(run.record.status in ("optimal", "infeasible") for run in judged)
    yield Check("no claim contradicted", f"{claims} proofs of optimality or that there is no plan", words)
    if found.unproven:
        first = "; ".join(found.unproven[:3])
        yield Check("that there is no plan", f"not known: {len(found.unproven)} claims that nothing decides: {first}")
    if proofs or unproven:
        yield Check("every certificate proves its bound", f"{len(proofs)} certificates checked", unproven)
