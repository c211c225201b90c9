"""Any plan as a solution of the flow model: buffers renamed to those that the model has, then encoded."""

from __future__ import annotations

from collections.abc import Sequence

from smash.gadget.encode import encode
from smash.gadget.motion import PebbleMotion
from smash.planners.flow.scope import Scope
from smash.problem.family import kind_of
from smash.problem.model import TABLE, Action, Aggregating, Instance, Pick, Place, State


def motion_of(scope: Scope, instance: Instance, actions: Sequence[Action]) -> PebbleMotion:
    """Return the motion of a legal plan of `instance` on the gadget of `scope`."""
    motion = encode(scope.instance, _Renaming(scope, instance).run(actions), scope.gadget)
    gadget = scope.gadget
    lifted = {
        gadget.stack_node(buffer, height): gadget.top(buffer)
        for buffer in scope.own_buffers
        for height in range(1, gadget.height + 1)
    }
    layers = tuple(tuple(lifted.get(node, node) for node in layer) for layer in motion.layers)
    return PebbleMotion(gadget, motion.blocks, layers)


class _Renaming:
    """Replays a plan with other buffers: a block's own one, else any that is free (buffers are interchangeable)."""

    def __init__(self, scope: Scope, instance: Instance) -> None:
        self._scope = scope
        self._own = dict(zip(scope.instance.blocks, scope.own_buffer, strict=True))
        self._state = State.start_of(instance)
        self._used = {buffer for buffer in instance.buffers if instance.start[buffer]}
        self._name = {location: location for location in (*instance.stacks, *self._used)}
        self._at = {block: location for location, pile in instance.start.items() for block in pile}
        self._buffers = frozenset(instance.buffers)

    def run(self, actions: Sequence[Action]) -> list[Action]:
        renamed: list[Action] = []
        for action in actions:
            match action:
                case Pick(block, source):
                    renamed.append(self._pick(block, source))
                case Place(block, target):
                    renamed.append(self._place(block, target))
                case Aggregating():
                    kind_of(action).apply(self._state, action)
                    renamed.append(action)
        return renamed

    def _pick(self, block: str, source: str) -> Pick:
        if source == TABLE:
            return Pick(block, TABLE)
        self._state.piles[source].pop()
        if source in self._buffers and not self._state.piles[source] and source not in self._used:
            self._name.pop(source, None)
        return Pick(block, self._at.pop(block))

    def _place(self, block: str, target: str) -> Place:
        own = self._own[block]
        if target in self._buffers and target not in self._used and own is not None:
            name = own
        else:
            name = self._name.get(target) or self._free_buffer()
            self._name[target] = name
        self._state.piles[target].append(block)
        self._at[block] = name
        return Place(block, name)

    def _free_buffer(self) -> str:
        taken = set(self._name.values())
        return next(buffer for buffer in self._scope.instance.buffers if buffer not in taken)
