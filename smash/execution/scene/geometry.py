"""Where things are: slots and stations, blocks and carriers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from smash.execution.scene.area import Area
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.tabletop import Slot


@dataclass
class Geometry:
    """Where things are: what the law's state means on the table.

    Attributes:
        slots: The slot of every location.
        stations: The slot of every station.
        blocks: Poses of the blocks, as far as they are known.
        carriers: Poses of the carriers.
        areas: Where the other blocks may be: those that were toppled before anybody saw where they landed.
        unsure: Blocks that will have been put down by then on a face that nobody knows yet, or turned either way:
            known is where, and how high at most.
    """

    slots: Mapping[str, Slot]
    stations: Mapping[str, Slot] = field(default_factory=dict)
    blocks: dict[str, BlockPose] = field(default_factory=dict)
    carriers: dict[str, BlockPose] = field(default_factory=dict)
    areas: tuple[Area, ...] = ()
    unsure: set[str] = field(default_factory=set)

    def seen(self, blocks: Mapping[str, BlockPose], carriers: Mapping[str, BlockPose]) -> Geometry:
        """The same table with these poses."""
        return Geometry(self.slots, self.stations, dict(blocks), dict(carriers))

    def point(self, place: str) -> tuple[float, float]:
        """World x, y of a location, a carrier or a station [m]."""
        if place in self.carriers:
            x, y = self.carriers[place].position[:2]
            return float(x), float(y)
        slot = self.slots.get(place) or self.stations[place]
        return slot.x, slot.y
