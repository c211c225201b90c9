"""Plan files: `smash-plan/1` and `/2`, and the JSON form of an action.

Version 2 adds `without`, further aggregating actions and a cost that is not the plan's length. What version 1 can say
is written in version 1.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from functools import lru_cache
from typing import Annotated, Any, Literal, cast

import msgspec

from smash.problem import arguments
from smash.problem.actions.registry import FAMILY, kind_of
from smash.problem.errors import MalformedFile
from smash.problem.files.documents import check_format, convert, one_key_a_line, parse_json, read_bytes, write_text
from smash.problem.model import Action, Aggregating, Pick, Place, PlanOptions
from smash.problem.plan import STATUSES, Incumbent, Plan, Status

PLAN_FORMAT = "smash-plan/1"
PLAN_FORMAT_2 = "smash-plan/2"


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
    expected_seconds: Annotated[float, msgspec.Meta(ge=0.0, le=1e9)] | None = None


class _PlanFile2(_PlanFile):
    format: Literal["smash-plan/2"]  # type: ignore[assignment]
    without: list[str] = []


def action_from_list(entry: list[Any], where: str) -> Action:
    """Build an action from its JSON list.

    Raises:
        MalformedFile: where it is none.
    """
    action = _action(entry)
    if action is not None:
        return action
    forms = ['["pick", block, source]', '["place", block, target]', *(kind.form for kind in FAMILY.values())]
    raise MalformedFile(where, f"{json.dumps(entry)} is no action; allowed: {', '.join(forms[:-1])} or {forms[-1]}")


def _action(entry: Sequence[Any]) -> Action | None:
    match entry:
        case ["pick", str(block), str(source)]:
            return Pick(block, source)
        case ["place", str(block), str(target)]:
            return Place(block, target)
        case [str(name), *_] if name in FAMILY:
            action: Action | None = FAMILY[name].read(list(entry))
            return action
    return None


_known_action = lru_cache(1 << 14)(_action)
"""The same for entries of texts and whole numbers, each read once: many plans of a sweep have the same."""


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
    where = arguments.path(path)
    return plan_from_document(parse_json(read_bytes(path, "plan files"), where), where)


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
    if file.actions is None and file.expected_seconds is not None:
        raise MalformedFile(where, "`expected_seconds`: there is no plan; leave it out")
    actions = None
    if file.actions is not None:
        actions = tuple(
            _known_action(tuple(entry)) or action_from_list(entry, f"{where}: `actions[{i}]`")
            for i, entry in enumerate(file.actions)
        )
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
        expected_seconds=file.expected_seconds,
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
        **({} if plan.expected_seconds is None else {"expected_seconds": round(plan.expected_seconds, 2)}),
        "incumbents": [[round(i.seconds, 4), i.cost, i.origin] for i in plan.incumbents],
        "actions": None if plan.actions is None else [action_list(a) for a in plan.actions],
    }


def _needs_second_version(plan: Plan) -> bool:
    actions = plan.actions or ()
    further = any(isinstance(action, Aggregating) and kind_of(action).name != "topple" for action in actions)
    return further or bool(plan.options.without) or plan.cost not in (None, len(actions))


def plan_text(plan: Plan) -> str:
    """Return the text of a plan file."""
    return one_key_a_line(plan_document(plan))


def write_plan(plan: Plan, path: str | os.PathLike[str]) -> None:
    """Write a plan file."""
    write_text(path, plan_text(plan))
