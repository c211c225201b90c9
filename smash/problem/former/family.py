"""`smash.problem.family` of 0.1: `smash.problem.actions.registry`."""

from smash.problem.actions.registry import FAMILY, GROUP, kind_of, kinds_of
from smash.problem.model import Instance, PlanOptions
from smash.problem.problem import Problem

__all__ = ["FAMILY", "GROUP", "is_plain", "kind_of", "kinds_of"]


def is_plain(instance: Instance, options: PlanOptions) -> bool:
    """Return whether a problem is one of pick, place and topple alone, each at cost 1."""
    return Problem(instance, options).plain
