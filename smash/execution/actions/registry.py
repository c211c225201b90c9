"""How the arm carries out aggregating actions: one line for each built-in one, as in `smash.problem.actions.registry`.

Other packages add motions by the entry-point group `smash.motions`, as they add the law of their actions.
"""

from __future__ import annotations

from typing import Any

from smash.execution.actions.carry import CarryMotion
from smash.execution.actions.kind import AggregateMotion
from smash.execution.actions.lift import LiftMotion
from smash.execution.actions.topple import ToppleMotion
from smash.problem.actions.outside import added
from smash.problem.model import Aggregating

GROUP = "smash.motions"

MOTIONS: dict[type[Aggregating], AggregateMotion[Any]] = {
    motion.action: motion for motion in (*added(GROUP), ToppleMotion(), CarryMotion(), LiftMotion())
}
"""Motions by the class of the action; the built-in ones cannot be replaced."""
