"""Exact search over states (A*), for few buffers and for whatever the precedence graph leaves open."""

from smash.planners.astar.driver import StateSearch
from smash.planners.astar.planner import AStarPlanner

__all__ = ["AStarPlanner", "StateSearch"]
