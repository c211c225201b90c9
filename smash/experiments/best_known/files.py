"""The list of best known costs as files: `best-known.csv`, and each plan as a `smash-plan/1` file beside it."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import msgspec

from smash.experiments.best_known.standing import PLANS, BestKnown, Entry, Found, open_instances, options_of
from smash.problem.errors import MalformedFile, SmashError
from smash.problem.files.data import data_folder, shipped
from smash.problem.files.documents import read_bytes, write_text
from smash.problem.files.instances import instance_document
from smash.problem.files.plans import plan_text
from smash.problem.files.typed import typed
from smash.problem.model import Action, Instance
from smash.problem.plan import Incumbent, Plan

LIST = data_folder(__file__, "list", in_tree="results/best-known")
"""The list of this repository, or the one that was installed with the package: that one is only read."""
FILE = "best-known.csv"
FOUND_COLUMNS = tuple(column.name for column in msgspec.structs.fields(Found))
COLUMNS = (
    *("instance", "blocks", "stacks", "buffers", "goal", "variant", "cost", "lower_bound", "gap", "proven", "plan"),
    *(f"found_{column}" for column in FOUND_COLUMNS),
    *(f"bound_{column}" for column in FOUND_COLUMNS),
)


class Contradiction(SmashError):
    """A legal plan below a lower bound."""

    def __init__(self, entry: Entry) -> None:
        assert entry.found is not None
        assert entry.bound is not None
        super().__init__(
            f"{entry.instance} {entry.variant}: {entry.found.by} has a legal plan of {entry.cost} actions, "
            f"{entry.bound.by} ({entry.bound.origin}) proves at least {entry.lower_bound}: one of both is wrong"
        )


def list_to_write(directory: Path | None) -> Path:
    """Return the list to be changed: `directory`, or that of the repository.

    Raises:
        MalformedFile: where neither is there, but only the list that was installed.
    """
    if directory is None and shipped(__file__, "list") == LIST:
        raise MalformedFile(str(LIST), "came with the package and is not changed: --list DIR names one of your own")
    return directory or LIST


def write_best_known(known: BestKnown) -> None:
    """Write a list and every plan of it.

    Raises:
        Contradiction: where a plan is cheaper than a lower bound on it; nothing is written then.
    """
    for entry in known.entries.values():
        if entry.cost is not None and entry.cost < (entry.lower_bound or 0):
            raise Contradiction(entry)
    plans = [(entry, known.actions(entry)) for entry in known.sorted() if entry.cost is not None]
    (known.directory / PLANS).mkdir(parents=True, exist_ok=True)
    for entry, actions in plans:
        write_text(known.directory / entry.plan_file, plan_text(_filed(entry, actions)))
    write_text(known.directory / FILE, csv_text(known.sorted()))


def read_best_known(directory: Path) -> BestKnown:
    """Read a list.

    Raises:
        MalformedFile: where it is missing or a line is malformed.
    """
    path = directory / FILE
    if not path.is_file():
        raise MalformedFile(str(directory), f"no {FILE} there; without --list it is {LIST}")
    known = BestKnown(directory)
    rows = csv.DictReader(io.StringIO(read_bytes(path).decode("utf-8", errors="replace")))
    try:
        for number, row in enumerate(rows, start=2):
            entry = _entry(row, f"{path}:{number}")
            known.entries[entry.instance, entry.variant] = entry
    except csv.Error as error:
        raise MalformedFile(str(path), f"no table: {error}") from None
    return known


def csv_text(entries: list[Entry]) -> str:
    """Return `best-known.csv`: one row an instance and variant."""
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for entry in entries:
        instance = open_instances()[entry.instance]
        writer.writerow(
            {
                "instance": entry.instance,
                "blocks": len(instance.blocks),
                "stacks": len(instance.stacks),
                "buffers": len(instance.buffers),
                "goal": goal_kind(instance),
                "variant": entry.variant,
                "cost": entry.cost,
                "lower_bound": entry.lower_bound,
                "gap": entry.gap,
                "proven": "yes" if entry.proven else "no",
                "plan": entry.plan_file,
                **dict(_found_cells("found", entry.found)),
                **dict(_found_cells("bound", entry.bound)),
            }
        )
    return text.getvalue()


def goal_kind(instance: Instance) -> str:
    """Return `stacks`, `positions` or `on`."""
    return str(instance_document(instance)["goal"]["kind"])


def _found_cells(prefix: str, found: Found | None) -> Iterator[tuple[str, object]]:
    for column in FOUND_COLUMNS:
        yield f"{prefix}_{column}", None if found is None else getattr(found, column)


def _entry(row: dict[str, str], where: str) -> Entry:
    if set(row) != set(COLUMNS) or None in row.values() or row["instance"] not in open_instances():
        raise MalformedFile(where, "no row of a list of best known plans of the open instances")
    options_of(row["variant"])
    found = {name: _found(row, name, where) for name in ("found", "bound")}
    plain = {name: row[name] or None for name in ("cost", "lower_bound")}
    document = {"instance": row["instance"], "variant": row["variant"], **plain, **found}
    return cast(Entry, _converted(document, Entry, where))


def _found(row: dict[str, str], prefix: str, where: str) -> Found | None:
    if not row[f"{prefix}_by"]:
        return None
    cells = {column: row[f"{prefix}_{column}"] for column in FOUND_COLUMNS}
    return cast(Found, _converted({**cells, "seconds": cells["seconds"] or None}, Found, where))


def _converted(document: dict[str, Any], kind: Any, where: str) -> Any:
    try:
        return typed(document, kind, strict=False)
    except msgspec.ValidationError as error:
        raise MalformedFile(where, str(error)) from None


def _filed(entry: Entry, actions: tuple[Action, ...]) -> Plan:
    assert entry.found is not None
    return Plan(
        instance=entry.instance,
        planner=entry.found.by,
        options=options_of(entry.variant),
        status="optimal" if entry.proven else "feasible",
        actions=actions,
        lower_bound=entry.lower_bound,
        bound_origin=entry.bound.origin if entry.bound is not None else None,
        incumbents=(Incumbent(entry.found.seconds or 0.0, len(actions), entry.found.origin),),
    )
