"""`smash.problem.aggregating` of 0.1: `smash.problem.actions.kind`."""

from smash.problem.actions.kind import A, AggregatingKind, Hop, allowed

__all__ = ["A", "AggregatingKind", "Hop", "allowed"]
