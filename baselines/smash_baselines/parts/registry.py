"""The parts that there are: the built-in ones, more by the entry-point group `smash.pddl_parts`."""

from __future__ import annotations

from smash.problem.actions.outside import added
from smash.problem.model import Instance, PlanOptions
from smash_baselines.parts.carry import CarryPart
from smash_baselines.parts.hand import HandPart
from smash_baselines.parts.lift import LiftPart
from smash_baselines.parts.part import Part
from smash_baselines.parts.topple import TopplePart

GROUP = "smash.pddl_parts"

BUILT_IN: tuple[Part, ...] = (TopplePart(), CarryPart(), LiftPart())

PARTS: tuple[Part, ...] = (
    HandPart(),
    *{part.kind: part for part in (*BUILT_IN, *added(GROUP, Part), *BUILT_IN)}.values(),
)
"""The hand's part, then one for each action; the built-in ones come first and cannot be replaced."""

TOLD = frozenset(part.kind for part in PARTS[1:])
"""The aggregating actions that can be told in PDDL."""


def parts_of(instance: Instance, options: PlanOptions) -> tuple[Part, ...]:
    """Return the parts of the domain of an instance, in their order."""
    return tuple(part for part in PARTS if part.needed(instance, options))
