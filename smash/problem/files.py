"""JSON files in and out: `smash-instance/1` and `/2`, `smash-plan/1` and `/2`.

Version 2 of an instance adds `carriers`, `capacities` and `costs`; version 2 of a plan adds `without`, further
aggregating actions and a cost that is not the plan's length. What version 1 can say is written in version 1.

Reading is strict: unknown keys, unknown names, a block twice or nowhere, a height that floats are refused
by a `MalformedFile` whose one line says where and what is allowed.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, cast

import msgspec

from smash.problem.checking import InstanceChecker
from smash.problem.costs import UNIT_COSTS, Costs
from smash.problem.errors import MalformedFile
from smash.problem.family import FAMILY, kind_of
from smash.problem.model import (
    Action,
    Aggregating,
    Carrier,
    Goal,
    Instance,
    OnGoal,
    Pick,
    Place,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
)
from smash.problem.plan import STATUSES, Incumbent, Plan, Status

INSTANCE_FORMAT = "smash-instance/1"
INSTANCE_FORMAT_2 = "smash-instance/2"
PLAN_FORMAT = "smash-plan/1"
PLAN_FORMAT_2 = "smash-plan/2"
GOAL_KEYS = {
    "stacks": ("kind", "stacks"),
    "positions": ("kind", "positions"),
    "on": ("kind", "on", "bottom"),
}
"""Goal kind -> the keys of its object."""


class _StacksGoalFile(msgspec.Struct, forbid_unknown_fields=True, tag_field="kind", tag="stacks"):
    stacks: dict[str, list[str]]


class _PositionsGoalFile(msgspec.Struct, forbid_unknown_fields=True, tag_field="kind", tag="positions"):
    positions: dict[str, tuple[str, int]]


class _OnGoalFile(msgspec.Struct, forbid_unknown_fields=True, tag_field="kind", tag="on"):
    on: dict[str, str]
    bottom: list[str] = []


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
    carriers: list[_CarrierFile] = []
    capacities: dict[str, int] = {}
    costs: _CostsFile = msgspec.field(default_factory=_CostsFile)


class _PlanFile(msgspec.Struct, forbid_unknown_fields=True):
    format: Literal["smash-plan/1"]
    instance: str
    actions: list[list[str | int]] | None
    cost: int | None
    planner: str = ""
    topple: bool = True
    max_topple: int | None = None
    status: str = "feasible"
    lower_bound: int | None = None
    bound_origin: str | None = None
    incumbents: list[tuple[float, int, str]] = []


class _PlanFile2(_PlanFile):
    format: Literal["smash-plan/2"]  # type: ignore[assignment]
    without: list[str] = []


def parse_json(text: str | bytes, where: str) -> Any:
    """Parse one JSON document; a key that stands twice in one object is refused.

    Raises:
        MalformedFile: where the text is no JSON.
    """

    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        seen: dict[str, Any] = {}
        for key, value in pairs:
            if key in seen:
                raise MalformedFile(where, f"the key {key!r} stands twice in one object")
            seen[key] = value
        return seen

    try:
        return json.loads(text, object_pairs_hook=unique)
    except UnicodeDecodeError:
        raise MalformedFile(where, "not UTF-8 text") from None
    except RecursionError:
        raise MalformedFile(where, "JSON nested too deeply") from None
    except ValueError as error:
        raise MalformedFile(where, f"not JSON: {error}") from None


def parse_toml(content: bytes, where: str) -> dict[str, Any]:
    """Parse one TOML document.

    Raises:
        MalformedFile: where the content is no TOML.
    """
    import tomllib  # planning reads none: not worth its import at every start

    try:
        return tomllib.loads(content.decode())
    except UnicodeDecodeError:
        raise MalformedFile(where, "not UTF-8 text") from None
    except tomllib.TOMLDecodeError as error:
        raise MalformedFile(where, f"not TOML: {error}") from None


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Return the content of a file.

    Raises:
        MalformedFile: where it cannot be read.
    """
    try:
        return Path(path).read_bytes()
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise MalformedFile(os.fspath(path), f"cannot be read: {reason}") from None


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a file whole or not at all (a temporary file beside it, then a rename).

    Raises:
        MalformedFile: where it cannot be written.
    """
    target = Path(path)
    if not target.exists() or target.is_file():
        temporary = target.with_name(f".{target.name}.{os.getpid()}.part")
        try:
            temporary.write_text(text, encoding="utf-8")
            temporary.replace(target)
        except OSError as error:
            temporary.unlink(missing_ok=True)
            raise MalformedFile(os.fspath(path), f"cannot be written: {error.strerror}") from None
        return
    try:  # /dev/stdout, a pipe: nothing to rename
        target.write_text(text, encoding="utf-8")
    except OSError as error:
        raise MalformedFile(os.fspath(path), f"cannot be written: {error.strerror}") from None


def convert(document: Any, kind: Any, where: str) -> Any:
    """Check a parsed document against a msgspec type; one-line `MalformedFile` where it does not fit.

    Raises:
        MalformedFile: with the place and, for an unknown key, the allowed ones.
    """
    try:
        return msgspec.convert(document, kind)
    except msgspec.ValidationError as error:
        message = str(error).replace("`$.", "`").removeprefix("Object contains ")
        message = message.replace("Object missing", "missing")
        if message.startswith("unknown field") and " - at " not in message:
            message += f"; allowed: {', '.join(field.name for field in msgspec.structs.fields(kind))}"
        raise MalformedFile(where, message) from None


def check_format(document: Any, where: str, *wanted: str) -> None:
    """Refuse a document that does not say one of the wanted `format`s.

    Raises:
        MalformedFile: where it says another one or none.
    """
    if not isinstance(document, dict):
        raise MalformedFile(where, f"not a JSON object; a {wanted[0]} file is one")
    found = document.get("format")
    if found not in wanted:
        allowed = f"{wanted[0]!r} is" if len(wanted) == 1 else f"{' and '.join(map(repr, wanted))} are"
        raise MalformedFile(where, f"`format`: {found!r} is not allowed; {allowed}")


def read_instance(path: str | os.PathLike[str]) -> Instance:
    """Read and check an instance file, version 1 or 2.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    return instance_from_document(parse_json(read_bytes(path), where), where)


def instance_from_document(document: Any, where: str = "instance") -> Instance:
    """Check a parsed instance document and build the instance.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    check_format(document, where, INSTANCE_FORMAT, INSTANCE_FORMAT_2)
    _check_goal_keys(document.get("goal"), where)
    second = document["format"] == INSTANCE_FORMAT_2
    file = cast(_InstanceFile, convert(document, _InstanceFile2 if second else _InstanceFile, where))
    match file.goal:
        case _StacksGoalFile(stacks=stacks):
            goal: Goal = StacksGoal({location: tuple(pile) for location, pile in stacks.items()})
        case _PositionsGoalFile(positions=positions):
            goal = PositionsGoal(dict(positions))
        case _OnGoalFile(on=on, bottom=bottom):
            goal = OnGoal(dict(on), tuple(bottom))
    return make_instance(
        name=file.name,
        blocks=file.blocks,
        stacks=file.stacks,
        buffers=file.buffers,
        start=file.start,
        goal=goal,
        table=file.table,
        where=where,
        **(_additions(file) if isinstance(file, _InstanceFile2) else {}),
    )


def _additions(file: _InstanceFile2) -> dict[str, Any]:
    """Return what version 2 adds, as arguments of `make_instance`."""
    costs = file.costs
    return {
        "carriers": [Carrier(c.name, tuple(c.stations), c.at, c.capacity, tuple(c.holds)) for c in file.carriers],
        "capacities": file.capacities,
        "costs": Costs(costs.actions, costs.travel, costs.positions, costs.unit),
    }


def _check_goal_keys(goal: Any, where: str) -> None:
    """Refuse an unknown goal kind or key, naming the allowed ones (msgspec names none)."""
    if not isinstance(goal, dict):
        return
    kind = goal.get("kind")
    if not isinstance(kind, str) or kind not in GOAL_KEYS:
        raise MalformedFile(where, f"`goal.kind`: {kind!r} is not allowed; one of {', '.join(GOAL_KEYS)}")
    for key in goal:
        if key not in GOAL_KEYS[kind]:
            raise MalformedFile(where, f"`goal`: unknown key {key!r}; allowed: {', '.join(GOAL_KEYS[kind])}")


def make_instance(
    *,
    name: str,
    blocks: Iterable[str],
    stacks: Iterable[str],
    start: Mapping[str, Iterable[str]],
    goal: Goal,
    buffers: Iterable[str] = (),
    table: Iterable[str] = (),
    carriers: Iterable[Carrier] = (),
    capacities: Mapping[str, int] | None = None,
    costs: Costs = UNIT_COSTS,
    where: str = "instance",
) -> Instance:
    """Build an instance and check it whole.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    instance = Instance(
        name=name,
        blocks=tuple(blocks),
        stacks=tuple(stacks),
        buffers=tuple(buffers),
        start={location: tuple(pile) for location, pile in start.items()},
        goal=goal,
        table=tuple(table),
        carriers=tuple(carriers),
        capacities=dict(capacities or {}),
        costs=costs,
    )
    InstanceChecker(instance, where).check()
    return replace(instance, start={location: instance.start.get(location, ()) for location in instance.locations})


def instance_document(instance: Instance) -> dict[str, Any]:
    """Return the document of an instance; empty locations are left out of `start`."""
    match instance.goal:
        case StacksGoal(stacks):
            goal: dict[str, Any] = {"kind": "stacks", "stacks": {k: list(v) for k, v in stacks.items() if v}}
        case PositionsGoal(positions):
            goal = {"kind": "positions", "positions": {k: list(v) for k, v in positions.items()}}
        case OnGoal(on, bottom):
            goal = {"kind": "on", "on": dict(on), "bottom": list(bottom)}
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
    return document | {"format": INSTANCE_FORMAT_2} | additions if additions else document


def _addition_documents(instance: Instance) -> dict[str, Any]:
    additions: dict[str, Any] = {}
    if instance.carriers:
        additions["carriers"] = [msgspec.to_builtins(carrier) for carrier in instance.carriers]
    if instance.capacities:
        additions["capacities"] = dict(instance.capacities)
    if instance.costs != UNIT_COSTS:
        additions["costs"] = msgspec.to_builtins(instance.costs)
    return additions


def _one_key_a_line(document: Mapping[str, Any]) -> str:
    lines = [f" {json.dumps(key)}: {json.dumps(value)}" for key, value in document.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def write_instance(instance: Instance, path: str | os.PathLike[str]) -> None:
    """Write an instance file, byte for byte the same for equal instances."""
    write_text(path, _one_key_a_line(instance_document(instance)))


def action_from_list(entry: list[Any], where: str) -> Action:
    """Build an action from its JSON list.

    Raises:
        MalformedFile: where it is none.
    """
    match entry:
        case ["pick", str(block), str(source)]:
            return Pick(block, source)
        case ["place", str(block), str(target)]:
            return Place(block, target)
        case [str(name), *_] if name in FAMILY:
            action: Action | None = FAMILY[name].read(entry)
            if action is not None:
                return action
    forms = ['["pick", block, source]', '["place", block, target]', *(kind.form for kind in FAMILY.values())]
    raise MalformedFile(where, f"{json.dumps(entry)} is no action; allowed: {', '.join(forms[:-1])} or {forms[-1]}")


def action_list(action: Action) -> list[str | int]:
    """Return the JSON list of an action."""
    match action:
        case Pick(block, source):
            return ["pick", block, source]
        case Place(block, target):
            return ["place", block, target]
        case Aggregating():
            return kind_of(action).write(action)


def read_plan(path: str | os.PathLike[str]) -> Plan:
    """Read a plan file; whether it is legal is the law's question, not asked here.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    return plan_from_document(parse_json(read_bytes(path), where), where)


def plan_from_document(document: Any, where: str = "plan") -> Plan:
    """Build a plan from a parsed plan document.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    check_format(document, where, PLAN_FORMAT, PLAN_FORMAT_2)
    second = document["format"] == PLAN_FORMAT_2
    file = cast(_PlanFile, convert(document, _PlanFile2 if second else _PlanFile, where))
    without = tuple(file.without) if isinstance(file, _PlanFile2) else ()
    for name in without:
        if name not in FAMILY:
            raise MalformedFile(where, f"`without`: {name!r} is not one of {', '.join(FAMILY)}")
    if file.status not in STATUSES:
        raise MalformedFile(where, f"`status`: {file.status!r} is not one of {', '.join(STATUSES)}")
    if file.max_topple is not None and file.max_topple < 1:
        raise MalformedFile(where, f"`max_topple`: {file.max_topple} is not allowed; null or 1 and more")
    if (file.actions is None) != (file.cost is None):
        raise MalformedFile(where, "`cost` and `actions` are both null or both given")
    if file.actions is not None and file.status in ("infeasible", "unknown"):
        raise MalformedFile(where, f"`actions`: status {file.status} has no plan; null is allowed")
    if file.actions is None and file.status in ("optimal", "feasible"):
        raise MalformedFile(where, f"`actions`: null, but status {file.status} needs a plan")
    actions = None
    if file.actions is not None:
        actions = tuple(action_from_list(a, f"{where}: `actions[{i}]`") for i, a in enumerate(file.actions))
    return Plan(
        instance=file.instance,
        planner=file.planner,
        options=PlanOptions(file.topple, file.max_topple, without=without),
        status=cast(Status, file.status),
        actions=actions,
        lower_bound=file.lower_bound,
        bound_origin=file.bound_origin,
        incumbents=tuple(Incumbent(*entry) for entry in file.incumbents),
        stated_cost=file.cost,
    )


def plan_document(plan: Plan) -> dict[str, Any]:
    """Return the document of a plan."""
    second = _needs_second_version(plan)
    return {
        "format": PLAN_FORMAT_2 if second else PLAN_FORMAT,
        "instance": plan.instance,
        "planner": plan.planner,
        "topple": plan.options.topple,
        "max_topple": plan.options.max_topple,
        **({"without": list(plan.options.without)} if second else {}),
        "status": plan.status,
        "cost": plan.cost,
        "lower_bound": plan.lower_bound,
        "bound_origin": plan.bound_origin,
        "incumbents": [[round(i.seconds, 4), i.cost, i.origin] for i in plan.incumbents],
        "actions": None if plan.actions is None else [action_list(a) for a in plan.actions],
    }


def _needs_second_version(plan: Plan) -> bool:
    actions = plan.actions or ()
    further = any(isinstance(action, Aggregating) and kind_of(action).name != "topple" for action in actions)
    return further or bool(plan.options.without) or plan.cost not in (None, len(actions))


def plan_text(plan: Plan) -> str:
    """Return the text of a plan file."""
    return _one_key_a_line(plan_document(plan))


def write_plan(plan: Plan, path: str | os.PathLike[str]) -> None:
    """Write a plan file."""
    write_text(path, plan_text(plan))
