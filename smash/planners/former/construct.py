"""`smash.planners.construct` of 0.1: `smash.planners.greedy.construct`."""

from smash.planners.greedy.construct import NEVER, Construction

__all__ = ["NEVER", "Construction"]
