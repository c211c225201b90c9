"""`smash layout INSTANCE [PLAN]`: find places and landing strips for an instance, or say why there are none."""

from __future__ import annotations

from math import degrees
from pathlib import Path

import click

from smash.cli.choices import robot_option
from smash.problem.errors import RefusedPlan
from smash.problem.extras import require
from smash.problem.files.documents import require_writable, write_text
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import read_plan
from smash.problem.model import PlanOptions
from smash.problem.plan import check_plan
from smash.problem.rules import Law


@click.command("layout")
@click.argument("instance", type=click.Path(path_type=Path))
@click.argument("plan", type=click.Path(path_type=Path), required=False)
@click.option("--no-topple", is_flag=True, help="No landing strips; with a PLAN, the plan says what it topples.")
@click.option("--max-topple", type=click.IntRange(1), metavar="M", help="No more than M blocks fall at once.")
@click.option("--height", type=click.IntRange(1), metavar="N", help="Piles on stacks (default: all blocks).")
@click.option("--buffer-height", type=click.IntRange(1), metavar="N", help="Piles on buffers (default: 4 at most).")
@click.option("--scene", type=click.Path(path_type=Path), help="Blocks, friction and speed (default: the built-in).")
@robot_option
@click.option("--attempts", type=click.IntRange(1), metavar="N", help="Arrangements that are tried (default: 60).")
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the search.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), required=True, help="Scene file (.toml).")
def command(
    instance: Path,
    plan: Path | None,
    no_topple: bool,
    max_topple: int | None,
    height: int | None,
    buffer_height: int | None,
    scene: Path | None,
    robot: str | None,
    attempts: int | None,
    seed: int,
    out: Path,
) -> None:
    """Find places for all stacks and buffers of INSTANCE, and a landing strip for each stack that may be toppled.

    With a PLAN, places are for its highest piles and strips for its topples. Without, for any plan: stacks of all
    blocks, toppled whole, unless --height, --no-topple or --max-topple say less. Exit 3 where no layout can exist, 4
    where none was found.

    \b
    Examples:
      smash layout examples/figure1.json plan.json --out scene.toml
      smash layout examples/figure1.json --height 6 --max-topple 4 --out scene.toml
      smash draw-scene scene.toml --out scene.png
      smash execute examples/figure1.json plan.json --scene scene.toml
    """
    require("smash layout", "pinocchio")
    if plan is not None and (no_topple or max_topple or height or buffer_height):
        raise click.UsageError("PLAN goes without --no-topple, --max-topple, --height and --buffer-height")
    if no_topple and max_topple:
        raise click.UsageError("--no-topple goes without --max-topple")
    if out.suffix != ".toml":
        raise click.BadParameter("a scene's name ends in .toml", param_hint="--out")
    require_writable(out)
    problem = read_instance(instance)
    options, actions = PlanOptions(not no_topple, max_topple), None
    if plan is not None:
        filed = read_plan(plan)
        verdict = check_plan(problem, filed)
        if not verdict.accepted:
            raise RefusedPlan(f"the plan for {problem.name!r}: {verdict}")
        options, actions = filed.options, filed.actions or ()
    from smash.execution.layout.laying import ATTEMPTS, Layout, lay_out
    from smash.execution.scene.scene_file import DEFAULT_SCENE, scene_document, scene_from_document, scene_of
    from smash.execution.scene.scene_writing import scene_toml, with_slots

    path = DEFAULT_SCENE if scene is None else scene
    document = scene_document(path)
    tabletop = scene_of(scene_from_document(document, str(path)), robot=robot)
    if tabletop.robot is not None:
        document["robot"] = tabletop.robot
    found: Layout = lay_out(
        Law(problem, options),
        tabletop,
        actions,
        height=height,
        buffer_height=buffer_height,
        attempts=attempts or ATTEMPTS,
        seed=seed,
    )
    slots = found.tabletop
    about = f"Places for {problem.name!r}, by `smash layout`; seed {seed}, attempt {found.attempts}."
    write_text(out, scene_toml(with_slots(document, out.stem, slots.stacks, slots.buffers), about))
    for place, slot in zip(found.places, slots.slots, strict=True):
        falls = f", {place.falling} fall {slot.directions[0]}" if place.falling else ""
        where = f"{100 * slot.radius:.0f} cm at {degrees(slot.angle):.0f} degrees"
        click.echo(f"{place.location}: {where}, {place.height} high{falls}")
    click.echo(f"{out}: {len(slots.stacks)} stacks, {len(slots.buffers)} buffers; both conditions hold")
