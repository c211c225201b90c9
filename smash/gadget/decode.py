"""From a pebble motion to actions (the paper's GetActions): drop auxiliary moves, linearise simultaneous ones."""

from __future__ import annotations

from collections import defaultdict

from smash.gadget.graph import Aggregate, EdgeKind
from smash.gadget.motion import PebbleMotion
from smash.problem.model import TABLE, Action, Instance, Pick, Place, PlanOptions, State
from smash.problem.rules import Law


def decode(motion: PebbleMotion, instance: Instance, options: PlanOptions | None = None) -> tuple[Action, ...]:
    """Return the actions of a motion that starts in the start state of `instance`.

    Moves of one step touch different locations (`motion_fault` says so), hence any order of them is legal; an
    activation comes first, then transfers in the order of the pebbles.

    Raises:
        IllegalAction: where the motion breaks the rules so that the law refuses an action.
    """
    law = Law(instance, options)
    state = State.start_of(instance)
    actions: list[Action] = []
    for step in range(motion.steps):
        for action in step_actions(motion, step, state):
            law.apply(state, action)
            actions.append(action)
    return tuple(actions)


def step_actions(motion: PebbleMotion, step: int, state: State) -> list[Action]:
    """Return the actions of one step, in the state before it."""
    gadget = motion.gadget
    gathered: dict[Aggregate, list[str]] = defaultdict(list)
    transfers: list[Action] = []
    for pebble, number in motion.moves(step):
        edge, block = gadget.edges[number], motion.blocks[pebble]
        if number in gadget.activations:
            gathered[gadget.activations[number]].append(block)
        elif edge.kind in (EdgeKind.TRANSFER, EdgeKind.RETURN):
            source, target = gadget.nodes[edge.tail].location, gadget.nodes[edge.head].location
            assert target is not None
            transfers += [Pick(block, TABLE if source is None else source), Place(block, target)]
    activations: list[Action] = []
    for aggregate, blocks in gathered.items():
        location = gadget.nodes[aggregate.gather].location
        assert location is not None
        activations.append(gadget.parts[aggregate.part].action(location, blocks, state))
    return activations + transfers
