"""Instance files: `smash-instance/1` and `/2`.

Version 2 adds `carriers`, `capacities`, `costs`, `hand`, and `ontable` and `clear` of an `on` goal. What version 1 can
say is written in version 1.

Reading is strict: unknown keys, unknown names, a block twice or nowhere, a height that floats are refused
by a `MalformedFile` whose one line says where and what is allowed.
"""

from __future__ import annotations

import os
from typing import Any, Literal, cast

import msgspec

from smash.problem import arguments
from smash.problem.costs import UNIT_COSTS, Costs
from smash.problem.errors import MalformedFile
from smash.problem.files.checking import checked
from smash.problem.files.documents import check_format, convert, one_key_a_line, parse_json, read_bytes, write_text
from smash.problem.model import Carrier, Goal, Instance, OnGoal, PositionsGoal, StacksGoal, no_goal

INSTANCE_FORMAT = "smash-instance/1"
INSTANCE_FORMAT_2 = "smash-instance/2"
GOAL_KEYS = {
    "stacks": ("kind", "stacks"),
    "positions": ("kind", "positions"),
    "on": ("kind", "on", "bottom"),
}
"""Goal kind -> the keys of its object."""
GOAL_KEYS_2 = {**GOAL_KEYS, "on": (*GOAL_KEYS["on"], "ontable", "clear")}
"""The same for version 2."""


class _StacksGoalFile(msgspec.Struct, forbid_unknown_fields=True, tag_field="kind", tag="stacks"):
    stacks: dict[str, list[str]]


class _PositionsGoalFile(msgspec.Struct, forbid_unknown_fields=True, tag_field="kind", tag="positions"):
    positions: dict[str, tuple[str, int]]


class _OnGoalFile(msgspec.Struct, forbid_unknown_fields=True, tag_field="kind", tag="on"):
    on: dict[str, str]
    bottom: list[str] = []


class _OnGoalFile2(_OnGoalFile, tag="on"):
    ontable: list[str] = []
    clear: list[str] = []


class _InstanceFile(msgspec.Struct, forbid_unknown_fields=True):
    format: Literal["smash-instance/1"]
    name: str
    blocks: list[str]
    stacks: list[str]
    start: dict[str, list[str]]
    goal: _StacksGoalFile | _PositionsGoalFile | _OnGoalFile
    buffers: list[str] = []
    table: list[str] = []


class _CarrierFile(msgspec.Struct, forbid_unknown_fields=True):
    name: str
    stations: list[str]
    at: str
    capacity: int
    holds: list[str] = []


class _CostsFile(msgspec.Struct, forbid_unknown_fields=True):
    actions: dict[str, int] = {}
    travel: float = 0.0
    positions: dict[str, tuple[float, float]] = {}
    unit: str = "actions"


class _InstanceFile2(_InstanceFile):
    format: Literal["smash-instance/2"]  # type: ignore[assignment]
    goal: _StacksGoalFile | _PositionsGoalFile | _OnGoalFile2
    hand: str | None = None
    carriers: list[_CarrierFile] = []
    capacities: dict[str, int] = {}
    costs: _CostsFile = msgspec.field(default_factory=_CostsFile)


def read_instance(path: str | os.PathLike[str]) -> Instance:
    """Read and check an instance file, version 1 or 2.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = arguments.path(path)
    return instance_from_document(parse_json(read_bytes(path, "instance files"), where), where)


def instance_from_document(document: Any, where: str = "instance") -> Instance:
    """Check a parsed instance document and build the instance.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    check_format(document, where, INSTANCE_FORMAT, INSTANCE_FORMAT_2)
    second = document["format"] == INSTANCE_FORMAT_2
    _check_goal_keys(document.get("goal"), where, second=second)
    file = cast(_InstanceFile, convert(document, _InstanceFile2 if second else _InstanceFile, where))
    match file.goal:
        case _StacksGoalFile(stacks=stacks):
            goal: Goal = StacksGoal({location: tuple(pile) for location, pile in stacks.items()})
        case _PositionsGoalFile(positions=positions):
            goal = PositionsGoal(dict(positions))
        case _OnGoalFile2(on=on, bottom=bottom, ontable=ontable, clear=clear):
            goal = OnGoal(dict(on), tuple(bottom), tuple(ontable), tuple(clear))
        case _OnGoalFile(on=on, bottom=bottom):
            goal = OnGoal(dict(on), tuple(bottom))
    instance = Instance(
        name=file.name,
        blocks=tuple(file.blocks),
        stacks=tuple(file.stacks),
        buffers=tuple(file.buffers),
        start={location: tuple(pile) for location, pile in file.start.items()},
        goal=goal,
        table=tuple(file.table),
        **(_additions(file) if isinstance(file, _InstanceFile2) else {}),
    )
    return checked(instance, where)


def _additions(file: _InstanceFile2) -> dict[str, Any]:
    """Return the fields of an instance that version 2 adds."""
    costs = file.costs
    return {
        "carriers": tuple(Carrier(c.name, tuple(c.stations), c.at, c.capacity, tuple(c.holds)) for c in file.carriers),
        "capacities": file.capacities,
        "costs": Costs(costs.actions, costs.travel, costs.positions, costs.unit),
        "hand": file.hand,
    }


def _check_goal_keys(goal: Any, where: str, *, second: bool) -> None:
    """Refuse an unknown goal kind or key, naming the allowed ones (msgspec names none)."""
    if not isinstance(goal, dict):
        return
    kind, known = goal.get("kind"), GOAL_KEYS_2 if second else GOAL_KEYS
    if not isinstance(kind, str) or kind not in known:
        raise MalformedFile(where, f"`goal.kind`: {kind!r} is not allowed; one of {', '.join(known)}")
    for key in goal:
        if key in known[kind]:
            continue
        later = f"; {key!r} needs {INSTANCE_FORMAT_2!r}" if key in GOAL_KEYS_2[kind] else ""
        raise MalformedFile(where, f"`goal`: unknown key {key!r}; allowed: {', '.join(known[kind])}{later}")


def instance_document(instance: Instance) -> dict[str, Any]:
    """Return the document of an instance; empty locations are left out of `start`."""
    match instance.goal:
        case StacksGoal(stacks):
            goal: dict[str, Any] = {"kind": "stacks", "stacks": {k: list(v) for k, v in stacks.items() if v}}
        case PositionsGoal(positions):
            goal = {"kind": "positions", "positions": {k: list(v) for k, v in positions.items()}}
        case OnGoal(on, bottom, ontable, clear):
            goal = {"kind": "on", "on": dict(on), "bottom": list(bottom)}
            goal |= {key: list(blocks) for key, blocks in (("ontable", ontable), ("clear", clear)) if blocks}
        case _:
            no_goal(instance.goal)
    document: dict[str, Any] = {
        "format": INSTANCE_FORMAT,
        "name": instance.name,
        "blocks": list(instance.blocks),
        "stacks": list(instance.stacks),
        "buffers": list(instance.buffers),
        "start": {k: list(v) for k, v in instance.start.items() if v},
        "goal": goal,
    }
    if instance.table:
        document["table"] = list(instance.table)
    additions = _addition_documents(instance)
    second = additions or not goal.keys() <= set(GOAL_KEYS[goal["kind"]])
    return document | {"format": INSTANCE_FORMAT_2} | additions if second else document


def _addition_documents(instance: Instance) -> dict[str, Any]:
    additions: dict[str, Any] = {}
    if instance.hand is not None:
        additions["hand"] = instance.hand
    if instance.carriers:
        additions["carriers"] = [msgspec.to_builtins(carrier) for carrier in instance.carriers]
    if instance.capacities:
        additions["capacities"] = dict(instance.capacities)
    if instance.costs != UNIT_COSTS:
        additions["costs"] = msgspec.to_builtins(instance.costs)
    return additions


def write_instance(instance: Instance, path: str | os.PathLike[str]) -> None:
    """Write an instance file, byte for byte the same for equal instances."""
    write_text(path, one_key_a_line(instance_document(instance)))
