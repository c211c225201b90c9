"""One timed motion of the arm, with all that is needed to judge it again in another scene."""

from __future__ import annotations

from dataclasses import dataclass

from smash.motion.collision import CollisionChecker
from smash.motion.obstacles import BodyName, HandState, Scene
from smash.motion.paths import Path
from smash.motion.robot import Robot
from smash.motion.timing import Trajectory


@dataclass(frozen=True, eq=False)
class Move:
    """One motion of the arm.

    Attributes:
        robot: Whose.
        path: Where.
        trajectory: When.
        hand: Fingers and what they hold meanwhile.
        ignored: Blocks and carriers that it may touch.
        margin: Distance that it was planned to keep [m].
    """

    robot: Robot
    path: Path
    trajectory: Trajectory
    hand: HandState
    ignored: frozenset[BodyName]
    margin: float

    @property
    def opening(self) -> float:
        """What the fingers are sent to [m]: shut where they hold a block."""
        return 0.0 if self.hand.attached is not None else self.hand.opening

    def free(self, scene: Scene, allowance: float) -> bool:
        """Whether the motion keeps its margin, less `allowance` [m], in another scene."""
        checker = CollisionChecker(self.robot, scene.without(self.ignored), self.hand, self.margin - allowance)
        return checker.path_free(self.path.waypoints)
