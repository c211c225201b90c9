"""`smash import-plan INSTANCE PLAN`: a plan of a PDDL planner as a plan of the testbed."""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli.plan_files import of_pddl, read_plan_file
from smash.problem.errors import MalformedFile, RefusedPlan
from smash.problem.files.documents import require_writable
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import write_plan
from smash.problem.plan import check_plan


@click.command("import-plan")
@click.argument("instance", type=click.Path(path_type=Path))
@click.argument("plan", type=click.Path(path_type=Path))
@of_pddl
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), required=True, help="Plan file to write.")
def command(instance: Path, plan: Path, problem: Path | None, domain: Path | None, out: Path) -> None:
    """Turn PLAN, the answer of a PDDL planner, into a plan for INSTANCE.

    A step a line, in the spelling of Fast Downward `(stack a b)`, of VAL `0: (stack a b)[1]` or of unified-planning
    `stack(a, b)`; the steps of `smash export-pddl`'s encodings are read too. Actions with names of their own need
    --domain.

    What is put down goes to the first empty location, stacks before buffers. A plan that ends with a block in the hand
    gets one place. A wrong plan is refused with the step and the reason, exit 3.

    \b
    Examples:
      smash import-plan blocks-16-1.json sas_plan --out plan.json
      smash import-plan p01.json sas_plan --problem mystery/p01.pddl --domain mystery/domain.pddl --out plan.json
    """
    problem_here = read_instance(instance)
    found = read_plan_file(plan, problem_here, problem, domain)
    require_writable(out)
    if found.ours:
        raise MalformedFile(str(plan), "a plan file of the testbed already; steps of a PDDL planner are wanted")
    verdict = check_plan(problem_here, found.plan)
    if not verdict.accepted:
        raise RefusedPlan(f"{plan}: {verdict}")
    write_plan(found.plan, out)
    found.say()
    click.echo(f"{found.told(problem_here.costs)} in {out}")
