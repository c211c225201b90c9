"""What an episode looked like: poses of all bodies over time, taken while it runs, for replays, films and pictures."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from smash.execution.physics.world import ARM, FINGERS, World

LINKS = (*ARM, 8, *FINGERS)
"""PyBullet's numbers of the links that are drawn: arm, hand, fingers (the base stands still)."""
INTERVAL = 0.08
"""Simulated time between two frames [s]."""


@dataclass
class Recording:
    """Frames of one episode; give `take` to the executor as `on_frame`.

    Attributes:
        times: [s], one per frame.
        joints: Arm and finger joints per frame, shape (9,) [rad, m].
        links: Position and quaternion of the links of `LINKS` per frame, shape (10, 7) [m].
        blocks: Position and quaternion (x, y, z, w) of the blocks per frame, shape (B, 7) [m].
        trays: The same of the carriers, shape (C, 7).
    """

    times: list[float] = field(default_factory=list)
    joints: list[NDArray[np.float64]] = field(default_factory=list)
    links: list[NDArray[np.float64]] = field(default_factory=list)
    blocks: list[NDArray[np.float64]] = field(default_factory=list)
    trays: list[NDArray[np.float64]] = field(default_factory=list)

    def take(self, world: World) -> None:
        """Add the present frame, if the last one is old enough."""
        if self.times and world.time - self.times[-1] < 0.9 * INTERVAL:
            return
        client = world.client
        states = client.getLinkStates(world.robot, LINKS, computeForwardKinematics=True)
        self.times.append(world.time)
        self.joints.append(np.array([state[0] for state in client.getJointStates(world.robot, (*ARM, *FINGERS))]))
        self.links.append(np.array([[*state[4], *state[5]] for state in states]))
        self.blocks.append(_poses(client, world.bodies.values()))
        self.trays.append(_poses(client, world.trays.values()))

    def at(self, moment: float) -> int:
        """Index of the last frame at or before `moment` [s]."""
        return max(0, int(np.searchsorted(self.times, moment + 1e-6)) - 1)


def _poses(client: Any, bodies: Iterable[int]) -> NDArray[np.float64]:
    poses = [client.getBasePositionAndOrientation(body) for body in bodies]
    return np.array([[*position, *turn] for position, turn in poses]).reshape(-1, 7)
