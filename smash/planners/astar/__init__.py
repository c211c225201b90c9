"""Search over states: exact (A*) for few buffers and what the precedence graph leaves open, else by beams."""

from smash.planners.astar.beam import BeamSearch
from smash.planners.astar.driver import StateSearch
from smash.planners.astar.planner import AStarPlanner
from smash.planners.astar.restarts import search_law_states

__all__ = ["AStarPlanner", "BeamSearch", "StateSearch", "search_law_states"]
