"""`smash validate INSTANCE PLAN`: the law's verdict on a filed plan."""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli import fail
from smash.cli.plan_files import of_pddl, read_plan_file
from smash.problem.files.instances import read_instance
from smash.problem.plan import check_plan


@click.command("validate")
@click.argument("instance", type=click.Path(path_type=Path))
@click.argument("plan", type=click.Path(path_type=Path))
@of_pddl
def command(instance: Path, plan: Path, problem: Path | None, domain: Path | None) -> None:
    """Judge a plan by the law: exit 0 where it is accepted, 3 where it is refused (with the step and the reason).

    PLAN is a plan file of the testbed, or the answer of a PDDL planner (`smash import-plan --help` says which).

    \b
    Examples:
      smash validate examples/figure1.json plan.json
      smash validate blocks-16-1.json sas_plan
      smash validate p01.json sas_plan --problem mystery/p01.pddl --domain mystery/domain.pddl
    """
    judged = read_instance(instance)
    filed = read_plan_file(plan, judged, problem, domain)
    verdict = check_plan(judged, filed.plan)
    if not verdict.accepted:
        fail(f"{plan}: {verdict}", 3)
    filed.say()
    click.echo(f"accepted: {filed.told(judged.costs)}")
