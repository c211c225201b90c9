"""The parts that there are: the built-in ones, more by the entry-point group `smash.pddl_parts`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib.metadata import entry_points

from baselines.family.carry import CarryPart
from baselines.family.hand import HandPart
from baselines.family.lift import LiftPart
from baselines.family.part import Part
from baselines.family.topple import TopplePart
from smash.problem.model import Instance, PlanOptions

GROUP = "smash.pddl_parts"


def _from_outside() -> Iterator[Part]:
    """Yield the parts that other packages add; one that cannot be loaded is named and left out."""
    for entry in entry_points(group=GROUP):
        try:
            yield entry.load()()
        except Exception as error:  # another package's fault must not stop this one
            print(f"smash: PDDL part {entry.name!r} cannot be loaded: {error}", file=sys.stderr)


PARTS: tuple[Part, ...] = (HandPart(), TopplePart(), CarryPart(), LiftPart(), *_from_outside())
TOLD = frozenset(part.kind for part in PARTS[1:])
"""The aggregating actions that can be told in PDDL."""


def parts_of(instance: Instance, options: PlanOptions) -> tuple[Part, ...]:
    """Return the parts of the domain of an instance, in their order."""
    return tuple(part for part in PARTS if part.needed(instance, options))
