"""`python -m smash.experiments.studies.inverse_kinematics`: our inverse kinematics beside kept libraries, every robot.

Asked are the grasps of the default scene: its slots, three heights, four yaws. Each library gets what ours begins with
(ready, ready turned to the target's bearing, then random configurations), the same number of steps, the same
longest step and the same tolerance. `docs/decisions/0009-inverse-kinematics-of-our-own.md` holds what came out.

pink and mink (with qpsolvers and daqp) and pyroboplan are no packages of ours: what is not installed is left out.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib.util import find_spec
from time import process_time
from typing import Any, NamedTuple

import numpy as np
import pinocchio

from smash.execution.scene.scene_file import default_scene
from smash.motion.descent import LARGEST_STEP, TOLERANCE
from smash.motion.kinematics import ITERATIONS, RANDOM_SEEDS, inverse
from smash.motion.poses import ToolPose, Vector, top_down
from smash.motion.robot import Robot
from smash.motion.robots import load_robot, robot_names
from smash.motion.robots.composing import TOOL

Solver = Callable[[ToolPose], Vector | None]
HEIGHTS = (1, 5, 9)
"""Levels of the grasps."""
QUARTERS = 4
"""Yaws of the grasps."""
ALLOWED = 2 * TOLERANCE
"""Error of a solution that counts: [m] and [rad]."""
INSIDE = 1e-6
"""Libraries begin so far inside of the limits [rad]."""


class Row(NamedTuple):
    """What one solver made of one robot's poses: how many it reached of how many, and CPU time a pose [s]."""

    robot: str
    solver: str
    solved: int
    asked: int
    seconds: float


def poses() -> list[ToolPose]:
    """Return the grasps."""
    scene = default_scene()
    slots = [*scene.stacks, *scene.buffers]
    return [
        top_down((slot.x, slot.y, (height - 0.5) * scene.side), slot.angle + quarter * np.pi / 2)
        for slot in slots
        for height in HEIGHTS
        for quarter in range(QUARTERS)
    ]


def beginnings(robot: Robot, pose: ToolPose) -> Iterator[Vector]:
    """Yield the configurations that a library descends from [rad], each of shape (n,)."""
    yield robot.ready.copy()
    turned = robot.ready.copy()
    turned[0] += float(np.arctan2(pose.position[1], pose.position[0]))
    yield turned
    generator = np.random.default_rng(0)
    least, most = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    for _ in range(RANDOM_SEEDS):
        yield generator.uniform(least, most)


def with_ours(robot: Robot) -> Solver:
    """Return `smash.motion.kinematics`."""
    return lambda pose: next(iter(inverse(robot, pose)), None)


def with_pink(robot: Robot) -> Solver:
    """Return pink: a quadratic program a step, on pinocchio."""
    import pink
    from pink.limits import ConfigurationLimit
    from pink.tasks import FrameTask

    model = limited(robot)
    limits = [ConfigurationLimit(model)]

    def solve(pose: ToolPose) -> Vector | None:
        task = FrameTask(TOOL, position_cost=1.0, orientation_cost=1.0, lm_damping=1e-3)
        task.set_target(pinocchio.SE3(pose.rotation, pose.position))
        for start in beginnings(robot, pose):
            inside = np.clip(start, robot.lower + INSIDE, robot.upper - INSIDE)
            now = pink.Configuration(model, model.createData(), inside)
            for _ in range(ITERATIONS):
                if np.abs(task.compute_error(now)).max() < TOLERANCE:
                    return np.array(now.q)
                try:
                    step = pink.solve_ik(now, [task], 1.0, solver="daqp", limits=limits, damping=1e-8)
                except (pink.exceptions.PinkError, ValueError):
                    break
                now.integrate_inplace(shortened(step), 1.0)
        return None

    return solve


def with_mink(robot: Robot) -> Solver:
    """Return mink: the same on MuJoCo."""
    import mink
    import mujoco

    bare = re.sub(r"<collision>.*?</collision>", "", robot.urdf, flags=re.DOTALL)
    spec = mujoco.MjSpec.from_string(bare)
    spec.compiler.fusestatic = False
    for equality in list(spec.equalities):
        spec.delete(equality)
    model = spec.compile()
    model.jnt_range[: robot.count] = np.column_stack([robot.lower, robot.upper])
    limits = [mink.ConfigurationLimit(model)]

    def solve(pose: ToolPose) -> Vector | None:
        task = mink.FrameTask(TOOL, "body", position_cost=1.0, orientation_cost=1.0, lm_damping=1e-3)
        task.set_target(mink.SE3.from_matrix(pinocchio.SE3(pose.rotation, pose.position).homogeneous))
        for start in beginnings(robot, pose):
            now = mink.Configuration(model)
            now.update(np.concatenate([start, np.zeros(model.nq - robot.count)]))
            for _ in range(ITERATIONS):
                if np.abs(task.compute_error(now)).max() < TOLERANCE:
                    return np.array(now.q[: robot.count])
                try:
                    step = mink.solve_ik(now, [task], 1.0, solver="daqp", limits=limits, damping=1e-8)
                except mink.MinkError:
                    break
                now.integrate_inplace(shortened(step), 1.0)
        return None

    return solve


def with_pyroboplan(robot: Robot) -> Solver:
    """Return pyroboplan: damped least squares with restarts of its own, on pinocchio."""
    from pyroboplan.ik.differential_ik import DifferentialIk, DifferentialIkOptions

    options = DifferentialIkOptions(
        max_retries=RANDOM_SEEDS,
        max_translation_error=TOLERANCE,
        max_rotation_error=TOLERANCE,
        min_step_size=LARGEST_STEP,
        max_step_size=1.0,
        rng_seed=0,
    )
    solver = DifferentialIk(limited(robot), options=options)

    def solve(pose: ToolPose) -> Vector | None:
        found: Any = solver.solve(TOOL, pinocchio.SE3(pose.rotation, pose.position), init_state=robot.ready.copy())
        return None if found is None else np.array(found)

    return solve


SOLVERS: dict[str, Callable[[Robot], Solver]] = {
    "ours": with_ours,
    "pink": with_pink,
    "mink": with_mink,
    "pyroboplan": with_pyroboplan,
}


def limited(robot: Robot) -> Any:
    """Return pinocchio's model with the limits of the robot's file, which may be narrower than its URDF's."""
    model = robot.model.copy()
    model.lowerPositionLimit, model.upperPositionLimit = robot.lower, robot.upper
    return model


def shortened(step: Vector) -> Vector:
    """Return a step [rad], shape (n,), whose largest entry is at most `LARGEST_STEP`."""
    return np.asarray(step * min(1.0, LARGEST_STEP / max(float(np.abs(step).max()), 1e-12)))


def reaches(robot: Robot, joints: Vector | None, pose: ToolPose) -> bool:
    """Whether a solution is one: within the limits, the tool where it should be."""
    if joints is None or not robot.within_limits(joints, ALLOWED):
        return False
    there = robot.forward(joints)
    error = pinocchio.log6(
        pinocchio.SE3(there.rotation, there.position).actInv(pinocchio.SE3(pose.rotation, pose.position))
    )
    return bool(np.abs(error.vector).max() < ALLOWED)


def rows(robots: Iterable[str], solvers: Sequence[str]) -> Iterator[Row]:
    """Yield what each solver makes of each robot."""
    wanted = poses()
    for name in robots:
        robot = load_robot(name)
        for solver in solvers:
            solve = SOLVERS[solver](robot)
            solve(wanted[0])
            begun = process_time()
            found = [solve(pose) for pose in wanted]
            seconds = (process_time() - begun) / len(wanted)
            solved = sum(reaches(robot, joints, pose) for joints, pose in zip(found, wanted, strict=True))
            yield Row(name, solver, solved, len(wanted), seconds)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", action="append", help="Repeatable (default: those that are shipped).")
    given = parser.parse_args()
    print("| robot | solver | poses reached | CPU a pose [ms] |\n| --- | --- | ---: | ---: |")
    for row in rows(given.robot or robot_names(), [name for name in SOLVERS if name == "ours" or find_spec(name)]):
        shown = f"{row.solved} of {row.asked} | {1000 * row.seconds:.2f}"
        print(f"| {row.robot} | {row.solver} | {shown} |", flush=True)


if __name__ == "__main__":
    main()
