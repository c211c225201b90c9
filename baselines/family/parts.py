"""The parts that there are. A new one is a file of its own, one in `domains/parts`, and a line here."""

from __future__ import annotations

from baselines.family.carry import CarryPart
from baselines.family.hand import HandPart
from baselines.family.lift import LiftPart
from baselines.family.part import Part
from baselines.family.topple import TopplePart
from smash.problem.model import Instance, PlanOptions

PARTS: tuple[Part, ...] = (HandPart(), TopplePart(), CarryPart(), LiftPart())
TOLD = frozenset(part.kind for part in PARTS[1:])
"""The aggregating actions that can be told in PDDL."""


def parts_of(instance: Instance, options: PlanOptions) -> tuple[Part, ...]:
    """Return the parts of the domain of an instance, in their order."""
    return tuple(part for part in PARTS if part.needed(instance, options))
