"""From a legal plan to a pebble motion: the paper's claim "Feasible Monotone-Transformed Topple", as a function."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from smash.gadget.graph import Gadget, NodeKind
from smash.gadget.library import gadget_of
from smash.gadget.motion import PebbleMotion
from smash.gadget.schedule import Event, Scheduler, TableVisit
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
    tracks: dict[str, list[tuple[int, int]]] = {block: [] for block in instance.blocks}
    for location, events in schedule.events.items():
        for layer, block, height in _chain(gadget.height, instance.start[location], events):
            tracks[block].append((layer, gadget.stack_node(location, height)))
    for pebble, block in enumerate(instance.blocks, start=1):
        for visit in schedule.visits.get(block, []):
            tracks[block].extend(_table(gadget, pebble, visit))
    return PebbleMotion(gadget, instance.blocks, _layers([sorted(tracks[block]) for block in instance.blocks]))


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
    from the top node; every block moves by at most one height a step, and heights keep their order.
    """
    order = list(start)
    height = {block: index for index, block in enumerate(order, start=1)}
    at = {event.step: event for event in events}
    leaves = {event.block: event.step for event in events if not event.push}
    last = max(at, default=-1)
    layer = 0
    yield from ((0, block, height[block]) for block in order)
    while layer <= last or any(height[block] != index for index, block in enumerate(order, start=1)):
        event = at.get(layer)
        if event is not None and not event.push:
            order.remove(event.block)
        size = len(order) + (event is not None and event.push)
        for index, block in enumerate(order, start=1):
            wanted = top - size + index if leaves.get(block, -1) > layer else index
            height[block] += (wanted > height[block]) - (wanted < height[block])
        if event is not None and event.push:
            order.append(event.block)
            height[event.block] = top
        layer += 1
        yield from ((layer, block, height[block]) for block in order)


def _table(gadget: Gadget, pebble: int, visit: TableVisit) -> Iterator[tuple[int, int]]:
    """Yield (layer, node) of a block's way through the table region; pebble k is picked through v_T^k."""
    arrived = 0
    if visit.staged is not None and visit.toppled is not None:
        yield visit.staged + 1, gadget.node(NodeKind.TOPPLE, visit.location)
        arrived = visit.toppled + 1
    yield arrived, gadget.node(NodeKind.TABLE)
    if visit.picked is not None:
        yield visit.picked, gadget.node(NodeKind.INTERFACE, index=pebble)
