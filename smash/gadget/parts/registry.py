"""The parts of a gadget that there are: three built in, more by the entry-point group `smash.gadget_parts`."""

from __future__ import annotations

from smash.gadget.builder import AggregatingPart
from smash.gadget.parts.carry import CarryPart
from smash.gadget.parts.lift import LiftPart
from smash.gadget.parts.topple import TopplePart
from smash.problem.actions.outside import added_classes
from smash.problem.model import Instance, PlanOptions

GROUP = "smash.gadget_parts"

BUILT_IN: tuple[type[AggregatingPart], ...] = (TopplePart, CarryPart, LiftPart)

PARTS: dict[str, type[AggregatingPart]] = {
    part.name: part for part in (*BUILT_IN, *added_classes(GROUP, AggregatingPart), *BUILT_IN)
}
"""Classes of parts by the name of their action; the built-in ones come first and cannot be replaced."""


def parts_of(instance: Instance, options: PlanOptions) -> list[AggregatingPart]:
    """Return the parts of an instance's gadget, in the order of `PARTS`."""
    made = (part.of(instance, options) for part in PARTS.values())
    return [part for part in made if part is not None]
