"""The audit of a sweep's records: what a reader must know before any table is made from them.

Nothing is repaired here: a sweep that is started again does what is missing.
"""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from smash.experiments.sweeps.experiment import Run, instance_hash
from smash.experiments.sweeps.records import DAMAGED, RUN_FORMAT, RUNS, recorded_plan
from smash.problem.errors import MalformedFile, SmashError
from smash.problem.files.documents import convert, read_bytes
from smash.problem.files.instances import instance_from_document
from smash.problem.plan import check_plan
from smash.records.schema import RunRecord

NEEDS_REASON = ("crashed", "memory", "over-budget", "refused", "unsupported", "not-installed")
"""Outcomes that say nothing without a reason."""
NOT_RUNS = ("interrupted", "malformed")
"""Outcomes that a sweep never records: such a run is done again."""


class Line(NamedTuple):
    """A record and its line in the file, from 1."""

    number: int
    record: dict[str, Any]

    def __str__(self) -> str:
        record = self.record
        setting = f"{record['label']} on {record['suite']}/{record['instance']}, {record['variant']}"
        episode = "policy" in record
        more = f"{record['policy']}, seed {record['seed']}" if episode else f"{record['buffers']} buffers"
        return f"line {self.number} ({setting}, {more})"


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
    lines, whole = read_lines(results / RUNS, RunRecord, RUN_FORMAT, results / DAMAGED)
    return [whole, *_against_plan(lines, planned), *sound(lines), _outcomes(lines), _plans(lines)]


def sound(lines: list[Line]) -> list[Check]:
    """Return what is asked of records of every kind: nothing twice, one commit, one version of each package."""
    return [_twice(lines), _commits(lines), _versions(lines)]


def read_lines(path: Path, schema: Any, wanted: str, aside: Path) -> tuple[list[Line], Check]:
    """Return the records of a file that are whole and fit the schema, and a check with one line for each that does not.

    Args:
        path: the file.
        schema: the type of a record.
        wanted: the format that it says.
        aside: the file of the lines that earlier starts have set aside.

    Raises:
        MalformedFile: where the file cannot be read.
    """
    lines, damaged = [], []
    texts = read_bytes(path).removesuffix(b"\n").split(b"\n")
    for number, text in enumerate(texts, start=1):
        if not text and number == 1:
            break
        try:
            record = json.loads(text)
            convert(record, schema, "record")
        except MalformedFile as error:
            damaged.append(f"damaged: line {number}: no {wanted} object: {error.problem}")
        except (ValueError, RecursionError):
            remedy = "as a kill leaves it; start" if number == len(texts) else "set it aside and start"
            damaged.append(f"damaged: line {number}: no JSON, {remedy} the sweep again")
        else:
            lines.append(Line(number, record))
    count = sum(1 for part in aside.read_bytes().split(b"\n") if part) if aside.is_file() else 0
    set_aside = f" ({count} set aside by an earlier start)" if count else ""
    return lines, Check("every line whole", f"{len(lines)} whole, {len(damaged)} damaged{set_aside}", damaged)


def _against_plan(lines: list[Line], planned: Sequence[Run] | str) -> Iterator[Check]:
    if isinstance(planned, str):
        yield Check("complete", f"not known: {planned}")
        return
    there, meant = {line.record["key"] for line in lines}, {run.key for run in planned}
    missing = Counter(_setting(run) for run in planned if run.key not in there)
    of = Counter(_setting(run) for run in planned)
    words = [f"missing: {setting}: {count} of {of[setting]} runs" for setting, count in missing.items()]
    yield Check("complete", f"{len(meant & there)} of {len(meant)} planned runs", words)
    strangers = Counter(_recorded_setting(line.record) for line in lines if line.record["key"] not in meant)
    words = [f"not planned: {setting}: {count} runs" for setting, count in strangers.items()]
    yield Check("nothing but what was planned", f"other records: {strangers.total()}", words)


def _setting(run: Run) -> str:
    return f"{run.label} on {run.suite}, {run.variant}, {run.kind} {run.job.budget:g} s"


def _recorded_setting(record: dict[str, Any]) -> str:
    return f"{record['label']} on {record['suite']}, {record['variant']}, {record['kind']} {record['budget']:g} s"


def _twice(lines: list[Line]) -> Check:
    by_key = defaultdict(list)
    for line in lines:
        by_key[line.record["key"]].append(line)
    again = [same for same in by_key.values() if len(same) > 1]
    words = [f"twice: {same[0]} again in line {', '.join(str(line.number) for line in same[1:])}" for same in again]
    return Check("nothing twice", f"recorded more than once: {len(again)}", words)


def _commits(lines: list[Line]) -> Check:
    hashes = Counter(line.record["commit"]["hash"] for line in lines)
    changed = sum(line.record["commit"]["dirty"] is True for line in lines)
    names = [f"{(found or 'not known')[:12]} ({count} runs)" for found, count in hashes.most_common()]
    words = [f"mixed commits: {', '.join(names)}"] if len(hashes) > 1 else []
    if changed:
        words.append(f"changed files: {changed} of {len(lines)} runs were made with changes that no commit holds")
    return Check("one commit, no changed files", ", ".join(names) or "none", words)


def _versions(lines: list[Line]) -> Check:
    found: dict[str, Counter[str]] = defaultdict(Counter)
    for line in lines:
        for package, version in line.record["versions"].items():
            found[package][version] += 1
    words = [
        f"mixed versions: {package} {', '.join(f'{version} ({count} runs)' for version, count in several.items())}"
        for package, several in sorted(found.items())
        if len(several) > 1
    ]
    machines = len({json.dumps(line.record["machine"], sort_keys=True) for line in lines})
    return Check("one version of each package", f"{len(found)} packages, kinds of machine: {machines}", words)


def _outcomes(lines: list[Line]) -> Check:
    words = []
    for line in lines:
        outcome, reason = line.record["outcome"], line.record["reason"]
        if outcome in NOT_RUNS:
            words.append(f"unexplained: {line}: {outcome} is no end of a run")
        elif outcome in NEEDS_REASON and not reason.strip():
            words.append(f"unexplained: {line}: {outcome} without a reason")
    ends = Counter(line.record["outcome"] for line in lines)
    return Check("every outcome explained", ", ".join(f"{n} {end}" for end, n in ends.most_common()) or "none", words)


def _plans(lines: list[Line]) -> Check:
    """Judge every recorded plan anew, and name those that the law refused when they were made."""
    words = list(_refusals(lines))
    count = sum(line.record["actions"] is not None for line in lines)
    return Check("the law accepts every plan", f"{count} plans checked again", words)


def _refusals(lines: Iterable[Line]) -> Iterator[str]:
    for line in lines:
        record, verdict = line.record, line.record["verdict"]
        if record["outcome"] == "refused" or (verdict is not None and not verdict["accepted"]):
            yield f"refused: {line}: {record['reason'] or (verdict or {}).get('reason')}"
            continue
        try:
            problem = _shortcoming(record)
        except SmashError as error:
            problem = str(error)
        if problem:
            yield f"refused now: {line}: {problem}"


def _shortcoming(record: dict[str, Any]) -> str:
    """Return what is wrong with a record's instance or plan; empty where nothing is.

    Raises:
        SmashError: where either is malformed.
    """
    instance = instance_from_document(record["instance_document"])
    if instance_hash(instance) != record["instance_hash"]:
        return "its instance does not fit its hash"
    plan = recorded_plan(record)
    if plan.actions is None:
        return ""
    verdict = check_plan(instance, plan)
    return "" if verdict.accepted else str(verdict)
