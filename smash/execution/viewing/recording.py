"""What an episode looked like: poses of all bodies over time, taken while it runs, for replays, films and pictures."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from smash.execution.physics.world import World
from smash.execution.scene.block_pose import BlockPose, quaternion_of

INTERVAL = 0.08
"""Simulated time between two frames [s]."""


@dataclass
class Recording:
    """Frames of one episode; give `take` to the executor as `on_frame`.

    Attributes:
        names: Of the blocks.
        times: [s], one per frame.
        joints: Arm and finger joints per frame, shape (n + 2,) [rad, m].
        links: Position and quaternion of links 1 to n, hand and fingers per frame, shape (n + 3, 7) [m].
        blocks: Position and quaternion (x, y, z, w) of the blocks per frame, shape (B, 7) [m].
        trays: The same of the carriers, shape (C, 7).
        touched: The blocks that arm or hand touch, by their places in that order, per frame.
    """

    names: list[str] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    joints: list[NDArray[np.float64]] = field(default_factory=list)
    links: list[NDArray[np.float64]] = field(default_factory=list)
    blocks: list[NDArray[np.float64]] = field(default_factory=list)
    trays: list[NDArray[np.float64]] = field(default_factory=list)
    touched: list[list[int]] = field(default_factory=list)

    def take(self, world: World) -> None:
        """Add the present frame, if the last one is old enough."""
        if self.times and world.time - self.times[-1] < 0.9 * INTERVAL:
            return
        self.times.append(world.time)
        self.joints.append(np.concatenate([world.joints(), world.fingers()]))
        self.links.append(world.links())
        poses = world.poses()
        self.names = list(poses)
        places = {block: place for place, block in enumerate(poses)}
        self.blocks.append(_rows(poses.values()))
        self.touched.append(sorted({places[block] for block in world.in_contact()}))
        self.trays.append(_rows(world.carriers().values()))

    def at(self, moment: float) -> int:
        """Index of the last frame at or before `moment` [s]."""
        return max(0, int(np.searchsorted(self.times, moment + 1e-6)) - 1)

    def liveliest(self, begin: float, end: float) -> float:
        """Moment between two [s] at which the blocks move most; `begin` where nothing was recorded between them."""
        first, last = self.at(begin), self.at(end)
        if last <= first:
            return begin
        places = np.array(self.blocks[first : last + 1])[:, :, :3]
        moved = np.linalg.norm(np.diff(places, axis=0), axis=2).sum(axis=1)
        return self.times[first + 1 + int(moved.argmax())]


def _rows(poses: Iterable[BlockPose]) -> NDArray[np.float64]:
    return np.array([[*pose.position, *quaternion_of(pose.rotation)] for pose in poses]).reshape(-1, 7)
