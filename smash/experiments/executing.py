"""`execute`: carry a plan out in simulation."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from smash.experiments.episodes.executors import executor_of
from smash.problem.arguments import text, whole_number
from smash.problem.errors import SmashError
from smash.problem.extras import EXECUTION, require, require_engine
from smash.problem.files.given import GivenInstance, GivenPlan, given_instance, given_plan

if TYPE_CHECKING:
    from smash.execution.observer import Eyes
    from smash.execution.scene.tabletop import Tabletop
    from smash.records.episodes import Episode


def execute(
    instance: GivenInstance,
    plan: GivenPlan,
    *,
    seed: int = 0,
    replan: bool = True,
    scene: str | os.PathLike[str] | Tabletop | None = None,
    noise: str | None = None,
    pace: float | None = None,
    engine: str | None = None,
    robot: str | os.PathLike[str] | None = None,
    observer: str | os.PathLike[str] | Eyes | None = None,
) -> Episode:
    """Carry a plan out in simulation and say how it went. A failed execution is no exception.

    Example:
        `smash.execute(instance, smash.plan(instance)).success`

    Args:
        instance: an instance, or the path of an instance file.
        plan: a plan, the path of a plan file, or a list of actions.
        seed: of the blocks' start poses.
        replan: plan anew from what is observed where an action cannot be done, with the plan's own planner (else
            `greedy`); False is the paper's open pipeline, where the first failure ends the episode.
        scene: the path of a scene file, or a scene (None: the built-in one).
        noise: what is not known exactly, as in `"pose=3mm,yaw=2deg,friction=10%"` (None: what the scene says).
        pace: share of the arm's velocity and acceleration limits that motions use (None: what the scene says).
        engine: `pybullet` or `mujoco` (None: the scene's, else PyBullet, else MuJoCo where that is what is installed).
        robot: the name of a robot that is shipped, or the path of a `smash-robot/1` file (None: the scene's, else
            `panda`).
        observer: where the blocks are seen: the path of a file of recorded poses (`smash-poses/1`), or what makes an
            observer, `smash.execution.observer.Eyes` (None: the simulator, with the scene's noise).

    Returns:
        The episode: `success`, `failure` (name, step, action, reason), `engine`, `robot`, times, and each action as
        it was performed.

    Raises:
        MissingExtra: where the extra `execution`, or the engine, is not installed.
        RefusedPlan: where the law refuses the plan.
        SmashError: where an argument is wrong, or the scene has no place for the instance.
    """
    require("execute", *EXECUTION)
    from smash.motion.robots import load_robot

    if engine is not None:
        require_engine(engine)
    if robot is not None and not isinstance(robot, str | os.PathLike):
        raise SmashError(f"robot: {robot!r} is not allowed; the name of a robot, or the path of its file")
    if robot is not None:
        load_robot(robot)
    whole_number("seed", seed, 0, 2**31 - 1)
    problem = given_instance(instance)
    if observer is not None and not (isinstance(observer, str | os.PathLike) or callable(observer)):
        raise SmashError(f"observer: {observer!r} is not allowed; the path of a file of poses, or a function")
    if noise is not None:
        text("noise", noise)
    if pace is not None and (isinstance(pace, bool) or not isinstance(pace, int | float)):
        raise SmashError(f"pace: {pace!r} is not allowed; a number of 0.01 to 1")
    made = given_plan(plan, problem)
    return executor_of(
        problem,
        made,
        seed=seed,
        replan=replan,
        scene=scene,
        noise=noise,
        pace=pace,
        engine=engine,
        robot=robot,
        observer=observer,
    ).run()
