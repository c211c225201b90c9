"""`smash.planners.shorten` of 0.1: `smash.planners.greedy.shorten`."""

from smash.planners.greedy.shorten import shorten

__all__ = ["shorten"]
