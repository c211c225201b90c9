"""A data set as files: problems as a table, instances, plans and certificates a line each, metadata, a datasheet."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterable
from datetime import date
from pathlib import Path
from typing import Any

import msgspec

from smash.experiments.dataset.croissant import metadata
from smash.experiments.dataset.datasheet import datasheet
from smash.experiments.dataset.entries import Entry, certificate_of
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import write_text
from smash.problem.files.instances import instance_document
from smash.problem.files.plans import action_list

PROBLEMS, INSTANCES, PLANS, CERTIFICATES = "problems.csv", "instances.jsonl", "plans.jsonl", "certificates.jsonl"
METADATA, DATASHEET = "croissant.json", "DATASHEET.md"
COLUMNS = (
    *("problem", "set", "instance", "blocks", "stacks", "buffers", "goal", "variant"),
    *("status", "cost", "lower_bound", "bound_origin", "found_by", "certificate"),
)


def write_dataset(entries: Iterable[Entry], out: Path, said: Callable[[str], None] = lambda _: None) -> list[Path]:
    """Write a data set; return its files.

    Args:
        entries: its problems.
        out: directory, made where it is missing.
        said: hears how far it is.

    Raises:
        MalformedFile: where a file cannot be written.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MalformedFile(str(out), f"cannot be made: {error.strerror}") from None
    rows: list[dict[str, Any]] = []
    instances: dict[str, str] = {}
    plans: list[str] = []
    proofs: dict[str, str] = {}
    for entry in entries:
        named = f"{entry.instance.name}/{entry.variant}"
        if named not in proofs or f'"bound":{entry.cost},' not in proofs[named]:
            certificate = certificate_of(entry)
            if certificate is not None:
                proofs[named] = _line(
                    name=named,
                    instance=entry.instance.name,
                    variant=entry.variant,
                    bound=certificate.bound,
                    certificate=_json(msgspec.to_builtins(certificate)),
                )
        proven = named in proofs and f'"bound":{entry.cost},' in proofs[named]
        rows.append(row_of(entry, named if proven else ""))
        name, document = entry.instance.name, _json(instance_document(entry.instance))
        instances[name] = max(
            instances.get(name, ""), _line(name=name, set=entry.set, document=document), key=len
        )  # with the most buffers
        if entry.actions is not None:
            actions = _json([action_list(action) for action in entry.actions])
            plans.append(_line(problem=entry.name, actions=actions))
        if len(rows) % 200 == 0:
            said(f"{len(rows)} problems")
    texts = {
        PROBLEMS: _table(rows),
        INSTANCES: "".join(instances.values()),
        PLANS: "".join(plans),
        CERTIFICATES: "".join(proofs.values()),
        DATASHEET: datasheet(rows),
    }
    for name, text in texts.items():
        write_text(out / name, text)
    described = metadata({name: texts[name] for name in (PROBLEMS, INSTANCES, PLANS, CERTIFICATES)}, date.today())
    write_text(out / METADATA, json.dumps(described, indent=1, ensure_ascii=False) + "\n")
    return [out / name for name in (*texts, METADATA)]


def _line(**document: Any) -> str:
    return _json(document) + "\n"


def _json(document: Any) -> str:
    return json.dumps(document, ensure_ascii=False, separators=(",", ":"))


def row_of(entry: Entry, certificate: str) -> dict[str, Any]:
    """Return the row of a problem in the table, by column, with the name of its certificate."""
    cells = (
        *(entry.name, entry.set, entry.instance.name, len(entry.instance.blocks), len(entry.instance.stacks)),
        *(len(entry.instance.buffers), entry.goal, entry.variant),
        *(entry.status, entry.cost, entry.lower_bound, entry.bound_origin, entry.found_by, certificate),
    )
    return dict(zip(COLUMNS, cells, strict=True))


def _table(rows: list[dict[str, Any]]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
