"""`smash records`: are the records of a sweep whole and sound, and the same as tables."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from smash.cli.shown_tables import console
from smash.problem.errors import MalformedFile
from smash.problem.extras import TABLES, require
from smash.problem.words import one_line, visible

if TYPE_CHECKING:
    from smash.experiments.sweeps.audit import Check
    from smash.experiments.sweeps.experiment import Run
    from smash.records.runs import RunRecord

results_argument = click.argument("results", type=click.Path(path_type=Path, file_okay=False))


@click.group("records")
def command() -> None:
    """Check the records of a sweep, or write them as tables.

    \b
    Examples:
      smash records check runs/ablation
      smash records export runs/ablation --out runs/ablation/tables
    """


@command.command("check", short_help="complete, one commit, explained, legal, whole?")
@results_argument
@click.option(
    "--experiment",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help="What was planned (default: RESULTS/experiment.toml, the sweep's own copy).",
)
def check(results: Path, experiment: Path | None) -> None:
    """Check RESULTS/runs.jsonl: complete, nothing twice, one commit, outcomes explained, plans legal, lines whole.

    What is claimed of all plans is held against every plan: across planners, variants, buffers and certificates
    (RESULTS/*.json, RESULTS/certificates).

    Where there are episodes (RESULTS/episodes.jsonl) the same is asked of them. Exit 0 where all is well, 3 otherwise,
    with one line a finding on stderr. Every recorded plan is judged by the law again. What is missing or damaged is
    done again where the sweep is started again.

    \b
    Examples:
      smash records check runs/ablation
      smash records check runs/few-buffers --experiment few-buffers.toml
    """
    from smash.experiments.episodes.audit import audit_episodes
    from smash.experiments.sweeps.audit import audit
    from smash.records.files import RUNS
    from smash.records.sharing import kept_objects

    if not RUNS.path(results).is_file() and (results / "scaling.csv").is_file():
        raise MalformedFile(str(results), "its records were not kept, only the table made of them (scaling.csv)")
    with kept_objects():
        checks = audit(results, partial(_planned, results, experiment)) + audit_episodes(results)
    _show(checks)
    findings = [finding for check in checks for finding in check.findings]
    for finding in findings:
        click.echo(one_line(finding), err=True)
    if findings:
        raise click.exceptions.Exit(3)


def _planned(results: Path, given: Path | None, records: Sequence[RunRecord]) -> Sequence[Run] | str:
    """Return the runs that were planned, or why they are not known: only a file that was asked for must be there.

    Args:
        results: the directory.
        given: the experiment file that was asked for.
        records: tell of planners that are not here whether they were run at each budget by itself.

    Raises:
        MalformedFile: where the file cannot be read, or a set that it names is not there.
    """
    from smash.experiments.sweeps.experiment import budget_dependent, experiment_runs, read_experiment

    copy = results / "experiment.toml"
    if given is None and not copy.is_file():
        return "no experiment.toml there; --experiment FILE names it"
    file = given or copy
    at_each = {record.planner: record.kind == "budget" for record in records if record.kind != "cutoff"}
    try:
        experiment = read_experiment(file, to_run=False)
        return experiment_runs(experiment, file.parent, lambda name: at_each.get(name, False) or budget_dependent(name))
    except MalformedFile as error:
        if given is not None:
            raise
        raise MalformedFile(error.where, f"{error.problem}; --experiment FILE names the file that was run") from None


def _show(checks: Sequence[Check]) -> None:
    from rich.table import Table
    from rich.text import Text

    table = Table("check", "", "found")
    for check in checks:
        mark = Text(str(len(check.findings)), style="red") if check.findings else Text("well", style="green")
        if check.answer.startswith("not known"):
            mark = Text("?", style="yellow")
        table.add_row(Text(check.question), mark, Text(visible(check.answer)))
    console().print(table)


@command.command("export", short_help="runs, incumbents and steps as Parquet and CSV")
@results_argument
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), required=True, metavar="DIR")
def export(results: Path, out: Path) -> None:
    """Write the records of RESULTS as tidy tables to DIR, as Parquet and as CSV.

    `runs` has one row a run, `incumbents` one a plan found on the way, `steps` one an action of the best plan; `key`
    joins them. docs/records.md lists the columns.

    \b
    Example:
      smash records export runs/ablation --out runs/ablation/tables
    """
    require("smash records export", *TABLES, "pyarrow")
    from smash_analysis import export as tables

    from smash.records.sharing import kept_objects

    with kept_objects():
        files = tables.export(results, out)
    for file, rows in files:
        click.echo(f"{file}: {rows} rows")
