"""Mixed-integer linear programs as arrays, and the solvers behind them."""

from smash.planners.milp.arrays import Floats, Ints, Milp, MilpBuilder, MilpResult, MilpStatus, OnSolution, OutOfTime

__all__ = ["Floats", "Ints", "Milp", "MilpBuilder", "MilpResult", "MilpStatus", "OnSolution", "OutOfTime"]
