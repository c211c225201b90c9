"""The greedy planner: a feasible plan at any size, wherever one exists."""

from smash.planners.greedy.passes import GreedyRun, greedy_plans, greedy_steps
from smash.planners.greedy.planner import GreedyPlanner, end_of, greedy_method

__all__ = ["GreedyPlanner", "GreedyRun", "end_of", "greedy_method", "greedy_plans", "greedy_steps"]
