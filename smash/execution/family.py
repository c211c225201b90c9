"""How the arm carries out aggregating actions: one line for each built-in one, as in `smash.problem.family`.

Other packages add motions by the entry-point group `smash.motions`, as they add the law of their actions.
"""

from __future__ import annotations

from typing import Any

from smash.execution.aggregate_motion import AggregateMotion
from smash.execution.carrying import CarryMotion
from smash.execution.lifting import LiftMotion
from smash.execution.pushes import ToppleMotion
from smash.problem.model import Aggregating
from smash.problem.outside import added

GROUP = "smash.motions"

MOTIONS: dict[type[Aggregating], AggregateMotion[Any]] = {
    motion.action: motion for motion in (*added(GROUP), ToppleMotion(), CarryMotion(), LiftMotion())
}
"""Motions by the class of the action; the built-in ones cannot be replaced."""
