"""JSON files in and out: `smash-instance/1` and `smash-plan/1`.

Reading is strict: unknown keys, unknown names, a block twice or nowhere, a height that floats are refused
by a `MalformedFile` whose one line says where and what is allowed.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Literal, NoReturn, cast

import msgspec

from smash.problem.errors import MalformedFile
from smash.problem.model import (
    TABLE,
    Action,
    Goal,
    Instance,
    OnGoal,
    Pick,
    Place,
    PlanOptions,
    PositionsGoal,
    StacksGoal,
    Topple,
)
from smash.problem.plan import STATUSES, Incumbent, Plan, Status

INSTANCE_FORMAT = "smash-instance/1"
PLAN_FORMAT = "smash-plan/1"
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


def check_format(document: Any, wanted: str, where: str) -> None:
    """Refuse a document that does not say the wanted `format`.

    Raises:
        MalformedFile: where it says another one or none.
    """
    if not isinstance(document, dict):
        raise MalformedFile(where, f"not a JSON object; a {wanted} file is one")
    found = document.get("format")
    if found != wanted:
        raise MalformedFile(where, f"`format`: {found!r} is not allowed; {wanted!r} is")


def read_instance(path: str | os.PathLike[str]) -> Instance:
    """Read and check a `smash-instance/1` file.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    return instance_from_document(parse_json(read_bytes(path), where), where)


def instance_from_document(document: Any, where: str = "instance") -> Instance:
    """Check a parsed `smash-instance/1` document and build the instance.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    check_format(document, INSTANCE_FORMAT, where)
    _check_goal_keys(document.get("goal"), where)
    file = cast(_InstanceFile, convert(document, _InstanceFile, where))
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
    )


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
    )
    _Checker(instance, where).check()
    full_start = {location: instance.start.get(location, ()) for location in instance.locations}
    return Instance(instance.name, instance.blocks, instance.stacks, instance.buffers, full_start, goal, instance.table)


class _Checker:
    """Refuses an instance that contradicts itself; the first defect found is the one reported."""

    def __init__(self, instance: Instance, where: str) -> None:
        self.instance = instance
        self.where = where
        self.blocks = frozenset(instance.blocks)
        self.locations = frozenset(instance.locations)
        self.stacks = frozenset(instance.stacks)

    def refuse(self, part: str, problem: str) -> NoReturn:
        raise MalformedFile(self.where, f"`{part}`: {problem}")

    def check(self) -> None:
        self._names()
        self._start()
        match self.instance.goal:
            case StacksGoal() as goal:
                self._stacks_goal(goal)
            case PositionsGoal() as goal:
                self._positions_goal(goal)
            case OnGoal() as goal:
                self._on_goal(goal)

    def _names(self) -> None:
        self._once("blocks", self.instance.blocks)
        self._once("stacks", self.instance.stacks)
        self._once("stacks and buffers", self.instance.locations)
        if not self.instance.stacks:
            self.refuse("stacks", "at least one location is needed")
        if TABLE in self.locations:
            self.refuse("stacks and buffers", f"{TABLE!r} names the table region; call the location otherwise")

    def _start(self) -> None:
        for location, pile in self.instance.start.items():
            self._location("start", location, self.locations, "a location of stacks or buffers")
            for block in pile:
                self._block(f"start.{location}", block)
        for block in self.instance.table:
            self._block("table", block)
        placed = [block for pile in self.instance.start.values() for block in pile] + list(self.instance.table)
        self._each_block_once("start and table", placed)

    def _stacks_goal(self, goal: StacksGoal) -> None:
        for location, pile in goal.stacks.items():
            self._location("goal.stacks", location, self.stacks, "a location of stacks")
            for block in pile:
                self._block(f"goal.stacks.{location}", block)
        self._each_block_once("goal.stacks", [block for pile in goal.stacks.values() for block in pile])

    def _positions_goal(self, goal: PositionsGoal) -> None:
        heights: dict[str, dict[int, str]] = {}
        for block, (location, height) in goal.positions.items():
            part = f"goal.positions.{block}"
            self._block("goal.positions", block)
            self._location(part, location, self.stacks, "a location of stacks")
            if height < 1:
                self.refuse(part, f"height {height} is not allowed; 1 is the bottom")
            other = heights.setdefault(location, {}).setdefault(height, block)
            if other != block:
                self.refuse(part, f"height {height} of {location!r} is also the goal of {other!r}")
        for location, taken in heights.items():
            for height in sorted(taken):
                if height > 1 and height - 1 not in taken:
                    part = f"goal.positions.{taken[height]}"
                    self.refuse(part, f"height {height} of {location!r} floats: no block has height {height - 1}")

    def _on_goal(self, goal: OnGoal) -> None:
        carried: dict[str, str] = {}
        for upper, under in goal.on.items():
            self._block("goal.on", upper)
            self._block(f"goal.on.{upper}", under)
            other = carried.setdefault(under, upper)
            if other != upper:
                self.refuse(f"goal.on.{upper}", f"{under!r} already carries {other!r}; a block carries one")
        self._once("goal.bottom", goal.bottom)
        for block in goal.bottom:
            self._block("goal.bottom", block)
            if block in goal.on:
                self.refuse("goal.bottom", f"block {block!r} is also on {goal.on[block]!r}")
        self._acyclic(goal.on)

    def _acyclic(self, on: Mapping[str, str]) -> None:
        grounded: set[str] = set()
        for block in on:
            path: dict[str, None] = {}
            while block in on and block not in grounded:
                if block in path:
                    self.refuse(f"goal.on.{block}", f"the block would stand on itself, through {len(path)} blocks")
                path[block] = None
                block = on[block]
            grounded.update(path)

    def _each_block_once(self, part: str, placed: list[str]) -> None:
        self._once(part, placed)
        known = set(placed)
        missing = [block for block in self.instance.blocks if block not in known]
        if missing:
            self.refuse(part, f"block {missing[0]!r} is nowhere; every block stands exactly once")

    def _once(self, part: str, names: Iterable[str]) -> None:
        seen: set[str] = set()
        for name in names:
            if name in seen:
                self.refuse(part, f"{name!r} stands twice; once is allowed")
            seen.add(name)

    def _block(self, part: str, block: str) -> None:
        if block not in self.blocks:
            self.refuse(part, f"{block!r} is not one of `blocks` ({_listing(self.instance.blocks)})")

    def _location(self, part: str, location: str, allowed: frozenset[str], what: str) -> None:
        if location not in allowed:
            names = [name for name in self.instance.locations if name in allowed]
            self.refuse(part, f"{location!r} is not {what} ({_listing(names)})")


def _listing(names: Iterable[str], most: int = 8) -> str:
    shown = [repr(name) for name in names]
    return ", ".join(shown[:most]) + (", …" if len(shown) > most else "") if shown else "none"


def instance_document(instance: Instance) -> dict[str, Any]:
    """Return the `smash-instance/1` document of an instance; empty locations are left out of `start`."""
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
    return document


def _one_key_a_line(document: Mapping[str, Any]) -> str:
    lines = [f" {json.dumps(key)}: {json.dumps(value)}" for key, value in document.items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def write_instance(instance: Instance, path: str | os.PathLike[str]) -> None:
    """Write a `smash-instance/1` file, byte for byte the same for equal instances."""
    write_text(path, _one_key_a_line(instance_document(instance)))


def action_from_list(entry: list[Any], where: str) -> Action:
    """Build an action from its JSON list.

    Raises:
        MalformedFile: where it is none of the three actions.
    """
    match entry:
        case ["pick", str(block), str(source)]:
            return Pick(block, source)
        case ["place", str(block), str(target)]:
            return Place(block, target)
        case ["topple", str(location), int(height)]:
            return Topple(location, height)
    allowed = '["pick", block, source], ["place", block, target] or ["topple", location, height]'
    raise MalformedFile(where, f"{json.dumps(entry)} is no action; allowed: {allowed}")


def action_list(action: Action) -> list[str | int]:
    """Return the JSON list of an action."""
    match action:
        case Pick(block, source):
            return ["pick", block, source]
        case Place(block, target):
            return ["place", block, target]
        case Topple(location, height):
            return ["topple", location, height]


def read_plan(path: str | os.PathLike[str]) -> Plan:
    """Read a `smash-plan/1` file; whether it is legal is the law's question, not asked here.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    where = os.fspath(path)
    return plan_from_document(parse_json(read_bytes(path), where), where)


def plan_from_document(document: Any, where: str = "plan") -> Plan:
    """Build a plan from a parsed `smash-plan/1` document.

    Raises:
        MalformedFile: with one line that says where and what is allowed.
    """
    check_format(document, PLAN_FORMAT, where)
    file = cast(_PlanFile, convert(document, _PlanFile, where))
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
        options=PlanOptions(file.topple, file.max_topple),
        status=cast(Status, file.status),
        actions=actions,
        lower_bound=file.lower_bound,
        bound_origin=file.bound_origin,
        incumbents=tuple(Incumbent(*entry) for entry in file.incumbents),
        stated_cost=file.cost,
    )


def plan_document(plan: Plan) -> dict[str, Any]:
    """Return the `smash-plan/1` document of a plan."""
    return {
        "format": PLAN_FORMAT,
        "instance": plan.instance,
        "planner": plan.planner,
        "topple": plan.options.topple,
        "max_topple": plan.options.max_topple,
        "status": plan.status,
        "cost": plan.cost,
        "lower_bound": plan.lower_bound,
        "bound_origin": plan.bound_origin,
        "incumbents": [[round(i.seconds, 4), i.cost, i.origin] for i in plan.incumbents],
        "actions": None if plan.actions is None else [action_list(a) for a in plan.actions],
    }


def plan_text(plan: Plan) -> str:
    """Return the text of a `smash-plan/1` file."""
    return _one_key_a_line(plan_document(plan))


def write_plan(plan: Plan, path: str | os.PathLike[str]) -> None:
    """Write a `smash-plan/1` file."""
    write_text(path, plan_text(plan))
