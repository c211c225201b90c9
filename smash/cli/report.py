"""`smash report RESULTS`: records as one page that needs nothing else, and its parts as files."""

from __future__ import annotations

from pathlib import Path

import click

from smash.problem.extras import TABLES, require
from smash.problem.words import one_line


@click.command("report")
@click.argument("results", type=click.Path(path_type=Path, file_okay=False))
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), metavar="DIR", help="Default: RESULTS/report.")
def command(results: Path, out: Path | None) -> None:
    """Make DIR/index.html from the records in RESULTS, and its parts (PNG, PDF, Markdown, LaTeX, CSV) in DIR/parts.

    RESULTS is what a sweep, its episodes or a topple map wrote, or a directory that holds several such: each becomes
    a section. The page is one file and needs no network; every cell of a heatmap lists the runs behind it.

    \b
    Examples:
      smash report runs/ablation
      smash report results --out report
    """
    require("smash report", *TABLES)
    from smash_analysis.report import page

    made = page.make(results, out or results / "report", lambda line: click.echo(one_line(line), err=True))
    click.echo(f"{made} ({made.stat().st_size / 1e6:.1f} MB), parts in {made.parent / 'parts'}")
