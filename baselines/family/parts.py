"""The parts that there are: the built-in ones, more by the entry-point group `smash.pddl_parts`."""

from __future__ import annotations

from baselines.family.carry import CarryPart
from baselines.family.hand import HandPart
from baselines.family.lift import LiftPart
from baselines.family.part import Part
from baselines.family.topple import TopplePart
from smash.problem.model import Instance, PlanOptions
from smash.problem.outside import added

GROUP = "smash.pddl_parts"

PARTS: tuple[Part, ...] = (HandPart(), TopplePart(), CarryPart(), LiftPart(), *added(GROUP))
TOLD = frozenset(part.kind for part in PARTS[1:])
"""The aggregating actions that can be told in PDDL."""


def parts_of(instance: Instance, options: PlanOptions) -> tuple[Part, ...]:
    """Return the parts of the domain of an instance, in their order."""
    return tuple(part for part in PARTS if part.needed(instance, options))
