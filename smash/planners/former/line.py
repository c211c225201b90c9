"""`smash.planners.line` of 0.1: `smash.planners.greedy.line`."""

from smash.planners.greedy.line import line_steps

__all__ = ["line_steps"]
