"""Motions between configurations and to tool poses, free of collisions.

A `MotionPlanner` tries the straight joint segment first, then a tree. `line` keeps the tool on a straight line
(approach, lift, topple push). Whatever is returned has been checked a second time, against the hulls of the robot's
meshes. Configurations are in rad, shape (n,); lengths in m.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from smash.motion.collision import CONTACT_MARGIN, DEFAULT_MARGIN, CollisionChecker
from smash.motion.errors import NoIk, NoMotion
from smash.motion.hulls import Contact, HullChecker
from smash.motion.kinematics import along_line
from smash.motion.obstacles import HandState, Scene
from smash.motion.paths import Path, densify, round_corners
from smash.motion.poses import Vector
from smash.motion.robot import Robot

LINE_STEP = 0.01
"""Tool poses along a line are this far apart [m]."""
HULL_STEP = 0.05
"""Between two checks of the hulls no joint moves further than this [rad]."""
HULL_TOLERANCE = 0.003
"""The hulls may enter a box by this much in motions that end in contact [m]."""
SEARCHES = 2
"""Tree searches, each with its own seed, before a query is given up."""


class MotionPlanner:
    """Plans motions of a robot among boxes.

    The same arguments and seed give the same path, bit for bit, whatever was planned before.

    Args:
        robot: The robot.
        margin: Distance to keep from the scene where no contact is meant [m].
        seed: Of all random choices, 0 or more.
        verify: Check every path against the hulls before it is returned.
    """

    def __init__(self, robot: Robot, *, margin: float = DEFAULT_MARGIN, seed: int = 0, verify: bool = True) -> None:
        self.robot = robot
        self.margin = margin
        self.seed = seed
        self.verify = verify

    def plan(
        self,
        start: Vector,
        goals: NDArray[np.float64],
        scene: Scene,
        *,
        hand: HandState | None = None,
        margin: float | None = None,
    ) -> Path:
        """A free path from `start` to one of `goals`: the nearest straight segment, else a tree's path.

        Args:
            start: [rad], shape (n,).
            goals: [rad], shape (n,) or (G, n).
            scene: What must not be touched; leave out what may be (`scene.without(names)`).
            hand: Finger opening and carried block; closed and empty by default.
            margin: Distance to keep [m], the planner's own by default.

        Raises:
            NoMotion: Start or all goals are in collision, or no path was found.
        """
        held = hand or HandState()
        checker = CollisionChecker(self.robot, scene, held, self.margin if margin is None else margin)
        begin = np.ascontiguousarray(start, dtype=np.float64)
        self._require_free(begin, checker, "the start")
        hulls = self._hulls(scene, held)
        ends = self._free_goals(np.atleast_2d(np.asarray(goals, dtype=np.float64)), begin, checker, hulls)
        for end in ends:
            if checker.segment_free(begin, end):
                straight = np.stack([begin, end])
                if self._contact(straight, hulls) is None:
                    return Path(straight, "straight")
        return self._tree_path(begin, ends, checker, hulls)

    def straight(
        self, start: Vector, end: Vector, scene: Scene, *, hand: HandState | None = None, margin: float | None = None
    ) -> Path:
        """The straight joint segment between two configurations [rad], shape (n,), and nothing else.

        Raises:
            NoMotion: Something is in the way, or a joint limit.
        """
        held = hand or HandState()
        checker = CollisionChecker(self.robot, scene, held, self.margin if margin is None else margin)
        waypoints = densify(np.stack([start, end]), HULL_STEP)
        if not self.robot.within_limits(waypoints):
            raise NoMotion("the way is beyond the joint limits")
        if not checker.segment_free(waypoints[0], waypoints[-1]):
            raise NoMotion(f"the way is blocked by {_blocked_by(waypoints, checker)}")
        contact = self._contact(waypoints, self._hulls(scene, held))
        if contact is not None:
            raise NoMotion(f"on the way, {contact}")
        return Path(waypoints, "straight")

    def line(
        self,
        start: Vector,
        displacement: ArrayLike,
        scene: Scene,
        *,
        hand: HandState | None = None,
        back: HandState | None = None,
        margin: float = CONTACT_MARGIN,
    ) -> Path:
        """Move the tool on a straight line, its orientation kept.

        Args:
            start: Where the line begins [rad], shape (n,).
            displacement: From there, in the world [m], shape (3,).
            scene: What must not be touched.
            hand: Finger opening and carried block.
            back: The same on the way back, where that is to be free too.
            margin: Distance to keep [m]; by default touching is allowed, as at the end of a placement.

        Raises:
            NoIk: The line leaves the arm's reach.
            NoMotion: Something is in the way.
        """
        held = hand or HandState()
        offset = np.asarray(displacement, dtype=np.float64)
        count = max(1, int(np.ceil(float(np.linalg.norm(offset)) / LINE_STEP)))
        rows = along_line(self.robot, start, [offset * step / count for step in range(1, count + 1)])
        if rows is None:
            raise NoIk(f"the tool cannot follow the line by {_say(offset)} from where it is")
        waypoints = np.stack([np.asarray(start, dtype=np.float64), *rows])
        for state in (held,) if back is None else (held, back):
            checker = CollisionChecker(self.robot, scene, state, margin)
            if not checker.path_free(waypoints):
                raise NoMotion(f"a line by {_say(offset)} is blocked by {_blocked_by(waypoints, checker)}")
        # Hand and fingers are boxes to both checkers: the hulls add what the arm does, which is the same both ways.
        loaded = back if back is not None and back.attached is not None else held
        contact = self._contact(waypoints, self._hulls(scene, loaded))
        if contact is not None:
            raise NoMotion(f"on a line by {_say(offset)}, {contact}")
        return Path(waypoints, "line")

    def _tree_path(
        self, begin: Vector, ends: NDArray[np.float64], checker: CollisionChecker, hulls: HullChecker | None
    ) -> Path:
        from smash.motion.rrtconnect import connect

        for search in range(SEARCHES):
            corners = connect(begin, ends, checker, 1 + SEARCHES * self.seed + search)
            if corners is None:
                continue
            waypoints = round_corners(corners, checker.path_free)
            if self._contact(waypoints, hulls) is None:
                return Path(waypoints, "tree")
        raise NoMotion(
            f"no path was found; the straight one is blocked by {_blocked_by(np.stack([begin, ends[0]]), checker)}"
        )

    def _free_goals(
        self, goals: NDArray[np.float64], begin: Vector, checker: CollisionChecker, hulls: HullChecker | None
    ) -> NDArray[np.float64]:
        """The goals that are free, nearest to `begin` first."""
        free = [goal for goal in goals if self.robot.within_limits(goal) and checker.free(goal)]
        if not free:
            self._require_free(np.ascontiguousarray(goals[0]), checker, "the goal")
        touching = [self._contact(goal[None], hulls) for goal in free]
        if all(touching):
            raise NoMotion(f"at the goal, {touching[0]}")
        free = [goal for goal, contact in zip(free, touching, strict=True) if contact is None]
        return np.stack(sorted(free, key=lambda goal: float(np.linalg.norm(goal - begin))))

    @staticmethod
    def _require_free(joints: Vector, checker: CollisionChecker, what: str) -> None:
        if not checker.robot.within_limits(joints):
            raise NoMotion(f"{what} is beyond the joint limits")
        if not checker.free(joints):
            close = ", ".join(checker.blockers(joints)) or "something"
            raise NoMotion(f"{what} is closer than {checker.margin * 1000:.0f} mm to {close}")

    def _hulls(self, scene: Scene, hand: HandState) -> HullChecker | None:
        return HullChecker(self.robot, scene, hand, HULL_TOLERANCE) if self.verify else None

    @staticmethod
    def _contact(waypoints: NDArray[np.float64], hulls: HullChecker | None) -> Contact | None:
        return None if hulls is None else hulls.contact(densify(waypoints, HULL_STEP))


def _blocked_by(waypoints: NDArray[np.float64], checker: CollisionChecker) -> str:
    """What stops the first blocked segment of a polyline [rad], shape (W, n)."""
    for begin, end in pairwise(waypoints):
        done = checker.segment_reach(begin, end)
        if done < 1.0:
            return ", ".join(checker.blockers(begin + done * (end - begin))) or "something"
    return "nothing"


def _say(offset: Vector) -> str:
    return "(" + ", ".join(f"{float(value) * 100:.1f}" for value in offset) + ") cm"
