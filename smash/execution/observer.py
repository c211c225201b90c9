"""What the executor asks where the blocks are: a public protocol, for eyes of your own.

The simulator is one observer (`smash.execution.sight.Sight`, with the scene's noise), a file of recorded poses another
(`smash.execution.recorded_poses.RecordedPoses`); a camera above a table would be a third. An observer is asked before
every action, and again for every gap task, whose motion is planned for what it says. `docs/robot.md` has an example.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Protocol

from smash.execution.physics.world import World
from smash.execution.scene.block_pose import BlockPose
from smash.execution.scene.noise import Chance


class Observer(Protocol):
    """Eyes on one table.

    Poses are in the frame of the robot's base: x ahead, y to the left, z upward from the table [m]. A block's position
    is its centre; a cube's 24 orientations are all the same to whoever asks, a box has its height along its z axis.
    """

    @property
    def exact(self) -> bool:
        """Whether everything is seen as it is: then one look is enough, and `spread` is not asked for."""

    def blocks(self) -> dict[str, BlockPose]:
        """Poses of all blocks of the instance by name, as far as they are known now; the one in the hand too."""

    def carriers(self) -> dict[str, BlockPose]:
        """Poses of all carriers by name: the middle of the board; none in scenes without carriers."""

    def spread(self, block: str) -> float:
        """How far a side of a block may be from where it is seen, a standard deviation [m]."""

    def forget(self, blocks: Iterable[str]) -> None:
        """Know nothing any more of blocks that were meant to move: what was seen of them before is out of date."""


Eyes = Callable[[World, Chance], Observer]
"""Makes an episode's observer, of its world (`time` is the clock) and of what the episode draws."""
