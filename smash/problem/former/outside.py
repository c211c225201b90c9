"""`smash.problem.outside` of 0.1: `smash.problem.actions.outside`."""

from smash.problem.actions.outside import added

__all__ = ["added"]
