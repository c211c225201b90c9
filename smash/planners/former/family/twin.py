"""`smash.planners.family.twin` of 0.1: `smash.problem.views.twin`."""

from smash.problem.views.twin import from_twin, plain_twin

__all__ = ["from_twin", "plain_twin"]
