"""The goal as a plan has to reach it: what `ontable` and `clear` come to for one start, as far as they come to less."""

from __future__ import annotations

from dataclasses import replace

from smash.problem.model import Instance, OnGoal


def posed(instance: Instance, *, falls: bool) -> Instance:
    """Return the instance with an equivalent goal that uses `bottom` in place of `ontable` and `clear` where it can.

    - Nothing lies on a block of the table region: an `ontable` block that carries another is at a bottom.
    - Where nothing falls, an `ontable` block that starts elsewhere is at a bottom too, and one that starts in the table
      region is there already.
    - Where the goal says of every other block what it stands on, a `clear` block is clear anyway.

    Args:
        instance: the instance; a goal that contradicts itself may come back as any other such goal.
        falls: whether a block may come to lie in the table region.
    """
    goal = instance.goal
    if not isinstance(goal, OnGoal) or not (goal.ontable or goal.clear):
        return instance
    loaded = set(goal.on.values())
    named = set(goal.bottom)
    bottom, aside = list(goal.bottom), []
    for block in goal.ontable:
        if block in named:
            continue
        if block in loaded or not (falls or block in instance.table):
            bottom.append(block)
        elif falls:
            aside.append(block)
    placed = {*goal.on, *bottom, *goal.ontable}
    open_blocks = [block for block in instance.blocks if block not in placed]
    clear = tuple(block for block in goal.clear if any(other != block for other in open_blocks))
    return replace(instance, goal=OnGoal(goal.on, tuple(bottom), tuple(aside), clear))


def open_rest(instance: Instance) -> str | None:
    """Return which part of a posed goal leaves open where a block comes to rest, in a few words, or None."""
    goal = instance.goal
    if not isinstance(goal, OnGoal):
        return None
    if goal.ontable:
        return "the goal has blocks on the table, which a topple may bring about (`ontable`)"
    return "the goal has blocks clear, whatever is beside them (`clear`)" if goal.clear else None
