"""What the robot must not touch: boxes with names, as arrays, and what it carries."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smash.motion.poses import ToolPose

FIXTURE = None
"""The name of a box that never moves, the table say: any string may be a block's name."""


@dataclass(frozen=True, slots=True)
class CarrierBody:
    """What a box of a carrier is called in a scene: a block may have the carrier's name."""

    name: str


BodyName = str | CarrierBody | None
"""A block's name, a carrier's, or `FIXTURE`."""


def in_words(name: BodyName) -> str:
    """The body of this name, for messages."""
    match name:
        case str():
            return f"block {name!r}"
        case CarrierBody(carrier):
            return f"carrier {carrier!r}"
    return "the table"


@dataclass(frozen=True, eq=False)
class Scene:
    """Oriented boxes in the world.

    Attributes:
        names: Whose box each is, length N; a carrier has several.
        centres: Box centres [m], shape (N, 3).
        half_extents: Half side lengths [m], shape (N, 3).
        rotations: Box axes as columns, shape (N, 3, 3).
    """

    names: tuple[BodyName, ...]
    centres: NDArray[np.float64]
    half_extents: NDArray[np.float64]
    rotations: NDArray[np.float64]

    @staticmethod
    def of_boxes(
        names: Sequence[BodyName],
        centres: ArrayLike,
        half_extents: ArrayLike,
        rotations: ArrayLike | None = None,
    ) -> Scene:
        """Build a scene; without `rotations` the boxes stand along the world's axes.

        Args:
            names: Length N.
            centres: [m], shape (N, 3).
            half_extents: [m], shape (N, 3), or (3,) or a number for boxes that are all alike.
            rotations: Shape (N, 3, 3).
        """
        count = len(names)
        middle = np.array(centres, dtype=np.float64).reshape(count, 3)
        half = np.broadcast_to(np.asarray(half_extents, dtype=np.float64), (count, 3)).copy()
        axes = np.tile(np.eye(3), (count, 1, 1)) if rotations is None else np.array(rotations, dtype=np.float64)
        return Scene(tuple(names), middle, half, axes.reshape(count, 3, 3))

    def with_table(self, half_size: float = 1.5, thickness: float = 0.1) -> Scene:
        """The scene and a table whose top is z = 0, reaching `half_size` [m] to every side."""
        table = Scene.of_boxes([FIXTURE], [[0.0, 0.0, -thickness / 2]], [half_size, half_size, thickness / 2])
        return self.joined(table)

    def joined(self, other: Scene) -> Scene:
        """Both scenes' boxes."""
        return Scene(
            self.names + other.names,
            np.concatenate([self.centres, other.centres]),
            np.concatenate([self.half_extents, other.half_extents]),
            np.concatenate([self.rotations, other.rotations]),
        )

    def only(self, index: int) -> Scene:
        """The scene of one of its boxes."""
        one = slice(index, index + 1)
        return Scene(self.names[one], self.centres[one], self.half_extents[one], self.rotations[one])

    def none(self) -> Scene:
        """The scene without a box."""
        return Scene((), self.centres[:0], self.half_extents[:0], self.rotations[:0])

    def without(self, names: Iterable[BodyName]) -> Scene:
        """The scene less the boxes of these names (toppled blocks, the block to grasp, a carrier)."""
        left_out = set(names)
        return self._kept([name is FIXTURE or name not in left_out for name in self.names])

    def only_of(self, names: Iterable[BodyName]) -> Scene:
        """The boxes of these names."""
        wanted = set(names)
        return self._kept([name in wanted for name in self.names])

    def _kept(self, which: Sequence[bool]) -> Scene:
        keep = np.array(which, dtype=bool)
        kept_names = tuple(name for name, kept in zip(self.names, keep, strict=True) if kept)
        return Scene(kept_names, self.centres[keep], self.half_extents[keep], self.rotations[keep])


@dataclass(frozen=True, eq=False)
class Attached:
    """What the fingers hold, and what stands on it: boxes fixed in the tool frame.

    Attributes:
        half_extents: [m], shape (K, 3).
        translations: Box centres in the tool frame [m], shape (K, 3).
        rotations: Box axes in the tool frame as columns, shape (K, 3, 3).
    """

    half_extents: NDArray[np.float64]
    translations: NDArray[np.float64]
    rotations: NDArray[np.float64]

    @staticmethod
    def cube(side: float) -> Attached:
        """A cube of `side` [m] held at its centre, its faces along the tool's axes."""
        return Attached(np.full((1, 3), side / 2), np.zeros((1, 3)), np.eye(3)[None])

    @staticmethod
    def of_scene(bodies: Scene, tool: ToolPose) -> Attached:
        """The boxes of a scene as they are when the tool is at `tool`."""
        turned = tool.rotation.T
        return Attached(bodies.half_extents, (bodies.centres - tool.position) @ turned.T, turned @ bodies.rotations)


@dataclass(frozen=True, eq=False)
class HandState:
    """What is fixed at the end of the arm during one motion.

    Attributes:
        opening: Travel of each finger from the middle [m], 0 (closed) to the hand's own `opening`.
        attached: What the hand holds, or nothing.
    """

    opening: float = 0.0
    attached: Attached | None = None
