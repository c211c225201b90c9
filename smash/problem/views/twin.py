"""The plain twin of a problem: pick, place and topple alone, each at cost 1; its plans are plans of the original.

Blocks that start on a carrier lie in the twin's table region: from there too they are picked at any time. There
they do not rest on the table: one that the goal wants `ontable` is wanted at a bottom.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from smash.problem.costs import UNIT_COSTS
from smash.problem.model import TABLE, Action, Instance, OnGoal, Pick


def plain_twin(instance: Instance) -> Instance:
    """Return the twin of an instance."""
    held = tuple(block for carrier in instance.carriers for block in carrier.holds)
    goal = instance.goal
    if isinstance(goal, OnGoal) and held:
        grounded = tuple(block for block in goal.ontable if block in held and block not in goal.bottom)
        ontable = tuple(block for block in goal.ontable if block not in held)
        goal = replace(goal, bottom=goal.bottom + grounded, ontable=ontable)
    return replace(instance, goal=goal, table=instance.table + held, carriers=(), capacities={}, costs=UNIT_COSTS)


def from_twin(instance: Instance, actions: Iterable[Action]) -> Iterator[Action]:
    """Yield the actions of the original for a plan of its twin."""
    carrier_of = {block: carrier.name for carrier in instance.carriers for block in carrier.holds}
    for action in actions:
        if isinstance(action, Pick) and action.source == TABLE and action.block in carrier_of:
            yield Pick(action.block, carrier_of.pop(action.block))
        else:
            yield action
