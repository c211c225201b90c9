"""`smash model INSTANCE`: the MILP that a planner would solve, written to a file and not solved."""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli.choices import without_option
from smash.planners.protocol import SolveOptions, plan_options, settings_of, why_refused
from smash.planners.registry import get_planner, why_unknown
from smash.problem.errors import SmashError, Unsupported
from smash.problem.files.instances import read_instance
from smash.problem.problem import Problem


@click.command("model")
@click.argument("instance", type=click.Path(path_type=Path))
@click.option("--planner", default="smash-layered", show_default=True, metavar="NAME", help="A planner with a MILP.")
@click.option("--no-topple", is_flag=True, help="Pick and place only.")
@click.option("--max-topple", type=click.IntRange(min=1), metavar="M", help="At most M blocks in one topple.")
@without_option
@click.option("--warm-start", metavar="NAME", help="Planner whose plan the first horizon has to hold.")
@click.option("--horizon", type=click.IntRange(min=1), metavar="T", help="Steps or layers.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="File to write: .mps or .lp.")
def command(
    instance: Path,
    planner: str,
    no_topple: bool,
    max_topple: int | None,
    without: tuple[str, ...],
    warm_start: str | None,
    horizon: int | None,
    out: Path | None,
) -> None:
    """Build the MILP of INSTANCE, print its size, and write it with --out for any solver to read.

    \b
    Examples:
      smash model examples/figure1.json --planner smash-flow
      smash model examples/figure1.json --planner smash-layered --no-topple --out figure1.mps
    """
    if warm_start is not None and (unknown := why_unknown(warm_start)) is not None:
        raise SmashError(unknown)
    chosen = get_planner(planner)
    build = getattr(chosen, "build_model", None)
    if build is None:
        raise Unsupported(f"planner {planner!r} has no model to write; smash-flow and smash-layered have")
    problem = read_instance(instance)
    options = SolveOptions(not no_topple, max_topple, warm_start, horizon, without=without)
    reason = why_refused(chosen, Problem(problem, plan_options(options)), settings_of(options))
    if reason:
        raise Unsupported(f"planner {planner!r}: unsupported: {reason}")
    if problem.hand is not None:
        raise Unsupported(
            f"the hand holds {problem.hand!r} at the start: there is a model for each first place, none of all"
        )
    model = build(problem, options)
    if out is not None:
        from smash.planners.milp.solvers import highs

        highs.write(model, out)
    click.echo(", ".join(f"{count} {what.replace('_', ' ')}" for what, count in model.size().items()))
