"""The greedy planner: a feasible plan at any size, wherever one exists."""

from smash.planners.greedy.planner import GreedyPlanner, greedy_steps, twin_plans

__all__ = ["GreedyPlanner", "greedy_steps", "twin_plans"]
