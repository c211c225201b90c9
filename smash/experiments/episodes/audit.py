"""The audit of a directory's episodes: every one that was asked for, once, explained, and of a plan that is there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from smash.experiments.episodes.asked import asked_runs
from smash.experiments.sweeps.audit import Check, sound, told, whole_lines
from smash.problem.errors import MalformedFile
from smash.records.episodes import EpisodeRecord
from smash.records.files import EPISODES, RUNS
from smash.records.reading import Line, read


def audit_episodes(results: Path) -> list[Check]:
    """Return what was asked of `results/episodes.jsonl`, and the answers; nothing where there are no episodes.

    Raises:
        MalformedFile: where a file cannot be read.
    """
    if not EPISODES.path(results).is_file():
        return []
    reading = read(results, EPISODES)
    lines, whole = reading.lines, whole_lines(reading, results, EPISODES)
    checks = [whole, *_complete(lines, results), _plans_there(lines, results), *sound(lines), _outcomes(lines)]
    return [
        Check(f"episodes: {check.question}", check.answer, [f"episodes: {finding}" for finding in check.findings])
        for check in checks
    ]


def _complete(lines: Sequence[Line[EpisodeRecord]], results: Path) -> Iterator[Check]:
    try:
        planned = asked_runs(results)
    except MalformedFile as error:
        yield Check("complete", f"not known: {error}")  # damaged runs, which have a finding of their own
        return
    if planned is None:
        yield Check("complete", "not known: what was asked for is not recorded there")
        return
    there = {line.record.key for line in lines}
    missing = Counter(f"{run.record.label}, {run.policy}" for run in planned if run.key not in there)
    of = Counter(f"{run.record.label}, {run.policy}" for run in planned)
    words = [f"missing: {setting}: {count} of {of[setting]}" for setting, count in missing.items()]
    meant = {run.key for run in planned}
    yield Check("complete", f"{len(meant & there)} of {len(meant)} that were asked for", words)
    strangers = [f"not asked for: {told(line)}" for line in lines if line.record.key not in meant]
    yield Check("nothing but what was asked for", f"other episodes: {len(strangers)}", strangers)


def _plans_there(lines: Sequence[Line[EpisodeRecord]], results: Path) -> Check:
    """Each episode's plan must be that of a run recorded there: same key, same cost."""
    try:
        costs = {run.key: run.cost for run in read(results, RUNS).records}
    except MalformedFile as error:
        return Check("each plan is recorded there", f"not known: {error}")
    words = []
    for line in lines:
        run, cost = line.record.run, line.record.cost
        if run not in costs:
            words.append(f"no plan: {told(line)}: its run {run} is not recorded there")
        elif costs[run] != cost:
            words.append(f"another plan: {told(line)}: it cost {cost}, the recorded one costs {costs[run]}")
    return Check("each plan is recorded there", f"{len({line.record.run for line in lines})} plans", words)


def _outcomes(lines: Sequence[Line[EpisodeRecord]]) -> Check:
    ends: Counter[str] = Counter()
    words = []
    for line in lines:
        episode = line.record.episode
        if episode is None:
            ends["no end"] += 1
            if not line.record.problem.strip():
                words.append(f"unexplained: {told(line)}: no end, without a reason")
            continue
        failure = episode.failure
        ends["success" if episode.success else "failure" if failure is None else failure.name] += 1
        if episode.success == (failure is not None):
            words.append(f"unexplained: {told(line)}: {'a success with' if failure else 'a failure without'} a reason")
        elif failure is not None and not failure.reason.strip():
            words.append(f"unexplained: {told(line)}: {failure.name} without a reason")
    return Check("every outcome explained", ", ".join(f"{n} {end}" for end, n in ends.most_common()) or "none", words)
