"""`smash.planners.gentle` of 0.1: `smash.planners.protocol.gentle`, which takes a law."""

from collections.abc import Sequence

from smash.planners.protocol import gentle
from smash.problem.model import Action, Instance
from smash.problem.rules import Law

__all__ = ["gentle_topples"]


def gentle_topples(instance: Instance, actions: Sequence[Action]) -> tuple[Action, ...]:
    """Raise the cut of each topple of a legal plan as far as the rest of the plan allows."""
    return gentle.gentle_topples(Law(instance), actions)
