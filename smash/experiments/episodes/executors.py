"""An executor for a plan: what an episode at the command line, from Python and of a sweep all begin with."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from smash.problem.errors import RefusedPlan
from smash.problem.model import Instance
from smash.problem.plan import Plan, check_plan

if TYPE_CHECKING:
    from smash.execution.executor import Executor
    from smash.execution.observer import Eyes
    from smash.execution.physics.world import Frame
    from smash.execution.recorded_poses import Look
    from smash.execution.scene.tabletop import Tabletop
    from smash.records.episodes import Performed

REPLAN_BUDGET = 30.0
"""Wall time of each replanning, where none is given [s]."""


def executor_of(
    instance: Instance,
    plan: Plan,
    *,
    seed: int = 0,
    replan: bool = True,
    scene: str | os.PathLike[str] | Tabletop | None = None,
    noise: str | None = None,
    pace: float | None = None,
    replanner: str | None = None,
    budget: float = REPLAN_BUDGET,
    engine: str | None = None,
    robot: str | os.PathLike[str] | None = None,
    observer: str | os.PathLike[str] | Eyes | None = None,
    looks: list[Look] | None = None,
    gui: bool = False,
    on_frame: Frame | None = None,
    on_step: Callable[[Performed], Any] | None = None,
) -> Executor:
    """Return an executor of a legal plan, to be run once.

    Args:
        instance: the problem.
        plan: a plan for it.
        seed: of the blocks' start poses, and for planners that draw.
        replan: whether to plan anew where an action cannot be done.
        scene: the path of a scene file, or a scene (None: the built-in one).
        noise: what is not known exactly, as in `pose=3mm,yaw=2deg` (None: what the scene says).
        pace: share of the arm's velocity and acceleration limits that motions use (None: what the scene says).
        replanner: planner to replan with (None: the plan's own); `greedy` where nobody is called so.
        budget: wall time of each replanning [s].
        engine: what simulates it (None: the scene's, else the one that is there).
        robot: name of a robot, or the path of its file (None: the scene's, else the Panda).
        observer: where the blocks are seen: the path of a `smash-poses/1` file, or what makes an observer (None: the
            simulator, with the scene's noise).
        looks: gets all that is seen.
        gui: show the engine's window.
        on_frame: called with the world 25 times a simulated second.
        on_step: called with each action before it is carried out.

    Raises:
        RefusedPlan: where the law refuses the plan.
        Unsupported: where the hand holds a block at the start, or the engine is not installed.
        SmashError: where the scene or the file of poses is malformed, or the scene has no place for the instance.
    """
    verdict = check_plan(instance, plan)
    if not verdict.accepted:
        raise RefusedPlan(f"the plan for {instance.name!r}: {verdict}")
    from smash.execution.executor import Executor
    from smash.execution.policy import OPEN
    from smash.execution.recorded_poses import witnessed
    from smash.execution.scene.scene_file import scene_of
    from smash.experiments.episodes.replanning import replanner as replanner_by

    eyes = _eyes_of(observer, instance)
    return Executor(
        instance,
        plan,
        scene_of(scene, noise, pace, robot),
        seed=seed,
        policy=None if replan else OPEN,
        replanner=replanner_by(replanner or plan.planner, budget, seed) if replan else None,
        eyes=eyes if looks is None else witnessed(eyes, looks),
        engine=engine,
        gui=gui,
        on_frame=on_frame,
        on_step=on_step,
    )


def _eyes_of(observer: str | os.PathLike[str] | Eyes | None, instance: Instance) -> Eyes:
    """Return what makes the observer that is meant."""
    from smash.execution.recorded_poses import recorded_eyes
    from smash.execution.sight import Sight

    if observer is None:
        return Sight
    return recorded_eyes(observer, instance) if isinstance(observer, str | os.PathLike) else observer
