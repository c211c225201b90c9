"""The table: where stacks and buffers stand, how large the blocks are, where a topple sends them.

World frame: the robot's base at the origin, the table top at z = 0. A *slot* is the place of one stack location. Its
frame (the stack's frame of the paper's pre-smash pose) has x radially outward and y counter-clockwise around the base.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from hashlib import sha256
from math import cos, fsum, hypot, pi, sin

from smash.execution.scene.block_pose import QUARTER, BlockPose
from smash.execution.scene.block_size import BlockSize, unfit
from smash.execution.scene.tray import Tray
from smash.motion.robot import Hand
from smash.motion.robots import DEFAULT_ROBOT, load_robot
from smash.problem.errors import SmashError
from smash.problem.model import Instance, OnGoal

DIRECTIONS: Mapping[str, float] = {
    "counter-clockwise": pi / 2,
    "clockwise": -pi / 2,
    "outward": 0.0,
    "inward": pi,
}
"""Topple directions along the axes of a slot's frame: name -> angle from the slot's x axis [rad]."""

SLOWEST = 0.01
"""The least share of the arm's limits that motions may use: an episode would take an hour of simulated time."""

WAY_OUT = "; `smash layout INSTANCE PLAN --out SCENE.toml` looks for a scene that fits"

CUBE = 0.045
"""Side of the cubes that pushes were measured with [m]."""


class DoesNotFit(SmashError):
    """An instance that the scene has no room for."""


@dataclass(frozen=True, slots=True)
class Slot:
    """The place of one stack location on the table.

    Attributes:
        radius: Distance from the robot's base [m].
        angle: Bearing, also the direction of the frame's x axis [rad].
        directions: Names of the directions it may be toppled in, preferred first; none at a buffer.
        highest: The most blocks of a pile that the layout was made for; None where it says nothing of it.
        falling: The most blocks that its strips were made for, the same.
    """

    radius: float
    angle: float
    directions: tuple[str, ...] = ()
    highest: int | None = field(default=None, repr=False)
    falling: int | None = field(default=None, repr=False)

    @property
    def x(self) -> float:
        """World x [m]."""
        return self.radius * cos(self.angle)

    @property
    def y(self) -> float:
        """World y [m]."""
        return self.radius * sin(self.angle)

    def heading(self, direction: str) -> float:
        """World yaw of a topple direction [rad]."""
        return self.angle + DIRECTIONS[direction]

    def distance(self, x: float, y: float) -> float:
        """Horizontal distance of a point from the slot's middle [m]."""
        return hypot(x - self.x, y - self.y)

    def point(self, along: float, aside: float, direction: str) -> tuple[float, float]:
        """World x, y of a point `along` [m] a topple direction and `aside` [m] to its left."""
        yaw = self.heading(direction)
        return (
            self.x + along * cos(yaw) - aside * sin(yaw),
            self.y + along * sin(yaw) + aside * cos(yaw),
        )

    def coordinates(self, x: float, y: float, direction: str) -> tuple[float, float]:
        """Inverse of `point`: how far along and aside a world point lies [m]."""
        yaw = self.heading(direction)
        dx, dy = x - self.x, y - self.y
        return dx * cos(yaw) + dy * sin(yaw), -dx * sin(yaw) + dy * cos(yaw)


@dataclass(frozen=True, slots=True)
class Friction:
    """Coulomb coefficients; at a contact those of the two bodies multiply."""

    block: float = 0.45
    table: float = 0.9
    finger: float = 1.0


@dataclass(frozen=True, slots=True)
class Noise:
    """What an episode does not know exactly (`smash.execution.scene.noise` draws it); nothing where all are 0.

    Attributes:
        pose: Of a block's seen place, along each axis, anew at every look: standard deviation [m].
        yaw: Of its seen yaw, anew at every look: standard deviation [rad].
        camera: Of all seen places alike, along x and y, once an episode: standard deviation [m].
        placement: Of where a block stands, at the start and where the hand puts it down: standard deviation along x
            and y [m].
        friction: Of the coefficients of each block, the table and the fingers: standard deviation, share of them.
        mass: Of each block's mass: standard deviation, share of it.
        size: Tolerance of each block's edges: so much larger or smaller at most, all alike, evenly spread [m].
    """

    pose: float = 0.0
    yaw: float = 0.0
    camera: float = 0.0
    placement: float = 0.0
    friction: float = 0.0
    mass: float = 0.0
    size: float = 0.0

    @property
    def sees(self) -> bool:
        """Whether what is seen is wrong."""
        return bool(self.pose or self.yaw or self.camera)


@dataclass(frozen=True, slots=True)
class Tabletop:
    """A scene as its file describes it.

    Attributes:
        name: What the scene is called in records.
        side: Side of a block, which is a cube, or its footprint where it is none [m].
        mass: Mass of a block [kg].
        friction: Friction coefficients.
        velocity: Share of the arm's velocity limits that motions use.
        acceleration: Share of its acceleration limits.
        stacks: Slots of `stacks` locations, each with its topple directions.
        buffers: Slots of buffers.
        tray: What carriers are; none in a scene without stations.
        stations: Slots that trays can stand at, their length across the bearing.
        noise: What an episode does not know exactly.
        engine: What simulates it where nothing else is named; no part of the fingerprint.
        robot: Name or file of the robot that stands at it, None for the default one.
        height: Height of a block that is no cube [m].
        sizes: The blocks that are of another size, by name.
    """

    name: str
    side: float
    mass: float
    friction: Friction
    velocity: float
    acceleration: float
    stacks: tuple[Slot, ...]
    buffers: tuple[Slot, ...]
    tray: Tray | None = None
    stations: tuple[Slot, ...] = ()
    noise: Noise = field(default=Noise(), repr=False)
    engine: str | None = field(default=None, repr=False)
    robot: str | None = field(default=None, repr=False)
    height: float | None = field(default=None, repr=False)
    sizes: Mapping[str, BlockSize] = field(default_factory=dict, repr=False, hash=False)

    @property
    def block(self) -> BlockSize:
        """The size of every block that has none of its own."""
        return BlockSize(self.side, self.side if self.height is None else self.height, self.mass)

    def size(self, block: str) -> BlockSize:
        """The size of a block."""
        return self.sizes.get(block) or self.block

    @property
    def uniform(self) -> bool:
        """Whether all blocks are cubes of one size."""
        return self.height is None and not self.sizes

    @property
    def widest(self) -> float:
        """The greatest footprint of a block [m]."""
        return max(size.footprint for size in (self.block, *self.sizes.values()))

    @property
    def longest(self) -> float:
        """The longest edge of a block [m]."""
        return max(size.longest for size in (self.block, *self.sizes.values()))

    @property
    def cube(self) -> float:
        """Side of the cubes that a pile is counted in where a push asks how high it is [m]."""
        return self.side if self.uniform else CUBE

    def greatest_heap(self, count: int) -> list[BlockSize]:
        """Return the sizes of the highest pile of so many blocks, the highest block first.

        Of a size that stands in the scene by name there is one block, of the other size as many as are wanted.
        """
        known = [*self.sizes.values(), *[self.block] * count]
        return sorted(known, key=lambda size: -size.height)[:count]

    @property
    def slots(self) -> tuple[Slot, ...]:
        """All slots, stacks first."""
        return self.stacks + self.buffers

    @property
    def fingerprint(self) -> str:
        """Eight characters that tell this scene from others, whatever they are called."""
        noise = "" if self.noise == Noise() else repr(self.noise)
        robot = load_robot(self.robot).label
        other = "" if robot == DEFAULT_ROBOT else robot
        sizes = "" if self.uniform else repr((self.height, sorted(self.sizes.items())))
        return sha256(f"{self!r}{noise}{other}{sizes}".encode()).hexdigest()[:8]

    def with_robot(self, robot: str) -> Tabletop:
        """The same table with another robot, which has a name or a file.

        Raises:
            DoesNotFit: where its hand cannot hold a block of the scene.
            SmashError: where there is none of that name, or its file is malformed.
        """
        self.require_held(load_robot(robot).hand)
        tray = None if self.tray is None else replace(self.tray, robot=robot)
        return replace(self, robot=robot, tray=tray)

    def require_held(self, hand: Hand) -> None:
        """Refuse a hand that cannot hold every block of the scene, whatever edges the format allows.

        Raises:
            DoesNotFit: with the block, and what the hand has room for.
        """
        for block, size in {"": self.block, **self.sizes}.items():
            if why := unfit(size, hand):
                named = f"block {block!r}" if block in self.sizes else "a block"
                raise DoesNotFit(f"hand {hand.name!r} does not hold {named} of scene {self.name!r}: {why}")

    @property
    def highest(self) -> int:
        """The most blocks of a pile that the arm can work on from above, whichever they are."""
        return int(load_robot(self.robot).tallest / self.longest + 1e-9)

    def tall(self, blocks: Sequence[str]) -> float:
        """How high a pile of these blocks is at most, on whichever of their faces they lie [m]."""
        if self.uniform:
            return len(blocks) * self.side
        return fsum(self.size(block).longest for block in blocks)

    def room(self, slot: Slot) -> int:
        """The most blocks of a pile at a slot, whichever: as the arm reaches there, and as the layout was made for."""
        reached = int(load_robot(self.robot).highest(slot.radius) / self.longest + 1e-9)
        return reached if slot.highest is None else min(reached, slot.highest)

    def has_room(self, slot: Slot, pile: Sequence[str]) -> bool:
        """Whether the arm reaches this pile at a slot, and the layout was made for so many blocks there."""
        made_for = slot.highest is None or len(pile) <= slot.highest
        return made_for and self.reaches(slot, self.tall(pile))

    def reaches(self, slot: Slot, height: float) -> bool:
        """Whether the arm works from above on what is so high [m] at a slot."""
        return height <= load_robot(self.robot).highest(slot.radius) + 1e-9

    def strangers(self, instance: Instance) -> list[str]:
        """The blocks that the scene gives a size and the instance has not."""
        return [block for block in self.sizes if block not in instance.blocks]

    def bind(self, instance: Instance) -> dict[str, Slot]:
        """Give every location of `instance` its slot, in order.

        How high piles get is a question of the plan: `smash.execution.scene.piles.misfits` answers it.

        Raises:
            DoesNotFit: where the instance has more stacks, buffers or stations, or larger carriers, than the scene has
                room for.
        """
        cells = 0 if self.tray is None else self.tray.capacity
        for what, wanted, room in (
            ("stacks", len(instance.stacks), len(self.stacks)),
            ("buffers", len(instance.buffers), len(self.buffers)),
            ("stations", len(stations_of(instance)), len(self.stations)),
            ("places on a carrier", max((c.capacity for c in instance.carriers), default=0), cells),
        ):
            if wanted > room:
                raise DoesNotFit(
                    f"instance {instance.name!r} has {wanted} {what}; scene {self.name!r} has room for {room}"
                    + (self._way_out(instance) if what in ("stacks", "buffers") else "")
                )
        return {
            **dict(zip(instance.stacks, self.stacks, strict=False)),
            **dict(zip(instance.buffers, self.buffers, strict=False)),
        }

    def _way_out(self, instance: Instance) -> str:
        """Say what makes a scene that fits, or how a problem without places of its own is imported for this one."""
        piles = sum(bool(pile) for pile in instance.start.values())
        if not isinstance(instance.goal, OnGoal) or piles > len(self.stacks) + len(self.buffers):
            return WAY_OUT
        flags = f"--stacks {len(self.stacks)} --buffers {len(self.buffers)}"
        return f"; an `on` goal names no place, and `smash import-blocks … {flags}` makes an instance that fits"

    def bind_stations(self, instance: Instance) -> dict[str, Slot]:
        """Give every station of the carriers of an instance that `bind` has accepted its slot, in order."""
        return dict(zip(stations_of(instance), self.stations, strict=False))

    def tray_at(self, station: Slot) -> BlockPose:
        """The pose of a tray that stands at a station: its length across the bearing."""
        assert self.tray is not None, "a scene without a tray is bound to no instance with carriers"
        return self.tray.at(station.x, station.y, station.angle + QUARTER)


def stations_of(instance: Instance) -> tuple[str, ...]:
    """The stations of all carriers, in the instance's order, each once."""
    return tuple(dict.fromkeys(station for carrier in instance.carriers for station in carrier.stations))
