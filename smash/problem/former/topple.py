"""`smash.problem.topple` of 0.1: `smash.problem.actions.topple`."""

from smash.problem.actions.topple import Topple, ToppleKind

__all__ = ["Topple", "ToppleKind"]
