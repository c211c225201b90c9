"""`smash draw`: pictures of gadgets, instances and plans."""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli.choices import without_option
from smash.problem.errors import SmashError
from smash.problem.extras import require
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import read_plan
from smash.problem.model import PlanOptions
from smash.problem.words import counted

OUT = click.option(
    "--out",
    type=click.Path(path_type=Path, dir_okay=False),
    required=True,
    help="Picture to write; its suffix says the kind.",
)


@click.group("draw")
def command() -> None:
    """Draw a gadget, an instance, or a plan as pebbles on its gadget.

    \b
    Examples:
      smash draw gadget --stacks 3 --height 4 --out gadget.pdf
      smash draw instance examples/figure1.json --out figure1.png
      smash draw plan examples/figure1.json plan.json --out plan.gif
    """


@command.command("gadget")
@click.argument("instance", type=click.Path(path_type=Path), required=False)
@click.option("--stacks", type=click.IntRange(min=1), default=3, show_default=True, metavar="S", help="Stacks.")
@click.option("--buffers", type=click.IntRange(min=0), default=0, show_default=True, metavar="B", help="Buffers.")
@click.option("--height", type=click.IntRange(min=1), default=4, show_default=True, metavar="L", help="Blocks.")
@click.option("--max-topple", type=click.IntRange(min=1), metavar="M", help="At most M blocks in one topple.")
@click.option("--no-topple", is_flag=True, help="The pick-and-place gadget.")
@without_option
@click.option("--literal", is_flag=True, help="The definitions as the paper prints them.")
@OUT
def draw_gadget_command(
    instance: Path | None,
    stacks: int,
    buffers: int,
    height: int,
    max_topple: int | None,
    no_topple: bool,
    without: tuple[str, ...],
    literal: bool,
    out: Path,
) -> None:
    """Draw the gadget of INSTANCE, or of the given size (.png, .pdf, .svg)."""
    require("smash draw", "matplotlib")
    from smash.gadget.drawing.figure import gadget_figure
    from smash.gadget.drawing.style import check_suffix, save
    from smash.gadget.library import gadget_of, pick_and_place_gadget, smash_gadget

    check_suffix(out)
    options = PlanOptions(not no_topple, max_topple, without=without)
    problem = read_instance(instance) if instance is not None else None
    if problem is not None and not literal:
        gadget = gadget_of(problem, options)
    else:
        stack_names = tuple(f"s{number}" for number in range(1, stacks + 1))
        locations = (*stack_names, *(f"u{number}" for number in range(1, buffers + 1)))
        if problem is not None:
            stack_names, locations, height = problem.stacks, problem.locations, len(problem.blocks)
        if no_topple:
            gadget = pick_and_place_gadget(locations, height, literal=literal)
        else:
            gadget = smash_gadget(locations, height, stacks=stack_names, max_topple=max_topple, literal=literal)
    save(gadget_figure(gadget), out)
    click.echo(f"{out}: {len(gadget.nodes)} nodes, {len(gadget.edges)} edges")


@command.command("instance")
@click.argument("instance", type=click.Path(path_type=Path))
@OUT
def draw_instance_command(instance: Path, out: Path) -> None:
    """Draw the start and the goal of INSTANCE (.png, .pdf, .svg)."""
    from smash.gadget.drawing.draw import draw

    draw(instance, path=out)
    click.echo(str(out))


@command.command("plan")
@click.argument("instance", type=click.Path(path_type=Path))
@click.argument("plan", type=click.Path(path_type=Path))
@OUT
def draw_plan_command(instance: Path, plan: Path, out: Path) -> None:
    """Draw PLAN as pebbles that move on the gadget of INSTANCE: .gif moves, .png, .pdf and .svg show frames."""
    from smash.gadget.drawing.draw import motion_of, write_motion

    problem, filed = read_instance(instance), read_plan(plan)
    if filed.actions is None:
        raise SmashError(f"{plan}: the file holds no plan (status {filed.status})")
    shown, motion = motion_of(problem, filed)
    write_motion(motion, shown, out)
    click.echo(f"{out}: {counted(motion.steps, 'step')}, cost {motion.cost}")
