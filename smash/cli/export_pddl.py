"""`smash export-pddl INSTANCE`: an instance as PDDL, for any planner outside."""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli.choices import without_option
from smash.problem.errors import MalformedFile
from smash.problem.files.instances import read_instance
from smash.problem.model import PlanOptions


@click.command("export-pddl")
@click.argument("instance", type=click.Path(path_type=Path))
@click.option(
    "--encoding",
    default="chain",
    show_default=True,
    metavar="NAME",
    help="How a topple is told: `conditional` (one action), `chain` (STRIPS actions), or one that is registered; "
    "`pick-and-place` tells none, and no costs (with --no-topple).",
)
@click.option("--no-topple", is_flag=True, help="Pick and place only.")
@click.option("--max-topple", type=click.IntRange(min=1), metavar="M", help="At most M blocks in one topple (chain).")
@without_option
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    required=True,
    metavar="DIR",
    help="Directory for domain.pddl and problem.pddl; made where it is missing.",
)
def command(
    instance: Path, encoding: str, no_topple: bool, max_topple: int | None, without: tuple[str, ...], out: Path
) -> None:
    """Write INSTANCE as domain.pddl and problem.pddl.

    \b
    Examples:
      smash export-pddl instance.json --encoding chain --out my-pddl
      smash export-pddl instance.json --encoding conditional --out my-pddl
      smash export-pddl instance.json --encoding pick-and-place --no-topple --out my-pddl
      smash export-pddl scoop.json --without lift --out my-pddl
    """
    from smash_baselines.task import compile_instance

    options = PlanOptions(not no_topple, max_topple, without=without)
    task = compile_instance(read_instance(instance), options, encoding)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MalformedFile(str(out), f"cannot be made: {error.strerror}") from None
    for path in task.write(out):
        click.echo(path)
