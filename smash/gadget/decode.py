"""From a pebble motion to actions (the paper's GetActions): drop auxiliary moves, linearise simultaneous ones."""

from __future__ import annotations

from smash.gadget.motion import PebbleMotion
from smash.problem.model import TABLE, Action, Pick, Place, State
from smash.problem.rules import Law


def decode(motion: PebbleMotion, law: Law) -> tuple[Action, ...]:
    """Return the actions of a motion that starts in the start state of the law's instance.

    Moves of one step touch different locations and carriers (`motion_fault` says so), hence any order of them is
    legal; an activation comes first, then transfers in the order of the pebbles.

    Raises:
        IllegalAction: where the motion breaks the rules so that the law refuses an action.
    """
    state = State.start_of(law.instance)
    actions: list[Action] = []
    for step in range(motion.steps):
        for action in step_actions(motion, step, state):
            law.apply(state, action)
            actions.append(action)
    return tuple(actions)


def step_actions(motion: PebbleMotion, step: int, state: State) -> list[Action]:
    """Return the actions of one step, in the state before it."""
    gadget, active = motion.gadget, motion.active_in(step)
    gathered: list[str] = []
    transfers: list[Action] = []
    for pebble, number in motion.moves(step):
        edge = gadget.edges[number]
        if number in gadget.activations:
            gathered += motion.blocks[pebble : pebble + 1]
        elif edge.kind.picks:
            block, source = motion.blocks[pebble], gadget.nodes[edge.tail].location
            target = gadget.nodes[edge.head].location
            assert target is not None
            transfers += [Pick(block, TABLE if source is None else source), Place(block, target)]
    if active is None:
        return transfers
    aggregate = gadget.aggregates[active]
    return [gadget.parts[aggregate.part].action(aggregate, gathered, state), *transfers]
