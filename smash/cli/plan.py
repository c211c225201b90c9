"""`smash plan INSTANCE`: plan one instance."""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli import fail
from smash.planners.protocol import SolveOptions
from smash.planners.registry import DEFAULT, get_planner
from smash.problem.errors import Unsupported
from smash.problem.files import plan_text, read_instance, write_text

EXIT_OF_STATUS = {"optimal": 0, "feasible": 0, "infeasible": 3, "unknown": 4}


@click.command("plan")
@click.argument("instance", type=click.Path(path_type=Path))
@click.option("--planner", default=DEFAULT, show_default=True, metavar="NAME", help="See `smash planners`.")
@click.option("--no-topple", is_flag=True, help="Pick and place only.")
@click.option("--max-topple", type=click.IntRange(min=1), metavar="M", help="At most M blocks in one topple.")
@click.option(
    "--budget",
    type=click.FloatRange(min=0, min_open=True),
    default=30.0,
    show_default=True,
    metavar="SECONDS",
    help="Wall time, model building and translation included.",
)
@click.option("--warm-start", metavar="NAME", help="Planner whose plan starts a MILP model (default: cold).")
@click.option("--horizon", type=click.IntRange(min=1), metavar="T", help="Steps or layers of a time-indexed model.")
@click.option("--threads", type=click.IntRange(min=1), default=1, show_default=True, help="Solver threads.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write the plan here (default: print).")
def command(
    instance: Path,
    planner: str,
    no_topple: bool,
    max_topple: int | None,
    budget: float,
    warm_start: str | None,
    horizon: int | None,
    threads: int,
    out: Path | None,
) -> None:
    """Plan INSTANCE and print the plan as JSON, or write it with --out.

    \b
    Examples:
      smash plan examples/figure1.json
      smash plan examples/figure1.json --no-topple --planner precedence --out plan.json
    """
    problem = read_instance(instance)
    options = SolveOptions(
        topple=not no_topple,
        max_topple=max_topple,
        warm_start=warm_start,
        horizon=horizon,
        threads=threads,
    )
    chosen = get_planner(planner)
    ask = getattr(chosen, "unsupported", None)
    reason = ask(problem, options) if ask is not None else None
    if reason:
        raise Unsupported(f"planner {planner!r}: unsupported: {reason}")
    result = chosen.solve(problem, options, budget)
    text = plan_text(result.as_plan(problem, planner, options))
    if out is None:
        click.echo(text, nl=False)
    else:
        write_text(out, text)
    code = EXIT_OF_STATUS[result.status]
    if code:
        words = {3: "proven infeasible", 4: "budget spent without a plan"}[code]
        fail(f"{instance}: {words}", code)
