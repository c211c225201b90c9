"""A data set read back: problems with their instances, plans and certificates."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smash.experiments.best_known.standing import options_of
from smash.experiments.dataset.croissant import FIELDS
from smash.experiments.dataset.entries import Entry
from smash.experiments.dataset.package import CERTIFICATES, COLUMNS, INSTANCES, PLANS, PROBLEMS
from smash.problem.buffers import with_buffers
from smash.problem.certificate import Certificate
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import convert, parse_json, read_bytes
from smash.problem.files.instances import instance_from_document
from smash.problem.files.plans import action_from_list
from smash.problem.model import Instance


@dataclass(frozen=True, slots=True)
class Dataset:
    """Problems by name, and certificates by name (instance and variant)."""

    problems: dict[str, Entry]
    certificates: dict[str, Certificate]


def load_dataset(directory: str | os.PathLike[str]) -> Dataset:
    """Read a data set that `smash dataset` wrote.

    Raises:
        MalformedFile: where a file is missing or malformed, naming file and line.
    """
    home = Path(directory)
    instances = {}
    for where, line in _lines(home / INSTANCES):
        instances[line["name"]] = instance_from_document(parse_json(line["document"], where), where)
    plans = {line["problem"]: (where, parse_json(line["actions"], where)) for where, line in _lines(home / PLANS)}
    proofs = {
        line["name"]: convert(parse_json(line["certificate"], where), Certificate, where)
        for where, line in _lines(home / CERTIFICATES)
    }
    return Dataset(dict(_entries(home / PROBLEMS, instances, plans)), proofs)


def _lines(path: Path) -> Iterator[tuple[str, dict[str, Any]]]:
    for number, line in enumerate(read_bytes(path).splitlines(), start=1):
        where = f"{path}:{number}"
        document = parse_json(line, where)
        if not isinstance(document, dict) or set(document) != set(FIELDS[path.name]):
            raise MalformedFile(where, f"no object with the keys {', '.join(FIELDS[path.name])}")
        yield where, document


def _entries(
    path: Path, instances: dict[str, Instance], plans: dict[str, tuple[str, list[Any]]]
) -> Iterator[tuple[str, Entry]]:
    table = csv.DictReader(io.StringIO(read_bytes(path).decode("utf-8", errors="replace")))
    for number, row in enumerate(table, start=2):
        where = f"{path}:{number}"
        if set(row) != set(COLUMNS) or row["instance"] not in instances:
            raise MalformedFile(where, f"no row of {PROBLEMS}, or its instance is not in {INSTANCES}")
        cost, bound, buffers = (_number(row[name], where) for name in ("cost", "lower_bound", "buffers"))
        named, listed = plans.get(row["problem"], ("", None))
        actions = None if listed is None else tuple(action_from_list(action, named) for action in listed)
        instance = with_buffers(instances[row["instance"]], buffers or 0)
        options = options_of(row["variant"])
        origin = row["bound_origin"] or None
        entry = Entry(row["set"], instance, options, cost, bound, origin, actions, row["found_by"])
        yield entry.name, entry


def _number(text: str, where: str) -> int | None:
    if not text:
        return None
    if not text.isdecimal():
        raise MalformedFile(where, f"{text!r} is no number")
    return int(text)
