"""Within which numbers each engine's proofs were tested, and so are believed."""

from __future__ import annotations

from smash.problem.actions.registry import FAMILY
from smash.problem.model import Instance

TESTED = {"fd-opt": 1_257_223_104, "fd-opt-ipdb": 1_257_223_104, "symk-opt": 1_257_223_104}
"""Engine -> the highest sum of costs (`most_sum`) up to which its proofs agreed with this package's own search.

`python -m smash.experiments.studies.engine_ranges` measures it; docs/pddl.md has the table."""


def most_sum(instance: Instance) -> float:
    """Return what an engine may come to add: two of the dearest moves for each block, a topple with each."""
    costs = instance.costs
    places = list(costs.positions) if costs.travel else []
    farthest = max((costs.distance(a, b) for a in places for b in places), default=0)
    dearest = costs.of("pick") + costs.of("place") + max(map(costs.of, FAMILY)) + 2 * farthest
    return 2 * dearest * max(1, len(instance.blocks))


def beyond_tests(engine: str, instance: Instance) -> str | None:
    """Return why what an engine proves of an instance is only its claim, or None where it is believed.

    Args:
        engine: its name, perhaps with an encoding behind a colon.
        instance: what it is asked; where every action costs 1 an engine is believed.
    """
    if instance.costs.plain:
        return None
    most, tested = most_sum(instance), TESTED.get(engine.partition(":")[0], 0)
    if most <= tested:
        return None
    return f"costs may add up to {most:,.0f}; proofs of {engine} are tested up to {tested:,}"
