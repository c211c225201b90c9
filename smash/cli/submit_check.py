"""`smash submit-check PLAN`: does a plan improve on the best known ones?"""

from __future__ import annotations

from pathlib import Path

import click

from smash.problem.certificate import read_certificate
from smash.problem.files.plans import read_plan


@click.command("submit-check")
@click.argument("plan", type=click.Path(path_type=Path))
@click.option(
    "--certificate",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help="Proof of a lower bound, from `smash certify`.",
)
@click.option(
    "--list", "directory", type=click.Path(path_type=Path, file_okay=False), metavar="DIR", help="Another list."
)
def command(plan: Path, certificate: Path | None, directory: Path | None) -> None:
    """Compare PLAN (a smash-plan/1 file) with the best known plan and bound of its open instance.

    The instance is found by its name. The law judges the plan; a lower bound that it only claims is not believed:
    --certificate proves one, and is checked without a solver, as by `smash verify`.

    One line is printed. Exit 0: it improves on the list. 1: it equals the best known plan or is worse. 2: malformed, or
    not on the list. 3: the law refuses the plan, or the certificate proves nothing of the kind.

    \b
    Example:
      smash plan smash/problem/sets/committed/open-on/open-on-04.json --no-topple --budget 300 --out mine.json
      smash submit-check mine.json
    """
    from smash.experiments.best_known.files import LIST, read_best_known
    from smash.experiments.best_known.submission import judge

    submitted = read_plan(plan)
    proof = None if certificate is None else read_certificate(certificate)
    judgement = judge(read_best_known(directory or LIST), submitted, proof)
    click.echo(judgement.words)
    if not judgement.improves:
        raise click.exceptions.Exit(1)
