"""`smash robot [NAME|FILE]`: list the robots, or check one and say what it is."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from smash.problem.errors import MalformedFile, SmashError
from smash.problem.extras import require
from smash.problem.files.documents import require_writable, write_text

if TYPE_CHECKING:
    from smash.motion.robot import Robot


@click.command("robot")
@click.argument("robot", metavar="[NAME|FILE]", required=False)
@click.option("--fit", is_flag=True, help="Cover its links with spheres: write the table that its file names.")
@click.option("--reach", is_flag=True, help="Measure how high a pile it handles at which distance: `[reach]`.")
@click.option("--urdf", type=click.Path(path_type=Path, dir_okay=False), help="Write arm and hand as one URDF.")
def command(robot: str | None, fit: bool, reach: bool, urdf: Path | None) -> None:
    """List the robots that come with the package, or check one of them or a robot file and say what it is.

    \b
    Examples:
      smash robot
      smash robot panda
      smash robot my-arm.toml --fit
      smash robot my-arm.toml --reach
      smash robot panda --urdf panda.urdf
    """
    require("smash robot", "pinocchio", "coal", "numba", "scipy")
    from smash.motion.robots import load_robot, robot_names

    if robot is None:
        if fit or reach or urdf is not None:
            raise click.UsageError("--fit, --reach and --urdf go with a robot")
        for name in robot_names():
            click.echo(_line(load_robot(name)))
        return
    require_writable(urdf)
    found = load_robot(robot)
    if fit:
        _fit(found)
    if urdf is not None:
        write_text(urdf, found.urdf)
    if reach:
        _measure(found)
        return
    _describe(found)


def _line(robot: Robot) -> str:
    return f"{robot.name}: {robot.count} joints, hand {robot.hand.name}, piles to {robot.tallest:.2f} m"


def _fit(robot: Robot) -> None:
    """Write the table of spheres.

    Raises:
        MalformedFile: where the file names none.
        SmashError: where the robot is shipped: everybody's episodes rest on its table.
    """
    from smash.motion.fit_spheres import fitted
    from smash.motion.robots import robot_names

    if robot.label in robot_names():
        raise SmashError(f"--fit: {robot.name!r} is shipped with its table; copy its files to fit them anew")
    if robot.spheres is None:
        raise MalformedFile(str(robot.path), "missing `arm.spheres`: the table to write, relative to this file")
    require_writable(robot.spheres)
    text = fitted(robot)
    write_text(robot.spheres, text)
    click.echo(f"{text.count(chr(10)) - 1} spheres in {robot.spheres}")


def _measure(robot: Robot) -> None:
    from smash.motion.reach import measured_reach

    pairs = ", ".join(f"[{radius:.2f}, {levels}]" for radius, levels in measured_reach(robot))
    click.echo(f"[reach]\nheights = [{pairs}]")


def _describe(robot: Robot) -> None:
    """Say what a robot is, with what is missing of it."""
    from smash.motion.collision import arm_model
    from smash.motion.hulls import HullChecker
    from smash.motion.obstacles import Scene

    click.echo(_line(robot))
    for name, lower, upper, velocity, force in zip(
        robot.joints, robot.lower, robot.upper, robot.velocity, robot.force, strict=True
    ):
        click.echo(f"  {name}: {lower:.3f} to {upper:.3f} rad, {velocity:g} rad/s, {force:g} N m")
    hand = robot.hand
    click.echo(f"  {hand.name}: each finger opens {hand.opening * 100:g} cm, pushes with {hand.force:g} N")
    model = arm_model(robot)
    pairs = len(model.base_pairs) + len(model.wrist_pairs)
    click.echo(f"  {len(model.spheres)} spheres, {pairs} pairs of links that can meet")
    touches = HullChecker(robot, Scene.of_boxes([], [], 0.0).with_table()).contact(robot.ready)
    if touches is not None:
        click.echo(f"  at its ready pose, {touches}")
    if not robot.upright:
        click.echo("  its first joint does not turn it about the vertical: it neither carries nor lifts")
