"""`smash.problem.lift` of 0.1: `smash.problem.actions.lift`."""

from smash.problem.actions.lift import Lift, LiftKind

__all__ = ["Lift", "LiftKind"]
