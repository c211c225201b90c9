"""`smash draw-scene [SCENE]`: the table from above, to scale, and whether it keeps the paper's conditions."""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli import fail
from smash.cli.choices import robot_option
from smash.problem.extras import require
from smash.problem.files.documents import require_writable


@click.command("draw-scene")
@click.argument("scene", type=click.Path(path_type=Path), required=False)
@robot_option
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Picture (.png, .pdf, .svg).")
@click.option("--height", type=click.IntRange(1, 20), default=9, show_default=True, metavar="N", help="Full stacks.")
@click.option(
    "--buffer-height", type=click.IntRange(1, 20), default=4, show_default=True, metavar="N", help="Full buffers."
)
def command(scene: Path | None, robot: str | None, out: Path | None, height: int, buffer_height: int) -> None:
    """Draw a scene file (default: the built-in scene) and check the paper's two conditions; exit 3 where one fails.

    \b
    Example:
      smash draw-scene my-scene.toml --out scene.png
    """
    require("smash draw-scene", "pinocchio")
    from smash.execution.layout.conditions import violations
    from smash.execution.layout.drawing import draw
    from smash.execution.scene.scene_file import scene_of

    require_writable(out)
    tabletop = scene_of(scene, robot=robot)
    if out is not None:
        if out.suffix not in (".png", ".pdf", ".svg"):
            raise click.BadParameter("a picture's name ends in .png, .pdf or .svg", param_hint="--out")
        require("smash draw-scene --out", "matplotlib")
        draw(tabletop, out)
    found = violations(tabletop, height, buffer_height)
    for problem in found:
        click.echo(problem)
    if found:
        fail(f"scene {tabletop.name!r} breaks a condition in {len(found)} places", 3)
    piles = f"{height} blocks on stacks and {buffer_height} on buffers"
    click.echo(f"scene {tabletop.name!r} keeps both conditions for piles of up to {piles}")
