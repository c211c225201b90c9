"""`smash.planners.highs` of 0.1: `smash.planners.milp.solvers.highs`."""

from smash.planners.milp.solvers.highs import solve, write

__all__ = ["solve", "write"]
