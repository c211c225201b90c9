"""What the flow model of an instance has to hold: its pebbles, where each may be, where each must end.

Four things are left out because some optimal plan does without them (each is independent of the time index):

- a block of the correct bottom part of its goal pile never moves: take its moves out of a plan, and what the others do
  stays legal, ends alike and costs no more, whatever the actions and their costs;
- buffers that start empty are first used in their order (they are interchangeable). Not where distances cost, nor
  where several blocks are put on a pile at once, whose actions name them;
- buffers beyond the number of moving blocks stay empty, and where that many start empty, each block has
  one of its own, in which nothing buries it (buffers are interchangeable). Not where distances cost, for there they
  differ, nor where several blocks are put on a pile at once;
- from where nothing can bury it (the table region, a buffer of its own) a block moves to its goal pile alone,
  and from the table region to no buffer of its own. (`on` goals excepted: any location may serve them.) Not where
  several blocks are put on a pile at once, for it may have to be among them, nor where distances cost and a carrier
  takes it along for less. With distances alone the direct way is the cheapest: rounding gains less than a pick and a
  place cost.

All v_T^i are joined to the same nodes; pebble k is picked through v_T^k.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property

from smash.gadget import EdgeKind, Gadget, NodeKind, gadget_of
from smash.gadget.motion import settled
from smash.gadget.parts.registry import parts_of
from smash.problem.model import Instance, OnGoal, PlanOptions, PositionsGoal, StacksGoal, State, no_goal
from smash.problem.problem import Problem


@dataclass(frozen=True)
class Scope:
    """The pebbles of a flow model and what each may use.

    Attributes:
        instance: the problem, without idle buffers.
        gadget: its gadget.
        moving: numbers of the pebbles that may move, in order.
        start: the node of every pebble at the start.
        goal: per pebble its goal node, or None where the goal does not name its position.
        own_buffer: per pebble its own buffer, or None.
        direct: whether a block moves from where nothing can bury it to its goal pile alone.
        alike: the empty buffers that are first used in this order.
    """

    instance: Instance
    gadget: Gadget
    moving: tuple[int, ...]
    start: tuple[int, ...]
    goal: tuple[int | None, ...]
    own_buffer: tuple[str | None, ...]
    direct: bool = True
    alike: tuple[str, ...] = ()

    @property
    def blocks(self) -> int:
        """Number of blocks; the pebbles from this number on are the tokens."""
        return len(self.instance.blocks)

    @property
    def pebbles(self) -> tuple[int, ...]:
        """Numbers of the pebbles that may move, then of the tokens."""
        return (*self.moving, *range(self.blocks, self.blocks + len(self.gadget.tokens)))

    def goal_of(self, pebble: int) -> int | None:
        """Return the node at which a pebble has to be at the end, or None."""
        return self.goal[pebble] if pebble < self.blocks else None

    @cached_property
    def fixed_nodes(self) -> frozenset[int]:
        """Nodes of the blocks that never move."""
        moving = set(self.pebbles)
        return frozenset(node for pebble, node in enumerate(self.start) if pebble not in moving)

    @cached_property
    def own_buffers(self) -> frozenset[str]:
        """The buffers that belong to one block each."""
        return frozenset(buffer for buffer in self.own_buffer if buffer is not None)

    def edges_of(self, pebble: int) -> list[int]:
        """Return the numbers of the edges that a pebble may take."""
        return [number for number in range(len(self.gadget.edges)) if self._may_take(pebble, number)]

    def final_nodes(self, pebble: int) -> frozenset[int]:
        """Return the nodes at which a pebble may be at the end."""
        if pebble >= self.blocks:
            return frozenset(self.gadget.tokens[pebble - self.blocks].nodes.values())
        goal = self.instance.goal
        at = self.goal[pebble]
        if at is not None:
            return frozenset((at,))
        resting = {
            number for number, node in enumerate(self.gadget.nodes) if not node.kind.transient
        } - self.fixed_nodes
        if not isinstance(goal, OnGoal):
            return frozenset(resting)
        block = self.instance.blocks[pebble]
        if block in goal.on or block in goal.on.values() or block in goal.bottom:
            resting = {number for number in resting if self.gadget.nodes[number].kind is NodeKind.STACK}
        if block in goal.on:
            resting = {number for number in resting if self.gadget.nodes[number].key.index > 1}
        if block in goal.bottom:
            resting = {number for number in resting if self.gadget.nodes[number].key.index == 1}
        return frozenset(resting)

    def _may_take(self, pebble: int, number: int) -> bool:
        edge = self.gadget.edges[number]
        if pebble >= self.blocks:
            active = self.gadget.activations.get(number)
            return active is not None and self.gadget.aggregates[active].token == pebble - self.blocks
        tail, head = self.gadget.nodes[edge.tail], self.gadget.nodes[edge.head]
        if edge.tail in self.fixed_nodes or edge.head in self.fixed_nodes:
            return False
        for node in (tail, head):
            if node.kind is NodeKind.INTERFACE and node.key.index != pebble + 1:
                return False
            if node.location in self.own_buffers and (
                node.location != self.own_buffer[pebble] or edge.kind is EdgeKind.CHAIN
            ):
                return False
        if not self.direct:
            return True
        unburied = edge.kind is EdgeKind.RETURN or tail.location in self.own_buffers
        if edge.kind is EdgeKind.CHAIN or not unburied or tail.kind is NodeKind.TABLE:
            return True
        at = self.goal[pebble]
        return at is not None and head.location == self.gadget.nodes[at].location


def scope_of(problem: Problem) -> Scope:
    """Return the scope of a problem, whose start must not be its goal."""
    instance, options = problem.posed, problem.options
    correct = correct_blocks(instance)
    moving = tuple(number for number, block in enumerate(instance.blocks) if block not in correct)
    several, distances = can_stack_several(instance, options), bool(instance.costs.travel)
    own: tuple[str | None, ...] = (None,) * len(instance.blocks)
    alike: tuple[str, ...] = ()
    if not several and not distances:
        instance, own = _needed_buffers(instance, moving)
        alike = tuple(at for at in instance.buffers if not instance.start[at] and at not in own)
    gadget = gadget_of(instance, options)
    goal = goal_positions(instance)
    return Scope(
        instance=instance,
        gadget=gadget,
        moving=moving,
        start=settled(gadget, instance.blocks, State.start_of(instance)),
        goal=tuple(gadget.stack_node(*goal[block]) if block in goal else None for block in instance.blocks),
        own_buffer=own,
        direct=not (isinstance(instance.goal, OnGoal) or several or (distances and gadget.tokens)),
        alike=alike,
    )


def can_stack_several(instance: Instance, options: PlanOptions) -> bool:
    """Return whether some aggregating action of the instance puts several blocks on a pile at once."""
    return any(part.stacks_several for part in parts_of(instance, options))


def goal_positions(instance: Instance) -> dict[str, tuple[str, int]]:
    """Return the (location, height) of the blocks whose position the goal names."""
    match instance.goal:
        case StacksGoal(stacks):
            return {
                block: (location, height)
                for location, pile in stacks.items()
                for height, block in enumerate(pile, start=1)
            }
        case PositionsGoal(positions):
            return dict(positions)
        case OnGoal():
            return {}
        case _:
            no_goal(instance.goal)


def correct_blocks(instance: Instance) -> frozenset[str]:
    """Return the blocks of the correct bottom parts of the goal's piles."""
    goal = goal_positions(instance)
    correct: set[str] = set()
    for location, pile in instance.start.items():
        for height, block in enumerate(pile, start=1):
            if goal.get(block) != (location, height):
                break
            correct.add(block)
    return frozenset(correct)


def _needed_buffers(instance: Instance, moving: Collection[int]) -> tuple[Instance, tuple[str | None, ...]]:
    """Drop idle buffers; give each moving block one of its own where that many start empty."""
    count = len(instance.blocks)
    used = [buffer for buffer in instance.buffers if instance.start[buffer]]
    empty = [buffer for buffer in instance.buffers if not instance.start[buffer]][: len(moving)]
    kept = tuple(buffer for buffer in instance.buffers if buffer in {*used, *empty})
    start = {location: instance.start[location] for location in (*instance.stacks, *kept)}
    own: list[str | None] = [None] * count
    if len(empty) == len(moving) and not isinstance(instance.goal, OnGoal):
        for pebble, buffer in zip(moving, empty, strict=True):
            own[pebble] = buffer
    return replace(instance, buffers=kept, start=start), tuple(own)
