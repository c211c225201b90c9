"""`smash dataset`: the instance sets with what is proven of them, as files that others can cite and load."""

from __future__ import annotations

from itertools import chain
from pathlib import Path

import click

from smash.cli.choices import budget_option
from smash.problem.sets.suites import PAPER_SUITES
from smash.problem.words import counted


@click.command("dataset")
@click.option(
    "--set", "sets", type=click.Choice([*PAPER_SUITES, "open"]), multiple=True, help="Repeatable (default: all)."
)
@click.option(
    "--instances", type=click.IntRange(min=1), metavar="K", help="Only the first K of each of the paper's sets."
)
@budget_option("of each solve")
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    default="runs/dataset",
    show_default=True,
    metavar="DIR",
    help="Where to write it.",
)
def command(sets: tuple[str, ...], instances: int | None, budget: float, out: Path) -> None:
    """Write a data set: problems with proven optima or best plans and bounds, plans, certificates, Croissant metadata.

    The paper's sets are solved anew with 0 to 12 buffers, with and without topple; the open sets are taken from the
    list of best known plans.

    \b
    Examples:
      smash dataset --out my-dataset
      smash dataset --set multi-4 --instances 2 --out few
    """
    from smash.experiments.dataset.entries import open_entries, paper_entries
    from smash.experiments.dataset.package import write_dataset

    asked = sets or (*PAPER_SUITES, "open")
    papers = [name for name in PAPER_SUITES if name in asked]
    entries = chain(paper_entries(papers, instances, budget), open_entries() if "open" in asked else ())
    files = write_dataset(entries, out, lambda said: click.echo(said, err=True))
    click.echo("\n".join(f"{file} ({counted(file.stat().st_size, 'byte')})" for file in files))
