"""Moves that no plan asks for: put down what is in the hand, take away what is in the way of an action."""

from __future__ import annotations

from collections.abc import Callable

from smash.execution.actions.registry import MOTIONS
from smash.execution.performing import Performer
from smash.problem.errors import ExecutionFailure
from smash.problem.model import TABLE, Action, Aggregating, Instance, Pick, Place

NEAR = 0.11
"""Loose blocks this near to a place can be in the hand's way there [m]."""


class Recovery:
    """Clears the way for a new plan.

    Args:
        instance: Whose locations may be used.
        performer: Shows what the world is like.
        perform: Performs and records one action; raises `ExecutionFailure`.
    """

    def __init__(self, instance: Instance, performer: Performer, perform: Callable[[Action], None]) -> None:
        self.instance = instance
        self.performer = performer
        self._perform = perform

    def put_down(self) -> bool:
        """Place the held block where it is in nobody's way: an empty buffer first, any pile last."""
        block = self.performer.hand
        assert block is not None
        piles = self.performer.observe().piles
        order = {name: index for index, name in enumerate((*self.instance.buffers, *self.instance.stacks))}
        for target in sorted(piles, key=lambda name: (len(piles[name]) > 0, order[name])):
            try:
                self._perform(Place(block, target))
                return True
            except ExecutionFailure:
                if self.performer.hand is None:
                    return True
        return False

    def clear(self, action: Action) -> None:
        """Move what is in the way of an action that could not be done: a loose block, or a pile that hides one."""
        where, state = self.performer.look(), self.performer.observe()
        match action:
            case Pick(block, _):
                x, y = (float(value) for value in where.blocks[block].position[:2])
                points, spared = [(x, y)], {block}
            case Place(_, target):
                points, spared = [where.point(target)], set()
            case Aggregating():
                points, spared = [where.point(place) for place in MOTIONS[type(action)].places(action)], set()

        def away(name: str) -> float:
            return min(where.blocks[name].distance(*point) for point in points)

        loose = [name for name in state.table if name not in spared and away(name) < NEAR]
        for name in sorted(loose, key=lambda name: (-round(where.blocks[name].position[2], 2), away(name))):
            if self._set_aside(name, TABLE):
                return
        if isinstance(action, Pick) and action.source == TABLE:
            self._uncover(action.block, *points[0])

    def _uncover(self, block: str, x: float, y: float) -> None:
        """Take down the pile beside a loose block, one by one, until the block itself can be set aside.

        It ends where a block cannot be put down again: the hand is full then.
        """
        near = [name for name, slot in self.performer.table.slots.items() if slot.distance(x, y) < NEAR]
        for location in sorted(near, key=lambda name: self.performer.table.slots[name].distance(x, y)):
            for _ in range(len(self.performer.observe().piles[location])):
                pile = self.performer.observe().piles[location]
                if not pile or not self._set_aside(pile[-1], location):
                    break
                if self.performer.hand is not None or self._set_aside(block, TABLE):
                    return

    def _set_aside(self, block: str, source: str) -> bool:
        """Pick a block and put it down where it is in nobody's way; say whether the hand got it."""
        try:
            self._perform(Pick(block, source))
        except ExecutionFailure:
            if self.performer.hand is None:
                return False
        self.put_down()
        return True
