"""`smash.planners.gurobi` of 0.1: `smash.planners.milp.solvers.gurobi`."""

from smash.planners.milp.solvers.gurobi import solve

__all__ = ["solve"]
