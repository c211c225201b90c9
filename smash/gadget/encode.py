"""From a legal plan to a pebble motion: the paper's claim "Feasible Monotone-Transformed Topple", as a function."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smash.gadget.graph import Gadget
from smash.gadget.library import gadget_of
from smash.gadget.motion import PebbleMotion
from smash.gadget.schedule import Event, Scheduler
from smash.problem.model import Action, Instance


def encode(instance: Instance, actions: Sequence[Action], gadget: Gadget | None = None) -> PebbleMotion:
    """Return a pebble motion that stands for a legal plan: same cost, same final state, settled at both ends.

    A block that is put back where it was just taken from moves nowhere, hence such a pair costs nothing here.

    Args:
        instance: the problem; its goal plays no part.
        actions: a plan that the law accepts step by step and that ends with the hand empty.
        gadget: the graph; the instance's own, where None.

    Raises:
        IllegalAction: where the plan is not legal.
    """
    gadget = gadget or gadget_of(instance)
    schedule = Scheduler(gadget, instance).run(actions)
    tracks = schedule.tracks
    for location, events in schedule.events.items():
        for layer, block, height in _chain(gadget.height, instance.start[location], events):
            tracks[block].append((layer, gadget.stack_node(location, height)))
    layers = _layers([*(sorted(set(tracks[block])) for block in instance.blocks), *schedule.tokens])
    active = tuple(schedule.active.get(step) for step in range(len(layers) - 1))
    return PebbleMotion(gadget, instance.blocks, layers, active)


def _layers(tracks: list[list[tuple[int, int]]]) -> tuple[tuple[int, ...], ...]:
    """Turn each pebble's (layer, node) entries, of which the last one holds for ever, into layers of nodes."""
    last = max((track[-1][0] for track in tracks), default=0)
    columns = []
    for track in tracks:
        nodes: list[int] = []
        for (layer, node), following in zip(track, [*(entry[0] for entry in track[1:]), last + 1], strict=True):
            nodes.extend([node] * (following - layer))
        columns.append(nodes)
    return tuple(zip(*columns, strict=True)) if columns else ((),)


def _chain(top: int, start: Sequence[str], events: list[Event]) -> Iterator[tuple[int, str, int]]:
    """Yield (layer, block, height) for the blocks of one location, while anything moves there.

    Blocks that never leave again head for their settled height, the others for their place in a pile that hangs
    from the top node, or sinks below it in time for those that come at once; every block moves by at most one height
    a step, and heights keep their order.
    """
    order = list(start)
    height = {block: index for index, block in enumerate(order, start=1)}
    at = {event.step: event for event in events}
    leaves = {block: event.step for event in events if not event.push for block in event.blocks}
    sinks = {
        event.step - early: len(event.blocks) - early
        for event in events
        if event.push
        for early in range(len(event.blocks))
    }
    last = max(at, default=-1)
    layer = 0
    while layer <= last or any(height[block] != index for index, block in enumerate(order, start=1)):
        event = at.get(layer)
        if event is not None and not event.push:
            del order[-len(event.blocks) :]
        ceiling = top - len(order) - sinks.get(layer, 0)
        for index, block in enumerate(order, start=1):
            wanted = ceiling + index if leaves.get(block, -1) > layer else index
            height[block] += (wanted > height[block]) - (wanted < height[block])
        if event is not None and event.push:
            order.extend(event.blocks)
            height |= {block: top - above for above, block in enumerate(reversed(event.blocks))}
        layer += 1
        yield from ((layer, block, height[block]) for block in order)
