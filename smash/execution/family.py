"""How the arm carries out aggregating actions: one line for each built-in one, as in `smash.problem.family`.

Other packages add motions by the entry-point group `smash.motions`, as they add the law of their actions.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib.metadata import entry_points
from typing import Any

from smash.execution.aggregate_motion import AggregateMotion
from smash.execution.carrying import CarryMotion
from smash.execution.lifting import LiftMotion
from smash.execution.pushes import ToppleMotion
from smash.problem.model import Aggregating

GROUP = "smash.motions"


def _from_outside() -> Iterator[AggregateMotion[Any]]:
    """Yield the motions that other packages add; one that cannot be loaded is named and left out."""
    for entry in entry_points(group=GROUP):
        try:
            yield entry.load()()
        except Exception as error:  # another package's fault must not stop this one
            print(f"smash: motion {entry.name!r} cannot be loaded: {error}", file=sys.stderr)


MOTIONS: dict[type[Aggregating], AggregateMotion[Any]] = {
    motion.action: motion for motion in (*_from_outside(), ToppleMotion(), CarryMotion(), LiftMotion())
}
"""Motions by the class of the action; the built-in ones cannot be replaced."""
