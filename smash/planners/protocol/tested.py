"""Up to which costs the proofs of somebody else's solver were tested, and so are believed."""

from __future__ import annotations

from smash.problem.actions.registry import FAMILY
from smash.problem.model import Instance


def most_sum(instance: Instance) -> float:
    """Return what a solver may come to add: two of the dearest moves for each block, a topple with each."""
    costs = instance.costs
    places = list(costs.positions) if costs.travel else []
    farthest = max((costs.distance(a, b) for a in places for b in places), default=0)
    dearest = costs.of("pick") + costs.of("place") + max(map(costs.of, FAMILY)) + 2 * farthest
    return 2 * dearest * max(1, len(instance.blocks))


def why_doubted(who: str, instance: Instance, tested: int) -> str | None:
    """Return why what a solver proves of an instance is only its claim, or None where it is believed.

    Args:
        who: the solver, or the engine.
        instance: what it is asked; where every action costs 1 it is believed.
        tested: the highest sum of costs (`most_sum`) up to which its proofs agreed with this package's own search.
    """
    if instance.costs.plain or (most := most_sum(instance)) <= tested:
        return None
    return f"costs may add up to {most:,.0f}; proofs of {who} are tested up to {tested:,}"
