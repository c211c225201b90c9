"""`smash.planners.indexed` of 0.1: `smash.problem.views.numbered`."""

from smash.problem.views.numbered import ON_TABLE, TOPPLE, Step, cost_of
from smash.problem.views.numbered import Numbered as Indexed

__all__ = ["ON_TABLE", "TOPPLE", "Indexed", "Step", "cost_of"]
