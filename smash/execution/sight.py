"""What the executor sees of the blocks: the simulator's poses, with the scene's noise in them.

Every look, which is a moment of simulated time, has errors of its own. A block that does not move is known better with
each look: its place is the mean of what was seen since it last moved.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import atan2, hypot, sqrt

import numpy as np

from smash.execution.physics.world import World
from smash.execution.readback import LARGEST_TILT
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.noise import Chance
from smash.motion.poses import Matrix, Vector, yaw_rotation

MEMORY = 12
"""A mean forgets what is older than about so many looks: a block may creep."""
SURPRISE = 4.0
"""Standard deviations off the mean from which on a block has moved ..."""
LEAST_SURPRISE = 0.0005
"""... if it is so far at least [m]."""


@dataclass
class _Known:
    """The mean of some looks at one block."""

    position: Vector
    rotation: Matrix
    turned: float = 0.0
    looks: int = 1


class Sight:
    """The eyes of one episode in simulation: an `Observer`.

    Args:
        world: What is looked at.
        chance: Draws the errors.
    """

    def __init__(self, world: World, chance: Chance) -> None:
        self._world = world
        self._chance = chance
        self._noise = chance.noise
        self._tabletop = world.tabletop
        self._seen: dict[str, _Known] = {}
        self._last = -1.0
        self._camera = np.append(self._noise.camera * chance.glance("camera", 2), 0.0)

    @property
    def exact(self) -> bool:
        """Whether everything is seen as it is."""
        return not self._noise.sees

    def blocks(self) -> dict[str, BlockPose]:
        """Poses of all blocks, as far as they are known now."""
        if self.exact:
            return self._world.poses()
        anew, self._last = self._world.time != self._last, self._world.time
        for block, pose in self._world.poses().items():
            if anew or block not in self._seen:
                self._look(block, pose)
        return self._told()

    def carriers(self) -> dict[str, BlockPose]:
        """Poses of all carriers, which are seen as they are."""
        return self._world.carriers()

    def spread(self, block: str) -> float:
        """How far a side of a block may be from where it is seen, a standard deviation [m]."""
        looks = self._seen[block].looks if block in self._seen else 1
        pose, yaw = self._noise.pose / sqrt(looks), self._noise.yaw / sqrt(looks)
        return hypot(pose, self._noise.camera, yaw * self._tabletop.size(block).footprint / 2)

    def forget(self, blocks: Iterable[str]) -> None:
        """Know nothing any more of blocks that were meant to move."""
        for block in blocks:
            self._seen.pop(block, None)

    def _look(self, block: str, pose: BlockPose) -> None:
        position = pose.position + self._camera + self._noise.pose * self._chance.glance("pose", 3)
        rotation = yaw_rotation(float(self._noise.yaw * self._chance.glance("yaw", 1)[0])) @ pose.rotation
        known = self._seen.get(block)
        if known is not None:
            turn = rotation @ known.rotation.T
            turned = atan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1])
            share = SURPRISE * sqrt(1 + 1 / known.looks)
            moved = np.abs(position - known.position).max() > max(share * self._noise.pose, LEAST_SURPRISE)
            tumbled = turn[2, 2] < np.cos(LARGEST_TILT)
            if not moved and not tumbled and abs(turned - known.turned) <= share * self._noise.yaw + 0.05:
                known.looks = min(known.looks + 1, MEMORY)
                known.position = known.position + (position - known.position) / known.looks
                known.turned += (turned - known.turned) / known.looks
                return
        self._seen[block] = _Known(position, rotation)

    def _told(self) -> dict[str, BlockPose]:
        """Poses of all blocks: how high something is that stands upright, on whatever it stands, is known."""
        told: dict[str, BlockPose] = {}
        means = {
            block: BlockPose(known.position, yaw_rotation(known.turned) @ known.rotation)
            for block, known in self._seen.items()
        }
        standing: list[str] = []
        for block in sorted(means, key=lambda block: float(means[block].position[2])):
            pose = means[block]
            middle = None if pose.tilt > LARGEST_TILT else self._middle(block, pose, [(b, told[b]) for b in standing])
            told[block] = pose if middle is None else BlockPose(np.append(pose.position[:2], middle), pose.rotation)
            if middle is not None:
                standing.append(block)
        return {block: told[block] for block in means}

    def _middle(self, block: str, pose: BlockPose, lower: Iterable[tuple[str, BlockPose]]) -> float | None:
        """How high the middle of an upright block is [m], on the ground or on a lower one; None: in the air."""
        ground, size = self._ground(pose.position), self._tabletop.size(block)
        height, seen = size.upright(pose), float(pose.position[2])
        if self._tabletop.uniform:
            level = round((seen - ground) / height - 0.5)
            return None if level < 0 else ground + (level + 0.5) * height
        tops = [ground]
        for other, stands in lower:
            below = self._tabletop.size(other)
            if hypot(*(pose.position - stands.position)[:2]) < (size.footprint + below.footprint) / 2:
                tops.append(float(stands.position[2]) + below.upright(stands) / 2)
        middle = min((top + height / 2 for top in tops), key=lambda known: abs(known - seen))
        return middle if abs(middle - seen) < height / 2 else None

    def _ground(self, place: Vector) -> float:
        """The height of what the lowest block at a place stands on [m]: the board of a tray, or the table."""
        tray = self._world.tabletop.tray
        for pose in self._world.carriers().values():
            assert tray is not None
            across = np.abs(pose.rotation.T @ (place - pose.position))
            if np.all(across[:2] < np.array(tray.size) / 2):
                return float(pose.position[2]) + tray.board / 2
        return 0.0
