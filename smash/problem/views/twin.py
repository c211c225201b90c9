"""The plain twin of a problem: pick, place and topple alone, each at cost 1; its plans are plans of the original.

Blocks that start on a carrier lie in the twin's table region: from there too they are picked at any time.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from smash.problem.costs import UNIT_COSTS
from smash.problem.model import TABLE, Action, Instance, Pick


def plain_twin(instance: Instance) -> Instance:
    """Return the twin of an instance."""
    held = tuple(block for carrier in instance.carriers for block in carrier.holds)
    return replace(instance, table=instance.table + held, carriers=(), capacities={}, costs=UNIT_COSTS)


def from_twin(instance: Instance, actions: Iterable[Action]) -> Iterator[Action]:
    """Yield the actions of the original for a plan of its twin."""
    carrier_of = {block: carrier.name for carrier in instance.carriers for block in carrier.holds}
    for action in actions:
        if isinstance(action, Pick) and action.source == TABLE and action.block in carrier_of:
            yield Pick(action.block, carrier_of.pop(action.block))
        else:
            yield action
