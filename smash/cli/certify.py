"""`smash certify INSTANCE PLAN`: write down why no plan is cheaper."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter

import click

from smash.cli import fail
from smash.cli.choices import budget_option
from smash.problem.certificate import Certificate, FirstPlace, certificate_text, why_not_certified
from smash.problem.files.documents import write_text
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import read_plan
from smash.problem.problem import Problem
from smash.problem.words import counted


@click.command("certify")
@click.argument("instance", type=click.Path(path_type=Path))
@click.argument("plan", type=click.Path(path_type=Path))
@budget_option("of the search for the proof")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), required=True, help="Certificate to write.")
def command(instance: Path, plan: Path, budget: float, out: Path) -> None:
    """Write a certificate of a lower bound on all plans with PLAN's options (topple or not, cap).

    Exit 6 where its argument does not cover the instance: with carries, lifts, costs, blocks on a carrier.

    The certificate lists cycles of precedence and the arithmetic of the bound, and for `on` goals where locations
    are few the places of towers; `smash verify` follows it without a solver. It counts no places to wait: where few
    buffers make plans dearer, it stays below.

    \b
    Example:
      smash plan examples/figure1.json --out plan.json
      smash certify examples/figure1.json plan.json --out proof.json
      smash verify examples/figure1.json plan.json proof.json
    """
    from smash.planners.precedence.certify import certify

    problem, filed = read_instance(instance), read_plan(plan)
    if filed.instance != problem.name:
        fail(f"{plan}: the plan is for instance {filed.instance!r}, not {problem.name!r}", 3)
    asked = Problem(problem, filed.options)
    why_not = why_not_certified(problem, filed.options)
    if why_not is not None:
        fail(f"{instance}: no certificate proves a bound here: {why_not}", 6)
    if asked.infeasible is not None:
        fail(f"{instance}: proven infeasible: {asked.infeasible}", 3)
    certificate = certify(asked, perf_counter() + budget, cost=filed.cost)
    write_text(out, certificate_text(certificate))
    note = f" ({certificate.note})" if certificate.note else ""
    parts: list[Certificate | FirstPlace] = [certificate, *certificate.first_places]
    cycles = sum(len(part.cycles if part.places is None else part.places.cycles) for part in parts)
    least = counted(certificate.bound, "action")
    click.echo(f"proven by {counted(cycles, 'cycle')}: every plan has at least {least}{note}")
