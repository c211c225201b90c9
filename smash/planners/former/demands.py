"""`smash.planners.demands` of 0.1: `smash.problem.views.demands`."""

from smash.problem.views.demands import Demands, FloatingChain, Pile, demands_of

__all__ = ["Demands", "FloatingChain", "Pile", "demands_of"]
