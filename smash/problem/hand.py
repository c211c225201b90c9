"""A start with a block in the hand: its first action is a place, and every place leads to an instance without one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from smash.problem.model import Instance, OnGoal, PositionsGoal, StacksGoal, no_goal


def after_place(instance: Instance, target: str) -> Instance:
    """Return the instance that is left when the held block has been put on a location or a carrier.

    Args:
        instance: one with a block in the hand.
        target: the name of the location or carrier.
    """
    block = instance.hand
    assert block is not None
    if target in instance.start:
        start = {**instance.start, target: (*instance.start[target], block)}
        return replace(instance, start=start, hand=None)
    carriers = tuple(
        replace(carrier, holds=(*carrier.holds, block)) if carrier.name == target else carrier
        for carrier in instance.carriers
    )
    return replace(instance, carriers=carriers, hand=None)


def distinct_locations(instance: Instance) -> Iterator[str]:
    """Yield one location of each class of equal ones: both empty, of one kind, and wanted for the same by the goal."""
    seen = set()
    for location in instance.locations:
        key: object = location
        if not instance.start[location]:
            stands_at = instance.costs.positions.get(location) if instance.costs.travel else None
            key = (location in instance.stacks, _wanted(instance, location), stands_at)
        if key not in seen:
            seen.add(key)
            yield location


def _wanted(instance: Instance, location: str) -> tuple[str, ...]:
    """Return the pile that the goal wants at a location."""
    match instance.goal:
        case StacksGoal(stacks):
            return tuple(stacks.get(location, ()))
        case PositionsGoal() as goal:
            return goal.stacks().get(location, ())
        case OnGoal():
            return ()
        case _:
            no_goal(instance.goal)
