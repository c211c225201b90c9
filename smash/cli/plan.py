"""`smash plan INSTANCE`: plan one instance."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import click

from smash.cli import fail
from smash.cli.choices import budget_option, check_command, command_option, encoding_option, without_option
from smash.cli.signals import stopped_by_signals
from smash.experiments.isolation.job import DEFAULT_MEMORY, Job, Report
from smash.experiments.planning import failure
from smash.experiments.weighing.weighed import run_job
from smash.forecast.model import read_model
from smash.planners.protocol import ACTIONS, HIGHS, MOST_THREADS, OBJECTIVES, SOLVERS, OnIncumbent, Settings
from smash.planners.registry import COMMAND, DEFAULT, why_unknown
from smash.problem.errors import SmashError
from smash.problem.files.documents import require_writable, write_text
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import plan_text
from smash.problem.model import Action, PlanOptions
from smash.problem.problem import Problem


@click.command("plan")
@click.argument("instance", type=click.Path(path_type=Path))
@click.option("--planner", metavar="NAME", help=f"See `smash planners` (default: {DEFAULT}).")
@command_option
@encoding_option
@click.option("--no-topple", is_flag=True, help="Pick and place only.")
@click.option("--max-topple", type=click.IntRange(min=1), metavar="M", help="At most M blocks in one topple.")
@click.option(
    "--estimates",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Topple no more blocks at once than went well in `smash topple-map`, whose estimates.json this is.",
)
@without_option
@budget_option("of the planner")
@click.option(
    "--memory",
    type=click.IntRange(min=1),
    default=DEFAULT_MEMORY,
    show_default=True,
    metavar="MIB",
    help="Memory limit over all of the planner's processes.",
)
@click.option("--warm-start", metavar="NAME", help="Planner whose plan starts a MILP model (default: cold).")
@click.option(
    "--solver",
    type=click.Choice(SOLVERS),
    default=HIGHS,
    show_default=True,
    help="Solver of the MILP models of smash, smash-flow and smash-layered; all but highs are extras.",
)
@click.option("--horizon", type=click.IntRange(min=1), metavar="T", help="Steps or layers of a time-indexed model.")
@click.option("--threads", type=click.IntRange(1, MOST_THREADS), default=1, show_default=True, help="Solver threads.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="For planners that draw.")
@click.option(
    "--objective",
    type=click.Choice(OBJECTIVES),
    default=ACTIONS,
    show_default=True,
    help="What the plan is chosen for: the fewest actions, or the least expected time of its execution.",
)
@click.option(
    "--robust",
    is_flag=True,
    help="Of equally good plans the one of least risk in execution; plans for seconds are chosen so in any case.",
)
@click.option(
    "--model",
    "outcomes",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Outcome model of the scene, of `smash topple-map --model` (default: that of the built-in scene).",
)
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write the plan here (default: print).")
def command(
    instance: Path,
    planner: str | None,
    command_line: str | None,
    encoding: str | None,
    no_topple: bool,
    max_topple: int | None,
    estimates: Path | None,
    without: tuple[str, ...],
    budget: float,
    memory: int,
    warm_start: str | None,
    solver: str,
    horizon: int | None,
    threads: int,
    seed: int,
    objective: str,
    robust: bool,
    outcomes: Path | None,
    out: Path | None,
) -> None:
    """Plan INSTANCE and print the plan as JSON, or write it with --out.

    The planner runs in processes of its own. Ctrl-C ends them and keeps the best plan found so far.

    With `--objective seconds` its plans with topple and without are starts: of what annealing makes of them, the plan
    is taken whose motions, rehearsed within the budget, are expected to take the least time (`expected_seconds`).
    `cost`, `lower_bound` and `status` speak of actions all the same.

    \b
    Examples:
      smash plan examples/figure1.json
      smash plan examples/figure1.json --no-topple --planner precedence --out plan.json
      smash plan examples/figure1.json --planner smash-flow --solver cpsat
      smash plan examples/figure1.json --objective seconds --budget 60
      smash plan examples/figure1.json --robust
      smash plan examples/figure1.json --estimates runs/topple-map/estimates.json
      smash plan examples/figure1.json --command 'pyperplan -s gbf {domain} {problem}' --encoding pick-and-place
    """
    if planner is not None and command_line is not None:
        raise click.UsageError("--planner and --command exclude each other")
    check_command(command_line, encoding)
    if outcomes is not None and objective == ACTIONS and not robust:
        raise click.UsageError("--model is for --objective seconds and --robust")
    planner = planner or (DEFAULT if command_line is None else COMMAND)
    if estimates is not None:
        max_topple = _trusted(estimates, max_topple)
        no_topple = no_topple or max_topple == 0
    if warm_start is not None and (unknown := why_unknown(warm_start)) is not None:
        raise SmashError(unknown)
    problem = Problem(read_instance(instance), PlanOptions(not no_topple, max_topple or None, without=without))
    settings = Settings(warm_start, horizon, threads, seed, command_line, encoding, solver, objective, robust)
    job = Job(planner, problem, settings, budget, memory)
    model = None if outcomes is None else read_model(outcomes)
    require_writable(out)
    with stopped_by_signals() as stop, _progress(planner) as tell:
        report = run_job(job, model, tell, stop, for_this=True)
    _write(report, out)
    _end(report, instance, planner, budget)


def _trusted(estimates: Path, max_topple: int | None) -> int:
    """The largest topple that execution can be trusted with, and that is asked for; 0 for none."""
    from smash.execution.trials.estimates import read_estimates

    trusted = read_estimates(estimates).trusted_size()
    if not trusted:
        click.echo(f"{estimates}: no topple is trusted; planning without", err=True)
    return trusted if max_topple is None else min(trusted, max_topple)


def _write(report: Report, out: Path | None) -> None:
    """File the plan: at exits 0, 3 and 4, and a plan or a bound that was found before an interruption."""
    found = report.plan.actions is not None or report.plan.lower_bound is not None
    if report.exit_code not in (0, 3, 4) and not (report.exit_code == 130 and found):
        return
    text = plan_text(report.plan)
    if out is None:
        click.echo(text, nl=False)
    else:
        write_text(out, text)


def _without_plan(report: Report, budget: float) -> str:
    """Say whether the budget was spent, or the planner gave up before (a horizon that is too short, say)."""
    seconds = report.wall_seconds
    if seconds is not None and seconds < 0.9 * budget:
        return f"gave up after {seconds:.2f} of {budget:g} s, without a plan and without a proof that none exists"
    return "budget spent without a plan"


def _end(report: Report, instance: Path, planner: str, budget: float) -> None:
    error = failure(report, planner, f"{instance}: ")
    if error is not None:
        raise error
    who = f"{instance}: planner {planner!r}"
    found = ""
    if report.plan.actions is not None:
        found = f"; the best plan so far has cost {report.plan.cost}"
    elif report.plan.lower_bound is not None:
        found = f" without a plan; none is cheaper than {report.plan.lower_bound}"
    said = report.plan.details.get("reason")
    why = f": {said}" if isinstance(said, str) else ""
    words = {
        "infeasible": f"infeasible, {report.reason}" if report.reason else f"proven infeasible{why}",
        "budget-spent": _without_plan(report, budget),
        "interrupted": f"interrupted{found}",
    }.get(report.outcome, f"{report.outcome}: {report.reason}")
    if report.exit_code:
        fail(f"{who}: {words}", report.exit_code)
    note = report.plan.details.get("note")
    if isinstance(note, str):
        print(f"smash: {instance}: {note}", file=sys.stderr)
    if report.outcome == "over-budget":
        print(f"smash: {who}: {words}; its best plan is kept", file=sys.stderr)


@contextmanager
def _progress(planner: str) -> Iterator[OnIncumbent | None]:
    """Show the best cost so far, where someone is watching."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.markup import escape

    with Console(stderr=True).status(f"{escape(planner)}: no plan yet") as status:

        def tell(seconds: float, cost: int, actions: Sequence[Action]) -> None:
            status.update(f"{escape(planner)}: cost {cost} after {seconds:.3g} s")

        yield tell
