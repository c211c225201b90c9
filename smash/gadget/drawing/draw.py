"""`draw`: one picture of an instance, or of a plan for it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from smash.gadget.drawing.pebbles import motion_figure, write_animation
from smash.gadget.drawing.piles import instance_figure
from smash.gadget.drawing.style import STILLS, check_suffix, save
from smash.gadget.encode import encode
from smash.gadget.library import gadget_of
from smash.gadget.motion import PebbleMotion
from smash.problem.errors import RefusedPlan, SmashError
from smash.problem.extras import require
from smash.problem.files.given import GivenInstance, GivenPlan, given_instance, given_plan
from smash.problem.model import Action, Instance
from smash.problem.plan import Plan
from smash.problem.rules import Law

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOVING = ".gif"


def draw(instance: GivenInstance, plan: GivenPlan | None = None, path: str | os.PathLike[str] | None = None) -> Figure:
    """Draw an instance (start and goal), or a plan as pebbles that move on the gadget of the instance.

    Example:
        `smash.draw(instance)`, `smash.draw(instance, plan, "plan.pdf")`, `smash.draw(instance, plan, "plan.gif")`.

    Args:
        instance: an instance, or the path of an instance file.
        plan: a plan, the path of a plan file, or a list of actions; None draws the instance.
        path: file to write, .png, .pdf or .svg; of a plan also .gif, which moves.

    Returns:
        The figure of matplotlib; of a plan the strip of its frames, whatever was written.

    Raises:
        SmashError: where matplotlib is not installed (the extra `analysis`), the suffix is another one, the file cannot
            be written, or there is no legal plan to draw.
    """
    require("draw", "matplotlib")
    problem, file = given_instance(instance), None if path is None else Path(path)
    if file is not None:
        check_suffix(file, STILLS if plan is None else (*STILLS, MOVING))
    if plan is None:
        figure = instance_figure(problem)
        if file is not None:
            save(figure, file)
        return figure
    shown, motion = motion_of(problem, given_plan(plan, problem))
    if file is not None:
        write_motion(motion, shown, file)
    return motion_figure(motion, shown)


def motion_of(instance: Instance, plan: Plan) -> tuple[Instance, PebbleMotion]:
    """Return a plan as pebbles on the gadget, and the instance without the buffers that hold nothing at any time.

    Raises:
        SmashError: where there is no plan, it is for another instance, or the law refuses a step.
    """
    if plan.actions is None:
        raise SmashError(f"there is no plan to draw: its status is {plan.status}")
    if plan.instance != instance.name:
        raise RefusedPlan(f"the plan is for instance {plan.instance!r}, not {instance.name!r}")
    shown = _without_idle_buffers(instance, plan.actions)
    return shown, encode(shown, plan.actions, gadget_of(shown, plan.options))


def write_motion(motion: PebbleMotion, instance: Instance, path: Path) -> None:
    """Write a motion of `instance`: animated where the suffix is .gif, else a strip of frames (PNG, PDF, SVG).

    Raises:
        SmashError: where the suffix is none of these or the file cannot be written.
    """
    require("draw", "matplotlib")
    check_suffix(path, (*STILLS, MOVING))
    if path.suffix.lower() == MOVING:
        write_animation(motion, instance, path)
    else:
        save(motion_figure(motion, instance), path)


def _without_idle_buffers(problem: Instance, actions: Sequence[Action]) -> Instance:
    """Return the problem without the buffers that hold nothing at any time, so that a picture shows what matters."""
    used = {location for state in Law(problem).states(actions) for location, pile in state.piles.items() if pile}
    kept = tuple(buffer for buffer in problem.buffers if buffer in used)
    start = {location: pile for location, pile in problem.start.items() if location in (*problem.stacks, *kept)}
    return replace(problem, buffers=kept, start=start)
