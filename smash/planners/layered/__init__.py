"""The layered model: the gadget with its free chain edges contracted, a layer a set of independent actions."""

from smash.planners.layered.planner import LayeredPlanner

__all__ = ["LayeredPlanner"]
