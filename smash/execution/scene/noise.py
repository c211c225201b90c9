"""What an episode does not know exactly, and the draws of one: the `[noise]` of a scene, `--noise` of the commands.

Each kind has a random generator of its own, seeded by the episode's seed: one more kind changes nothing of the others,
and without noise an episode is what it was before there was any.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from math import degrees, radians

import numpy as np

from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.tabletop import Friction, Noise, Tabletop
from smash.motion.poses import Vector
from smash.problem.errors import SmashError
from smash.problem.model import Instance

LARGEST = 3.0
"""Errors of what is seen are cut off at so many standard deviations, ..."""
LARGEST_MADE = 2.0
"""... those of how things are made and put, at so many."""

_LENGTH = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
_ANGLE = {"deg": radians(1.0), "rad": 1.0}
_SHARE = {"%": 1e-2, "": 1.0}
UNITS: Mapping[str, Mapping[str, float]] = {
    "pose": _LENGTH,
    "yaw": _ANGLE,
    "camera": _LENGTH,
    "placement": _LENGTH,
    "friction": _SHARE,
    "mass": _SHARE,
    "size": _LENGTH,
}
"""The kinds, and the units that a text may give them in, with what they are worth."""
MOST = {
    "pose": 0.05,
    "yaw": radians(45.0),
    "camera": 0.05,
    "placement": 0.02,
    "friction": 0.5,
    "mass": 0.5,
    "size": 0.005,
}
"""The most that is allowed of each [m, rad, share]."""


def parse_noise(text: str, what: str = "noise") -> Noise:
    """Return the noise that a text names, as in `pose=3mm,yaw=2deg,friction=10%`.

    Args:
        text: kinds with their amounts, separated by commas; each amount has a unit.
        what: is said of in the refusal.

    Raises:
        SmashError: with one line that says what is allowed.
    """
    amounts: dict[str, float] = {}
    for word in text.split(","):
        kind, _, amount = (part.strip() for part in word.partition("="))
        if kind not in UNITS:
            raise SmashError(f"{what}: {word.strip()!r} is not allowed; KIND=AMOUNT of {', '.join(UNITS)}")
        if kind in amounts:
            raise SmashError(f"{what}: {kind!r} stands twice")
        found = re.fullmatch(r"(\d+\.?\d*|\.\d+)\s*([a-z%]*)", amount)
        if found is None or found[2] not in UNITS[kind]:
            units = " or ".join(unit or "no unit" for unit in UNITS[kind])
            raise SmashError(f"{what}: {kind}={amount!r} is not allowed; a number, 0 or more, in {units}")
        value = float(found[1]) * UNITS[kind][found[2]]
        # 7mm and 0.7cm are one amount.
        amounts[kind] = value if kind == "yaw" else float(f"{value:.12g}")
    return checked_noise(Noise(**amounts), what)


def checked_noise(noise: Noise, what: str = "noise") -> Noise:
    """Return the noise, unless an amount is out of its limits.

    Raises:
        SmashError: with one line that says what is allowed.
    """
    for kind, most in MOST.items():
        if not 0.0 <= getattr(noise, kind) <= most:
            raise SmashError(f"{what}: {noise_words(noise, kind)} is not allowed; 0 to {_amount(kind, most)}")
    return noise


def noise_words(noise: Noise, *kinds: str) -> str:
    """Return the noise as `parse_noise` reads it; of these kinds alone where some are named, else of those above 0."""
    chosen = kinds or tuple(field.name for field in fields(noise) if getattr(noise, field.name))
    return ",".join(f"{kind}={_amount(kind, getattr(noise, kind))}" for kind in chosen)


def _amount(kind: str, value: float) -> str:
    if UNITS[kind] is _LENGTH:
        return f"{value * 1e3:.6g}mm"
    return f"{degrees(value):.6g}deg" if UNITS[kind] is _ANGLE else f"{value * 100:.6g}%"


@dataclass(frozen=True, slots=True)
class Made:
    """One block as it is, which the executor is not told.

    Attributes:
        footprint: [m].
        height: [m].
        mass: [kg].
        friction: Its coefficient.
    """

    footprint: float
    height: float
    mass: float
    friction: float

    @property
    def half(self) -> list[float]:
        """Half of its edges [m], the height last."""
        return [self.footprint / 2, self.footprint / 2, self.height / 2]


def as_told(tabletop: Tabletop, block: str) -> Made:
    """One block as the scene says."""
    size = tabletop.size(block)
    return Made(size.footprint, size.height, size.mass, tabletop.friction.block)


class Chance:
    """What one episode draws.

    Args:
        tabletop: The scene, with its noise.
        instance: Whose blocks there are.
        seed: Of the episode.

    Attributes:
        noise: How much of each kind there is.
        made: Every block as it is; empty where all are as the scene says.
    """

    def __init__(self, tabletop: Tabletop, instance: Instance, seed: int) -> None:
        self.noise = tabletop.noise
        self._instance = instance
        self._tabletop = tabletop
        self._generators = {kind: np.random.default_rng([seed, number]) for number, kind in enumerate(UNITS, start=1)}
        self.made = self._make() if self.noise.friction or self.noise.mass or self.noise.size else {}

    def _make(self) -> dict[str, Made]:
        table, noise, count = self._tabletop, self.noise, len(self._instance.blocks)
        sizes = [table.size(block) for block in self._instance.blocks]
        larger = self._generators["size"].uniform(-noise.size, noise.size, count)
        footprints, heights = (np.array([size.edges[axis] for size in sizes]) + larger for axis in (0, 2))
        masses = np.array([size.mass for size in sizes]) * (1.0 + noise.mass * self._normal("mass", count))
        frictions = table.friction.block * (1.0 + noise.friction * self._normal("friction", count))
        rows = np.stack([footprints, heights, masses, np.maximum(frictions, 0.01)], axis=1).tolist()
        return {block: Made(*row) for block, row in zip(self._instance.blocks, rows, strict=True)}

    def scene(self) -> Tabletop:
        """The scene as it is: table and fingers have another friction too."""
        if not self.noise.friction:
            return self._tabletop
        table, finger = 1.0 + self.noise.friction * self._normal("friction", 2)
        friction = self._tabletop.friction
        drawn = Friction(friction.block, max(friction.table * table, 0.01), max(friction.finger * finger, 0.01))
        return replace(self._tabletop, friction=drawn)

    def at_start(self, poses: Mapping[str, BlockPose]) -> dict[str, BlockPose]:
        """Where the blocks stand at the start, beside where they should, and on blocks of another size."""
        found = dict(poses)
        for pile in (*self._instance.start.values(), *((block,) for block in self._instance.table)):
            below = 0.0
            for block in pile:
                pose = found[block]
                middle = pose.position + np.append(self.astray(), 0.0)
                if self.made:
                    middle[2] = below + self.made[block].height / 2
                    below += self.made[block].height
                found[block] = BlockPose(middle, pose.rotation)
        return found

    def astray(self) -> Vector:
        """How far off a block is put down, shape (2,) [m]."""
        if not self.noise.placement:
            return np.zeros(2)
        return self.noise.placement * self._normal("placement", 2)

    def glance(self, kind: str, count: int) -> Vector:
        """Errors of what is seen, in standard deviations, shape (count,)."""
        return np.clip(self._generators[kind].normal(size=count), -LARGEST, LARGEST)

    def _normal(self, kind: str, count: int) -> Vector:
        return np.clip(self._generators[kind].normal(size=count), -LARGEST_MADE, LARGEST_MADE)
