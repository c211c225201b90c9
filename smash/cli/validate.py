"""`smash validate INSTANCE PLAN`: the law's verdict on a filed plan."""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli import fail
from smash.problem.files.given import check
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import read_plan


@click.command("validate")
@click.argument("instance", type=click.Path(path_type=Path))
@click.argument("plan", type=click.Path(path_type=Path))
def command(instance: Path, plan: Path) -> None:
    """Judge a plan by the law: exit 0 where it is accepted, 3 where it is refused (with the step and the reason).

    \b
    Example:
      smash validate examples/figure1.json plan.json
    """
    filed = read_plan(plan)
    problem = read_instance(instance)
    verdict = check(problem, filed)
    if not verdict.accepted:
        fail(f"{plan}: {verdict}", 3)
    costs, length = problem.costs, len(filed.actions or ())
    click.echo(
        f"accepted: {length} actions" if costs.plain else f"accepted: {length} actions, {filed.cost} {costs.unit}"
    )
