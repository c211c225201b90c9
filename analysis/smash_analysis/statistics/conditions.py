"""Under which conditions the records were made: machine, its load, code, and the runs that had to be stopped."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from statistics import median

from smash.records.episodes import EpisodeRecord
from smash.records.record import Machine
from smash.records.runs import RunRecord


def conditions(records: Sequence[RunRecord]) -> str:
    """Return the conditions as Markdown."""
    return "\n".join(["", "## Conditions", "", *(f"- {line}" for line in condition_lines(records, "runs"))]) + "\n"


def condition_lines(records: Sequence[RunRecord] | Sequence[EpisodeRecord], what: str) -> list[str]:
    """Return the conditions, a sentence each; a machine that was busy with other work is said to have been.

    Args:
        records: runs or episodes.
        what: what they are called.
    """
    lines = [f"{len(records)} {what}; {_commits(records, what)}"]
    machines = Counter(_machine(record.machine) for record in records)
    lines += [f"{count} {what} on {machine}" for machine, count in machines.most_common()]
    loads = [record.load_average[0] for record in records]
    if loads:
        busy = sum(_busy(record) for record in records)
        lines.append(
            f"load average {median(loads):.1f} (median), {max(loads):.1f} (most); {busy} {what} began while it was "
            "above the number of cores by 1 or more: their times are longer than on a quiet machine"
        )
    runs = [record for record in records if isinstance(record, RunRecord)]
    stopped = Counter(run.label for run in runs if run.outcome == "over-budget")
    if stopped:
        words = ", ".join(f"{label} {count}" for label, count in stopped.most_common())
        lines.append(f"stopped beyond budget and grace (plans reported by then count): {words}")
    return lines


def _commits(records: Sequence[RunRecord] | Sequence[EpisodeRecord], what: str) -> str:
    commits: Counter[str] = Counter()
    for record in records:
        changed = " with changed files" if record.commit.dirty else ""
        commits[(record.commit.hash or "unknown")[:10] + changed] += 1
    return "code at " + ", ".join(f"{name} ({count} {what})" for name, count in commits.most_common())


def _machine(machine: Machine) -> str:
    cores = "?" if machine.cores is None else machine.cores
    return f"{machine.processor}, {cores} cores, {machine.memory_mib / 1024:.0f} GiB"


def _busy(record: RunRecord | EpisodeRecord) -> bool:
    cores = record.machine.cores
    return cores is not None and record.load_average[0] >= cores + 1
