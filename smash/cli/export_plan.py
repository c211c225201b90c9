"""`smash export-plan INSTANCE PLAN --as …`: a plan as the steps of a PDDL planner."""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli.plan_files import of_pddl, reading_for
from smash.problem.blocksworld.plan_text import plan_lines
from smash.problem.blocksworld.plans import exported, in_words_of
from smash.problem.errors import RefusedPlan, SmashError
from smash.problem.files.documents import require_writable, write_text
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import read_plan
from smash.problem.model import Instance
from smash.problem.plan import Plan, check_plan

CLASSICAL = ("classical", "moves")
FORMS = (*CLASSICAL, "chain", "conditional")


@click.command("export-plan")
@click.argument("instance", type=click.Path(path_type=Path))
@click.argument("plan", type=click.Path(path_type=Path))
@click.option(
    "--as",
    "form",
    type=click.Choice(FORMS),
    required=True,
    help="`classical`: pick-up, put-down, stack, unstack; `moves`: without a hand; else an encoding of export-pddl.",
)
@of_pddl
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), required=True, help="File to write.")
def command(instance: Path, plan: Path, form: str, problem: Path | None, domain: Path | None, out: Path) -> None:
    """Write PLAN for INSTANCE as PDDL steps, `(action arg …)` a line, with the cost as Fast Downward says it.

    `classical` and `moves` are for `on` goals and plans without topple (else exit 6); with --domain they are in the
    words of that domain. `chain` and `conditional` are the plans of `smash export-pddl`'s domains.

    \b
    Examples:
      smash export-plan blocks-16-1.json plan.json --as classical --out sas_plan
      smash export-plan examples/figure1.json plan.json --as chain --out sas_plan
    """
    problem_here, ours = read_instance(instance), read_plan(plan)
    require_writable(out)
    verdict = check_plan(problem_here, ours)
    if not verdict.accepted:
        raise RefusedPlan(f"{plan}: {verdict}")
    try:
        text = (
            _classical(problem_here, ours, form, problem, domain)
            if form in CLASSICAL
            else _encoded(problem_here, ours, form)
        )
    except SmashError as error:
        raise type(error)(f"{plan}: {error}") from None
    write_text(out, text)
    lines = text.count("\n") - 1
    click.echo(f"{lines} step{'' if lines == 1 else 's'} in {out}")


def _classical(instance: Instance, plan: Plan, form: str, problem: Path | None, domain: Path | None) -> str:
    moves = form == "moves"
    reading = in_words_of(reading_for(instance, problem, domain), moves=moves)
    found = exported(instance, plan.actions or (), reading, moves=moves)
    if found.left_out:
        click.echo(
            f"{found.left_out} moves from table to table are left out: the classical table is one place", err=True
        )
    return plan_lines(found.steps, len(found.steps), unit=True)


def _encoded(instance: Instance, plan: Plan, form: str) -> str:
    from smash_baselines.steps import steps_of
    from smash_baselines.task import compile_instance

    task = compile_instance(instance, plan.options, form)
    assert plan.cost is not None
    return plan_lines(steps_of(plan.actions or (), task), plan.cost, unit=False)
