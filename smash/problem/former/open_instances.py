"""`smash.problem.open_instances` of 0.1: `smash.problem.sets.open_instances`."""

from smash.problem.sets.open_instances import FAMILIES, Shape, draw_instance, open_set

__all__ = ["FAMILIES", "Shape", "draw_instance", "open_set"]
