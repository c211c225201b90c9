"""The motions of aggregating actions that there are: three built in, more by the entry-point group `smash.motions`."""

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
    motion.action: motion for motion in (*added(GROUP, AggregateMotion), ToppleMotion(), CarryMotion(), LiftMotion())
}
"""Motions by the class of the action; the built-in ones cannot be replaced."""
