"""`smash verify INSTANCE PLAN CERTIFICATE`: is the plan legal, and is its bound proven?"""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli import fail
from smash.problem.certificate import proven_bound, read_certificate
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import read_plan
from smash.problem.plan import check_plan
from smash.problem.words import counted


@click.command("verify")
@click.argument("instance", type=click.Path(path_type=Path))
@click.argument("plan", type=click.Path(path_type=Path))
@click.argument("certificate", type=click.Path(path_type=Path))
def command(instance: Path, plan: Path, certificate: Path) -> None:
    """Check PLAN by the law and CERTIFICATE from the ground up, without a solver.

    Exit 0 where the certificate proves the plan's lower bound (an optimal plan's cost), 3 where it does not, 6 where
    its argument does not cover the instance: with carries, lifts, costs, blocks on a carrier.

    \b
    Example:
      smash plan examples/figure1.json --out plan.json
      smash certify examples/figure1.json plan.json --out proof.json
      smash verify examples/figure1.json plan.json proof.json
    """
    problem, filed = read_instance(instance), read_plan(plan)
    verdict = check_plan(problem, filed)
    if not verdict.accepted:
        fail(f"{plan}: {verdict}", 3)
    bound = proven_bound(problem, filed.options, read_certificate(certificate))
    if filed.cost is not None and bound > filed.cost:
        fail(f"{certificate}: its bound {bound} is above the cost {filed.cost} of this legal plan", 3)
    if filed.cost == bound:
        click.echo(f"verified: legal, and no plan has fewer than its {counted(bound, 'action')}")
    elif filed.status != "optimal" and (filed.lower_bound is None or filed.lower_bound <= bound):
        click.echo(f"verified: legal with {counted(filed.cost or 0, 'action')}, and no plan has fewer than {bound}")
    else:
        claimed = filed.cost if filed.status == "optimal" else filed.lower_bound
        fail(f"{certificate}: proves the lower bound {bound}, the plan claims {claimed}", 3)
