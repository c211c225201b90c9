"""The greedy planner: a feasible plan at any size, wherever one exists."""

from smash.planners.greedy.passes import greedy_plans, greedy_steps
from smash.planners.greedy.planner import GreedyPlanner, greedy_method

__all__ = ["GreedyPlanner", "greedy_method", "greedy_plans", "greedy_steps"]
