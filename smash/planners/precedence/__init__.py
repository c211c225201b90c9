"""`precedence`: the hitting-set formulation over one precedence graph (`docs/theory.md`)."""

from smash.planners.precedence.planner import PrecedencePlanner

__all__ = ["PrecedencePlanner"]
