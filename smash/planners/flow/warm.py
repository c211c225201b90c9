"""Any plan as a solution of the flow model: buffers renamed to those that the model has, then encoded."""

from __future__ import annotations

from collections.abc import Sequence

from smash.gadget.encode import encode
from smash.gadget.motion import PebbleMotion
from smash.planners.flow.scope import Scope
from smash.problem.model import Action, Aggregating, Pick, Place, State
from smash.problem.problem import Problem


def motion_of(problem: Problem, scope: Scope, actions: Sequence[Action]) -> PebbleMotion:
    """Return the motion of a legal plan of a problem on the gadget of its scope."""
    if scope.instance.buffers != problem.instance.buffers or scope.own_buffers or scope.alike:
        actions = _Renaming(problem, scope).run(actions)
    motion = encode(scope.instance, actions, scope.gadget)
    gadget = scope.gadget
    lifted = {
        gadget.stack_node(buffer, height): gadget.top(buffer)
        for buffer in scope.own_buffers
        for height in range(1, gadget.height + 1)
    }
    layers = tuple(tuple(lifted.get(node, node) for node in layer) for layer in motion.layers)
    return PebbleMotion(gadget, motion.blocks, layers, motion.active)


class _Renaming:
    """Replays a plan with other buffers: a block's own one, else any that is free.

    Only where buffers are interchangeable; no aggregating action names one then.
    """

    def __init__(self, problem: Problem, scope: Scope) -> None:
        instance = problem.instance
        self._scope = scope
        self._own = dict(zip(scope.instance.blocks, scope.own_buffer, strict=True))
        self._law, self._state = problem.law, State.start_of(instance)
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
                    renamed.append(action)
            self._law.apply(self._state, action)
        return renamed

    def _pick(self, block: str, source: str) -> Pick:
        pile = self._state.piles.get(source)
        if pile is None:
            return Pick(block, source)
        if source in self._buffers and len(pile) == 1 and source not in self._used:
            self._name.pop(source, None)
        return Pick(block, self._at.pop(block))

    def _place(self, block: str, target: str) -> Place:
        if target not in self._state.piles:
            return Place(block, target)
        own = self._own[block]
        if target in self._buffers and target not in self._used and own is not None:
            name = own
        else:
            name = self._name.get(target) or self._free_buffer()
            self._name[target] = name
        self._at[block] = name
        return Place(block, name)

    def _free_buffer(self) -> str:
        taken = set(self._name.values())
        return next(buffer for buffer in self._scope.instance.buffers if buffer not in taken)
