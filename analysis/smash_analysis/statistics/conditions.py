"""Under which conditions the records were made: machine, its load, code, and the runs that had to be stopped."""

from __future__ import annotations

from collections import Counter
from statistics import median
from typing import Any


def conditions(records: list[dict[str, Any]]) -> str:
    """Return the conditions as Markdown."""
    return "\n".join(["", "## Conditions", "", *(f"- {line}" for line in condition_lines(records))]) + "\n"


def condition_lines(records: list[dict[str, Any]]) -> list[str]:
    """Return the conditions, a sentence each; a machine that was busy with other work is said to have been."""
    lines = [f"{len(records)} runs; {_commits(records)}"]
    machines = Counter(_machine(record) for record in records)
    lines += [f"{count} runs on {machine}" for machine, count in machines.most_common()]
    loads = [record["load_average"][0] for record in records if record.get("load_average")]
    if loads:
        busy = sum(_busy(record) for record in records)
        lines.append(
            f"load average {median(loads):.1f} (median), {max(loads):.1f} (most); {busy} runs began while it was "
            "above the number of cores by 1 or more: their times are longer than on a quiet machine"
        )
    stopped = Counter(record["label"] for record in records if record["outcome"] == "over-budget")
    if stopped:
        words = ", ".join(f"{label} {count}" for label, count in stopped.most_common())
        lines.append(f"stopped beyond budget and grace (plans reported by then count): {words}")
    return lines


def _commits(records: list[dict[str, Any]]) -> str:
    commits: Counter[str] = Counter()
    for record in records:
        commit = record.get("commit") or {}
        changed = " with changed files" if commit.get("dirty") else ""
        commits[(commit.get("hash") or "unknown")[:10] + changed] += 1
    return "code at " + ", ".join(f"{name} ({count} runs)" for name, count in commits.most_common())


def _machine(record: dict[str, Any]) -> str:
    machine = record.get("machine") or {}
    memory = machine.get("memory_mib", 0) / 1024
    return f"{machine.get('processor', 'an unknown processor')}, {machine.get('cores', '?')} cores, {memory:.0f} GiB"


def _busy(record: dict[str, Any]) -> bool:
    load, cores = record.get("load_average"), (record.get("machine") or {}).get("cores")
    return bool(load and cores and load[0] >= cores + 1)
