"""`smash.problem.carry` of 0.1: `smash.problem.actions.carry`."""

from smash.problem.actions.carry import Carry, CarryKind

__all__ = ["Carry", "CarryKind"]
