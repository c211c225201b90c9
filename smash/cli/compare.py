"""`smash compare SUITE --planner A --planner B …`: planners on the same problems, and a table of how they did."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path
from typing import Any

import click

from smash.cli.choices import budget_option, dask_option, encoding_option, named_commands
from smash.cli.shown_tables import show
from smash.cli.sweep import installed_runs, run_all
from smash.experiments.comparison import comparison_of
from smash.experiments.isolation.job import DEFAULT_MEMORY
from smash.experiments.sweeps.keep import keep
from smash.problem.extras import TABLES, require
from smash.problem.words import counted, one_line
from smash.records.believing import believed_runs
from smash.records.runs import RunRecord

SHORT = {"first plan [s]": "first", "best plan [s]": "best", "cost, solved": "cost", "cost, common": "common"}
"""The table's columns in a terminal, under shorter names; the files hold them all."""
TIMES = ("first", "best")
"""Those of them that hold times: in seconds, but in milliseconds where the cell says so."""
INTERVAL = re.compile(r" \[[^]]*\]")
"""What a terminal leaves out of a cell."""


@click.command("compare")
@click.argument("suites", metavar="SUITE…", nargs=-1, required=True)
@click.option("--planner", "planners", multiple=True, metavar="NAME", help="May stand several times.")
@click.option(
    "--command",
    "commands",
    multiple=True,
    metavar="NAME='PROGRAM …'",
    help="Any PDDL planner: NAME='PLANNER {domain} {problem} {plan}', without a shell. May stand several times.",
)
@encoding_option
@budget_option("of each run")
@click.option("--buffers", type=int, multiple=True, metavar="B", help="Buffer counts (default: as filed).")
@click.option("--variant", "variants", multiple=True, metavar="V", help="topple, no-topple, max-topple-M.")
@click.option("--instances", type=click.IntRange(min=1), metavar="K", help="Only the first K of each suite.")
@click.option("--memory", type=click.IntRange(min=1), default=DEFAULT_MEMORY, show_default=True, metavar="MIB")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, metavar="N", help="Runs at a time.")
@dask_option
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), help="Default: runs/compare-SUITE….")
def command(
    suites: tuple[str, ...],
    planners: tuple[str, ...],
    commands: tuple[str, ...],
    encoding: str | None,
    budget: float,
    buffers: tuple[int, ...],
    variants: tuple[str, ...],
    instances: int | None,
    memory: int,
    seed: int,
    jobs: int,
    dask: str | None,
    out: Path | None,
) -> None:
    """Run every planner on every instance of each SUITE (a committed set or a directory) and compare.

    What contradicts stands first: a planner with a false claim proves nothing in the tables.
    The records go to OUT/runs.jsonl, tables and curves to OUT/comparison; stopped, it goes on where it was. Records of
    other comparisons that stand there are kept and left out of the tables.

    \b
    Examples:
      smash compare multi-4 multi-9 --planner smash --planner smash-layered --planner fd-lama --jobs 2
      smash compare multi-4 --planner smash --command pyperplan='pyperplan {domain} {problem}' \\
        --encoding pick-and-place
    """
    if not planners and not commands:
        raise click.UsageError("Missing option '--planner' or '--command'.")
    if encoding is not None and not commands:
        raise click.UsageError("--encoding goes with --command; a planner on another encoding is `NAME:ENCODING`")
    programs = named_commands(commands)
    require("smash compare", *TABLES)
    from smash_analysis import comparison

    name = "compare-" + "-".join(Path(suite).name or "here" for suite in suites)
    experiment = comparison_of(
        suites,
        planners,
        programs=programs,
        encoding=encoding,
        budget=budget,
        variants=variants or ("topple", "no-topple"),
        buffers=buffers,
        instances=instances,
        seed=seed,
        memory=memory,
        jobs=jobs,
    )
    out = out or Path("runs") / name
    runs = installed_runs(experiment, Path())
    run_all(runs, out, jobs, dask, partial(keep, experiment, Path(), out))
    found = believed_runs(out, {run.key for run in runs})
    for line in found.lines():
        click.echo(one_line(line))
    files = comparison.write(found, out / "comparison")
    _show(comparison, found.records)
    click.echo("\n".join(map(str, files)))


def _show(comparison: Any, records: list[RunRecord]) -> None:
    """Print the table, its settings as headings, and how the runs ended."""
    runs = comparison.compared(comparison.comparable(records))
    table = comparison.comparison_table(runs)
    for setting, part in table.groupby(comparison.GROUP, sort=True):
        suite, blocks, count, variant = setting
        mine = [*SHORT, "gap to optimum", *comparison.metric_names(runs)]
        short = part[["planner", "coverage", "proven", *mine]].rename(columns=SHORT)
        short = short.map(lambda cell: INTERVAL.sub("", str(cell)))
        for column in TIMES:
            short[column] = short[column].map(with_unit)
        show(
            short,
            f"{suite}: {counted(blocks, 'block')}, {counted(count, 'buffer')}, {variant} "
            "(times are medians, costs mean ± std)",
        )
    show(comparison.outcome_table(runs), "how the runs ended")
    failures = comparison.failure_table(runs)
    if len(failures):
        show(failures, "failures")


def with_unit(cell: str) -> str:
    """Return a time with its unit: the column's, in files, where the cell has none of its own."""
    return f"{cell} s" if cell and cell[-1].isdigit() else cell
