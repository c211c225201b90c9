"""`smash.planners.targets` of 0.1: `smash.problem.views.targets`."""

from smash.problem.views.targets import Piles, Tower, goal_piles, target_piles, towers_of

__all__ = ["Piles", "Tower", "goal_piles", "target_piles", "towers_of"]
