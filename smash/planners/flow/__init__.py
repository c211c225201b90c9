"""`smash-flow`: the paper's time-expanded multi-commodity flow over the gadget (section "Method").

`scope` says what the model holds, `reach` and `arcs` expand the gadget over time, `model` writes the rows,
`horizon` says how many steps prove what, `search` solves, `planner` is the door.
"""

from smash.planners.flow.planner import FlowPlanner

__all__ = ["FlowPlanner"]
