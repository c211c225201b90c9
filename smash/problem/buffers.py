"""The same problem with more or fewer buffers."""

from __future__ import annotations

import itertools
from dataclasses import replace

from smash.problem.errors import MalformedFile
from smash.problem.files.checking import checked
from smash.problem.making import fresh_names
from smash.problem.model import TABLE, Instance


def with_buffers(instance: Instance, count: int) -> Instance:
    """Return the instance with `count` buffers: those that hold blocks stay, empty ones go or come (`u1`, `u2`, …).

    Raises:
        MalformedFile: where more buffers hold blocks at the start, or distances cost and a new buffer stands nowhere.
    """
    held = [buffer for buffer in instance.buffers if instance.start[buffer]]
    if len(held) > count:
        raise MalformedFile(instance.name, f"{len(held)} buffers hold blocks at the start; {count} are too few")
    empty = [buffer for buffer in instance.buffers if not instance.start[buffer]][: count - len(held)]
    kept = [buffer for buffer in instance.buffers if buffer in held or buffer in empty]
    fresh = itertools.islice(fresh_names("u", _taken(instance)), count - len(kept))
    buffers = (*kept, *fresh)
    start = {location: instance.start.get(location, ()) for location in (*instance.stacks, *buffers)}
    gone = set(instance.buffers).difference(buffers)
    positions = {place: at for place, at in instance.costs.positions.items() if place not in gone}
    costs = replace(instance.costs, positions=positions) if gone else instance.costs
    changed = replace(instance, buffers=buffers, start=start, costs=costs)
    return checked(changed, instance.name)


def _taken(instance: Instance) -> set[str]:
    """Return the names of all places and carriers of the instance."""
    taken = {TABLE, *instance.locations, *(carrier.name for carrier in instance.carriers)}
    return taken | {station for carrier in instance.carriers for station in carrier.stations}
