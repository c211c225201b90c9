"""A data set read back: problems with their instances, plans and certificates."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import msgspec

from smash.experiments.dataset.entries import Entry
from smash.experiments.dataset.package import CERTIFICATES, COLUMNS, INSTANCES, PLANS, PROBLEMS, row_of
from smash.problem.buffers import with_buffers
from smash.problem.certificate import Certificate
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import convert, parse_json, read_bytes, read_text
from smash.problem.files.instances import instance_from_document
from smash.problem.files.plans import action_from_list
from smash.problem.model import Action, Instance
from smash.records.variants import variant_options

MOST_BUFFERS = 1000
"""Of a problem."""
DIGITS = 9
"""Of a number in the table."""


@dataclass(frozen=True, slots=True)
class Dataset:
    """Problems by name, and certificates by name (instance and variant)."""

    problems: dict[str, Entry]
    certificates: dict[str, Certificate]


def load_dataset(directory: str | os.PathLike[str]) -> Dataset:
    """Read a data set that `smash dataset` wrote; its files must agree with each other.

    Raises:
        MalformedFile: where a file is missing or malformed, or says other than the others, naming file and line.
    """
    home = Path(directory)
    instances = {
        name: instance_from_document(parse_json(line.document, where), where)
        for name, (where, line) in _by_name(home / INSTANCES, _InstanceLine).items()
    }
    plans = {
        name: (where, tuple(action_from_list(entry, where) for entry in _listed(line, where)))
        for name, (where, line) in _by_name(home / PLANS, _PlanLine).items()
    }
    proofs = {
        name: convert(parse_json(line.certificate, where), Certificate, where)
        for name, (where, line) in _by_name(home / CERTIFICATES, _CertificateLine).items()
    }
    problems: dict[str, Entry] = {}
    for where, entry in _entries(home / PROBLEMS, instances, plans):
        if entry.name in problems:
            raise MalformedFile(where, f"`problem`: {entry.name!r} stands twice")
        problems[entry.name] = entry
    for name, (where, _) in plans.items():
        if name not in problems:
            raise MalformedFile(where, f"`problem`: {name!r} is not in {PROBLEMS}")
    return Dataset(problems, proofs)


class _Line(msgspec.Struct, forbid_unknown_fields=True):
    """A line of a file, by the name that its first field holds."""


class _InstanceLine(_Line):
    name: str
    set: str
    document: str


class _PlanLine(_Line):
    problem: str
    actions: str


class _CertificateLine(_Line):
    name: str
    instance: str
    variant: str
    bound: int
    certificate: str


L = TypeVar("L", bound=_Line)


def _by_name(path: Path, kind: type[L]) -> dict[str, tuple[str, L]]:
    """Return the lines of a file by their names, each with where it stands."""
    found: dict[str, tuple[str, L]] = {}
    key = kind.__struct_fields__[0]
    for number, text in enumerate(read_bytes(path).splitlines(), start=1):
        where = f"{path}:{number}"
        line = convert(parse_json(text, where), kind, where)
        name = getattr(line, key)
        if name in found:
            raise MalformedFile(where, f"`{key}`: {name!r} stands twice")
        found[name] = where, line
    return found


def _listed(line: _PlanLine, where: str) -> list[list[str | int]]:
    found: list[list[str | int]] = convert(parse_json(line.actions, where), list[list[str | int]], where)
    return found


def _entries(
    path: Path, instances: dict[str, Instance], plans: dict[str, tuple[str, tuple[Action, ...]]]
) -> Iterator[tuple[str, Entry]]:
    for where, row in _rows(path):
        if row["instance"] not in instances:
            raise MalformedFile(where, f"`instance`: {row['instance']!r} is not in {INSTANCES}")
        options = variant_options(row["variant"])
        if options is None:
            raise MalformedFile(where, f"`variant`: {row['variant']!r} is none")
        cost, bound, buffers = (_number(row[name], name, where) for name in ("cost", "lower_bound", "buffers"))
        if buffers is None or buffers > MOST_BUFFERS:
            raise MalformedFile(where, f"`buffers`: {row['buffers']!r} is not allowed; 0 to {MOST_BUFFERS}")
        try:
            instance = with_buffers(instances[row["instance"]], buffers)
        except MalformedFile as error:
            raise MalformedFile(where, f"`buffers`: {error}") from None
        _, actions = plans.get(row["problem"], ("", None))
        if (actions is None) != (cost is None):
            missing = f"no plan in {PLANS}" if actions is None else "a plan, but no cost"
            raise MalformedFile(where, f"`problem`: {row['problem']!r} has {missing}")
        origin = row["bound_origin"] or None
        entry = Entry(row["set"], instance, options, cost, bound, origin, actions, row["found_by"])
        for column, cell in row_of(entry, row["certificate"]).items():
            meant = "" if cell is None else str(cell)
            if row[column] != meant:
                raise MalformedFile(where, f"`{column}`: {row[column]!r}, where the rest says {meant!r}")
        yield where, entry


def _rows(path: Path) -> Iterator[tuple[str, dict[str, str]]]:
    """Yield the rows of the table of problems, each with where it stands."""
    table = csv.DictReader(io.StringIO(read_text(path), newline=""))
    try:
        for row in table:
            where = f"{path}:{table.line_num}"
            if set(row) != set(COLUMNS) or None in row.values():
                raise MalformedFile(where, f"no row with the columns {', '.join(COLUMNS)}")
            yield where, row
    except csv.Error as error:
        raise MalformedFile(f"{path}:{table.reader.line_num}", f"no row of a table: {error}") from None


def _number(text: str, column: str, where: str) -> int | None:
    if not text:
        return None
    if not text.isdecimal() or len(text) > DIGITS:
        raise MalformedFile(where, f"`{column}`: {text[:40]!r} is not allowed; a number of at most {DIGITS} digits is")
    return int(text)
