"""The aggregating actions as parts of a gadget. A new one is a file of its own and a line here."""

from __future__ import annotations

from collections.abc import Callable

from smash.gadget.builder import AggregatingPart
from smash.gadget.parts import carry, lift, topple
from smash.problem.model import Instance, PlanOptions

PARTS: tuple[Callable[[Instance, PlanOptions], AggregatingPart | None], ...] = (
    topple.part_of,
    carry.part_of,
    lift.part_of,
)
"""Per action, what makes its part for an instance, or None where it is not needed there."""


def parts_of(instance: Instance, options: PlanOptions) -> list[AggregatingPart]:
    """Return the parts of an instance's gadget, in the family's order."""
    made = (make(instance, options) for make in PARTS)
    return [part for part in made if part is not None]
