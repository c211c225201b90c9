"""The aggregating actions that there are: three built in, more by the entry-point group `smash.aggregating`."""

from __future__ import annotations

from typing import Any

from smash.problem.actions.carry import CarryKind
from smash.problem.actions.kind import AggregatingKind, allowed
from smash.problem.actions.lift import LiftKind
from smash.problem.actions.outside import added
from smash.problem.actions.topple import ToppleKind
from smash.problem.model import Aggregating, Instance, PlanOptions

GROUP = "smash.aggregating"

FAMILY: dict[str, AggregatingKind[Any]] = {
    kind.name: kind for kind in (*added(GROUP, AggregatingKind), ToppleKind(), CarryKind(), LiftKind())
}
"""Kinds of aggregating actions by name; the built-in ones cannot be replaced."""

_BY_CLASS: dict[type[Aggregating], AggregatingKind[Any]] = {kind.action: kind for kind in FAMILY.values()}


def kind_of(action: Aggregating) -> AggregatingKind[Any]:
    """Return the kind of an action."""
    return _BY_CLASS[type(action)]


def kinds_of(instance: Instance, options: PlanOptions) -> list[AggregatingKind[Any]]:
    """Return the kinds of aggregating actions that plans of `instance` may use, in the family's order."""
    return [kind for kind in FAMILY.values() if allowed(kind, instance, options)]
