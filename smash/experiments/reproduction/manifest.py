"""The manifest of a reproduction: what was run, what was not and why, how long it took, where, and what came out."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from smash.experiments.environment import machine
from smash.experiments.reproduction.reproduce import Planned, Reproduction
from smash.experiments.sweeps.display import span
from smash.problem.files.documents import write_text

MANIFEST_FORMAT = "smash-manifest/1"

T = TypeVar("T")


def manifest(reproduction: Reproduction, planned: Sequence[Planned]) -> dict[str, Any]:
    """Return the `smash-manifest/1` object of a reproduction as it stands."""
    records = [entry.record for entry in planned if entry.record is not None]
    document: dict[str, Any] = msgspec.to_builtins(
        {
            "format": MANIFEST_FORMAT,
            "name": reproduction.stages.name,
            "about": reproduction.stages.about,
            "started": min((record.started for record in records), default=None),
            "ended": max((record.ended for record in records if record.ended), default=None),
            "seconds": round(sum(record.seconds for record in records), 1),
            "whole": all(entry.plan in ("done", "kept") for entry in planned),
            "commits": _distinct(record.commit for record in records),
            "versions": _distinct(record.made_from.packages for record in records),
            "machine": machine(),
            "steps": [_stage(entry) for entry in planned],
        }
    )
    return document


def _distinct(values: Iterable[T]) -> list[T]:
    found: list[T] = []
    for value in values:
        if value not in found:
            found.append(value)
    return found


def _stage(entry: Planned) -> dict[str, Any]:
    stage, record = entry.stage, entry.record
    document: dict[str, Any] = {
        "name": stage.name,
        "about": stage.about,
        "state": _state(entry),
        "why": entry.why,
        "leaves_out": stage.leaves_out,
        "commands": stage.commands,
        "estimated_minutes": stage.minutes,
    }
    if record is None:
        return document
    made_from = record.made_from
    return document | {
        "started": record.started,
        "ended": record.ended,
        "seconds": round(record.seconds, 1),
        "starts": record.starts,
        "load_average": {"before": record.load.before, "mean": record.load.mean, "most": record.load.most},
        "commit": record.commit,
        "code": made_from.code,
        "inputs": made_from.inputs,
        "products": {name: msgspec.structs.asdict(product) for name, product in record.products.items()},
    }


def _state(entry: Planned) -> str:
    if entry.plan in ("done", "kept"):
        return "run"
    return "failed" if entry.record is not None and entry.record.state == "failed" else "not run"


def write_manifest(reproduction: Reproduction, planned: Sequence[Planned]) -> list[Path]:
    """Write `manifest.json` and `MANIFEST.md` into the reproduction's directory; return both."""
    document = manifest(reproduction, planned)
    files = [reproduction.out / "manifest.json", reproduction.out / "MANIFEST.md"]
    write_text(files[0], msgspec.json.format(msgspec.json.encode(document), indent=1).decode() + "\n")
    write_text(files[1], manifest_page(document))
    return files


def manifest_page(document: dict[str, Any]) -> str:
    """Return the manifest as Markdown, to be read by people."""
    host, stages = document["machine"], document["steps"]
    run = [stage for stage in stages if stage["state"] == "run"]
    lines = [
        f"# {document['name']}",
        "",
        document["about"],
        "",
        f"- {len(run)} of {len(stages)} stages run, {span(document['seconds'])} in all, "
        f"from {document['started'] or '–'} to {document['ended'] or '–'}",
        f"- code: {'; '.join(_commit(found) for found in document['commits']) or '–'}",
        f"- machine: {host['processor']}, {host['usable_cores']} of {host['cores']} cores, "
        f"{host['memory_mib'] / 1024:.0f} GiB, {host['system']}",
        *(f"- versions: {_versions(found)}" for found in document["versions"]),
        "",
        "| stage | what | state | estimated | took | load average: mean, most |",
        "|---|---|---|---|---|---|",
    ]
    for stage in stages:
        took, of = span(stage["seconds"]) if "seconds" in stage else "–", stage.get("load_average")
        busy = f"{of['mean']:.1f}, {of['most']:.1f}" if of else "–"
        estimated = span(60 * stage["estimated_minutes"])
        lines.append(f"| {stage['name']} | {stage['about']} | {stage['state']} | {estimated} | {took} | {busy} |")
    return "\n".join([*lines, "", *_left_out(stages), *_made(stages)]) + "\n"


def _left_out(stages: Sequence[dict[str, Any]]) -> list[str]:
    lines = ["## What was not run, and why", ""]
    lines += [f"- **{stage['name']}**: {stage['state']}: {stage['why']}" for stage in stages if stage["state"] != "run"]
    lines += [f"- {stage['name']}: {stage['leaves_out']}" for stage in stages if stage["leaves_out"]]
    lines += [f"- {stage['name']} was kept, although {stage['why']}" for stage in stages if _kept(stage)]
    return [*(lines if len(lines) > 2 else [*lines, "Everything was."]), ""]


def _kept(stage: dict[str, Any]) -> bool:
    return stage["state"] == "run" and bool(stage["why"])


def _made(stages: Sequence[dict[str, Any]]) -> list[str]:
    lines = ["## Commands and products", ""]
    for stage in stages:
        lines += [f"### {stage['name']}", "", "```sh", *stage["commands"], "```", ""]
        if "started" in stage:
            again = f", in {stage['starts']} starts" if stage["starts"] > 1 else ""
            lines += [f"Begun {stage['started']}{again}; code: {_commit(stage['commit'])}.", ""]
        products = stage.get("products")
        if products:
            lines += ["| product | bytes | SHA-256 |", "|---|---|---|"]
            lines += [f"| {name} | {made['bytes']} | `{made['sha256']}` |" for name, made in products.items()]
            lines.append("")
    return lines


def _versions(found: dict[str, str]) -> str:
    return ", ".join(f"{name} {number}" for name, number in sorted(found.items()))


def _commit(found: dict[str, Any]) -> str:
    if found["hash"] is None:
        return "of no commit that is known"
    return f"commit {found['hash'][:12]}{', with changes that no commit holds' if found['dirty'] else ''}"
