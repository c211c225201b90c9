"""`smash.problem.checking` of 0.1: `smash.problem.files.checking`."""

from smash.problem.files.checking import FARTHEST, MOST_COST, InstanceChecker

__all__ = ["FARTHEST", "MOST_COST", "InstanceChecker"]
