"""`smash best-known`: the list of best known costs and bounds of the open instances."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import click

from smash.problem.errors import MalformedFile
from smash.problem.files.documents import read_text, write_text
from smash.problem.files.plans import read_plan
from smash.problem.words import one_line

list_option = click.option(
    "--list",
    "directory",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Another list (default: results/best-known of the repository, or the one installed).",
)


@click.group("best-known")
def command() -> None:
    """Keep the list of best known costs and lower bounds of the open instances: best-known.csv, and its plans.

    \b
    Examples:
      smash sweep experiments/open.toml --out runs/open
      smash best-known update runs/open
      smash best-known add mine.json --by "A. Researcher"
      smash best-known table --into docs/open-instances.md
    """


@command.command("update", short_help="take what sweeps found and proved")
@click.argument("results", nargs=-1, required=True, type=click.Path(path_type=Path, file_okay=False))
@list_option
def update(results: tuple[Path, ...], directory: Path | None) -> None:
    """Take the better plans and lower bounds of RESULTS (directories that sweeps wrote) into the list.

    Every plan is judged by the law again. Records of other instances, or of these with other buffers, are left out.
    A legal plan below a proven bound stops the update: one of both is wrong.

    \b
    Example:
      smash best-known update runs/open
    """
    from smash.experiments.best_known.files import FILE, list_to_write, read_best_known, write_best_known
    from smash.experiments.best_known.standing import BestKnown
    from smash.records.believing import believed
    from smash.records.files import RUNS
    from smash.records.reading import read

    directory = list_to_write(directory)
    known = read_best_known(directory) if (directory / FILE).is_file() else BestKnown(directory)
    improved = others = 0
    for folder in results:
        if not RUNS.path(folder).is_file():
            raise MalformedFile(str(folder), f"no {RUNS.name} there: not what a sweep writes")
        reading = read(folder, RUNS)
        found = believed(reading.records)
        for line in (*found.lines(), *reading.notes()):
            click.echo(one_line(line), err=True)
        for record in found.records:
            entries = known.offer_record(record)
            others += entries is None
            improved += len(entries or [])
    write_best_known(known)
    click.echo(
        f"{improved} improvements; {sum(e.proven for e in known.entries.values())} of {len(known.entries)} proven"
    )
    if others:
        click.echo(f"{others} records are of other instances than the open ones as they are committed", err=True)


@command.command("add", short_help="put a plan on the list")
@click.argument("plan", type=click.Path(path_type=Path))
@click.option("--by", required=True, metavar="WHO", help="Who or what found it.")
@click.option("--certificate", type=click.Path(path_type=Path, dir_okay=False), metavar="FILE", help="For its bound.")
@list_option
def add(plan: Path, by: str, certificate: Path | None, directory: Path | None) -> None:
    """Put PLAN on the list where it improves on it; its lower bound only with a certificate.

    \b
    Example:
      smash best-known add mine.json --by "A. Researcher, my-planner 1.2"
    """
    from smash.experiments.best_known.files import list_to_write, read_best_known, write_best_known
    from smash.experiments.best_known.standing import Found
    from smash.experiments.best_known.submission import accept
    from smash.problem.certificate import read_certificate

    submitted = read_plan(plan)
    proof = None if certificate is None else read_certificate(certificate)
    seconds = submitted.incumbents[-1].seconds if submitted.incumbents else None
    today = datetime.now(UTC).date().isoformat()
    known = read_best_known(list_to_write(directory))
    improved = accept(known, submitted, Found(by, submitted.planner, seconds=seconds, date=today), proof)
    if not improved:
        click.echo("nothing new: the list has it, or better")
        raise click.exceptions.Exit(1)
    write_best_known(known)
    click.echo("improved: " + ", ".join(f"{entry.instance} {entry.variant}" for entry in improved))


@command.command("table", short_help="what is still open, as Markdown")
@click.option(
    "--into",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help="Put it between the marks of this page (default: print it).",
)
@list_option
def table(into: Path | None, directory: Path | None) -> None:
    """Show what is still open, as a Markdown table: one row an instance and variant without a proven optimum.

    \b
    Example:
      smash best-known table --into docs/open-instances.md
    """
    from smash.experiments.best_known.files import LIST, read_best_known
    from smash.experiments.best_known.open_table import open_table, put_between

    text = open_table(read_best_known(directory or LIST))
    if into is None:
        click.echo(text, nl=False)
    else:
        write_text(into, put_between(read_text(into), text, str(into)))
