"""Tree search between configurations: OMPL's RRTConnect, its simplifier, and our checker behind its interfaces.

Repeatable: OMPL draws from generators that are seeded, when they are made, from one sequence per process. The sequence
is set to the query's seed before a query, and everything that draws is made for that query alone, so a query's answer
depends on its arguments and its seed and not on what ran before. Nothing stops by the clock: searches end after a
number of iterations, shortcuts after a number of tries.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from ompl import base, geometric, util

from smash.motion.collision import CollisionChecker
from smash.motion.poses import Vector

ITERATIONS = 6000
"""Samples after which a search gives up."""
RANGE = 1.0
"""Longest new edge of a tree [rad]."""
SHORTCUT_TRIES = 20

util.setLogLevel(util.LogLevel.LOG_NONE)


class _Validity(base.StateValidityChecker):  # type: ignore[misc]
    """OMPL's question about one state."""

    def __init__(self, information: Any, checker: CollisionChecker) -> None:
        super().__init__(information)
        self._checker = checker

    def isValid(self, state: Any) -> bool:  # noqa: N802 (OMPL's name)
        return self._checker.free(_joints(state, self._checker))


class _Motion(base.MotionValidator):  # type: ignore[misc]
    """OMPL's question about one straight edge."""

    def __init__(self, information: Any, checker: CollisionChecker) -> None:
        super().__init__(information)
        self._checker = checker

    def checkMotion(self, begin: Any, end: Any) -> bool:  # noqa: N802 (OMPL's name)
        return self._checker.segment_free(_joints(begin, self._checker), _joints(end, self._checker))


def connect(
    start: Vector, goals: NDArray[np.float64], checker: CollisionChecker, seed: int
) -> NDArray[np.float64] | None:
    """A collision-free polyline from `start` to one of `goals`, simplified, or None where the search gave up.

    Args:
        start: A free configuration [rad], shape (n,).
        goals: Free configurations [rad], shape (G, n).
        checker: Decides what is free.
        seed: At least 1.

    Returns:
        Waypoints [rad], shape (W, n).
    """
    util.RNG.setSeed(seed)
    robot = checker.robot
    space = base.RealVectorStateSpace(robot.count)
    bounds = base.RealVectorBounds(robot.count)
    for joint in range(robot.count):
        bounds.setLow(joint, float(robot.lower[joint]))
        bounds.setHigh(joint, float(robot.upper[joint]))
    space.setBounds(bounds)
    information = base.SpaceInformation(space)
    # OMPL keeps no reference to objects made in Python: these two must outlive the search.
    validity, motion = _Validity(information, checker), _Motion(information, checker)
    information.setStateValidityChecker(validity)
    information.setMotionValidator(motion)
    information.setup()

    problem = base.ProblemDefinition(information)
    problem.addStartState(_state(space, start))
    goal_states = base.GoalStates(information)
    for goal in goals:
        goal_states.addState(_state(space, goal))
    problem.setGoal(goal_states)
    planner = geometric.RRTConnect(information)
    planner.setRange(RANGE)
    planner.setProblemDefinition(problem)
    planner.setup()
    status = planner.solve(base.PlannerTerminationCondition(_Countdown(ITERATIONS)))
    # A status is true for approximate solutions too.
    if status != base.PlannerStatus.EXACT_SOLUTION:
        return None
    path = problem.getSolutionPath()
    simplifier = geometric.PathSimplifier(information)
    simplifier.reduceVertices(path, SHORTCUT_TRIES, SHORTCUT_TRIES)
    simplifier.partialShortcutPath(path, SHORTCUT_TRIES, SHORTCUT_TRIES // 2)
    simplifier.reduceVertices(path, SHORTCUT_TRIES, SHORTCUT_TRIES)
    return np.array([_joints(state, checker) for state in path.getStates()])


class _Countdown:
    """A termination condition that counts its questions."""

    def __init__(self, count: int) -> None:
        self._left = count

    def __call__(self) -> bool:
        self._left -= 1
        return self._left < 0


def _joints(state: Any, checker: CollisionChecker) -> NDArray[np.float64]:
    return np.array([state[joint] for joint in range(checker.robot.count)])


def _state(space: Any, joints: Vector) -> Any:
    state = space.allocState()
    for joint, angle in enumerate(joints):
        state[joint] = float(angle)
    return state
