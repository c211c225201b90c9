"""`smash frontier INSTANCE|SUITE`: what buffers buy."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from statistics import mean
from typing import TYPE_CHECKING

import click

from smash.cli.choices import budget_option
from smash.cli.shown_tables import console
from smash.experiments.studies.frontier import FrontierPoint, fewest_buffers, frontier
from smash.planners.registry import DEFAULT, get_planner
from smash.problem.errors import MalformedFile
from smash.problem.extras import require
from smash.problem.files.documents import replacing
from smash.problem.files.instances import read_instance
from smash.problem.sets.suites import read_suite
from smash.problem.words import counted, visible

if TYPE_CHECKING:
    from rich.table import Table

VARIANTS = ((False, "without topple"), (True, "with topple"))


@click.command("frontier")
@click.argument("problem", metavar="INSTANCE|SUITE")
@click.option(
    "--most", type=click.IntRange(0, 10_000), default=12, show_default=True, metavar="B", help="Most buffers."
)
@click.option("--planner", default=DEFAULT, show_default=True, metavar="NAME", help="What solves; it should prove.")
@click.option("--max-topple", type=click.IntRange(min=1), metavar="M", help="At most M blocks in one topple.")
@budget_option("of each solve")
@click.option("--instances", type=click.IntRange(min=1), metavar="K", help="Only the first K of a suite.")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), help="Write frontier.csv, .png and .pdf here.")
def command(
    problem: str,
    most: int,
    planner: str,
    max_topple: int | None,
    budget: float,
    instances: int | None,
    out: Path | None,
) -> None:
    """Show the exact cost against the number of buffers, with and without topple, and the fewest for each cost.

    \b
    Examples:
      smash frontier examples/figure1.json
      smash frontier multi-9 --out runs/frontier
    """
    from rich.console import Console

    if out is not None:
        require("smash frontier --out", "matplotlib")
    solver = get_planner(planner)
    chosen = [read_instance(problem)] if Path(problem).is_file() else read_suite(problem)[:instances]
    points: list[FrontierPoint] = []
    with Console(stderr=True).status("solving") as status:
        for number, instance in enumerate(chosen, start=1):
            for point in frontier(instance, solver, most, budget, max_topple):
                points.append(point)
                status.update(f"{number} of {len(chosen)} instances, {len(points)} solves done")
    if not points:
        raise MalformedFile(problem, f"more than {most} buffers hold blocks at the start")
    for table in _tables(points, most) if len(chosen) > 1 else _instance_tables(points):
        console().print(table)
    if out is not None:
        _write(points, problem, out)


def _table(title: str, columns: Sequence[str]) -> Table:
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(visible(title)), title_justify="left")
    for column in columns:
        table.add_column(column, justify="right")
    return table


def _cell(point: FrontierPoint | None) -> str:
    if point is None or point.status == "infeasible":
        return "no plan"
    if point.status == "optimal":
        return str(point.cost)
    return f"{point.lower_bound or 0} to {'?' if point.cost is None else point.cost}"


def _instance_tables(points: list[FrontierPoint]) -> list[Table]:
    """Return the table of one instance, and the fewest buffers for each cost."""
    at = {(point.buffers, point.topple): point for point in points}
    costs = _table(f"{points[0].instance}: fewest actions", ["buffers", *(name for _, name in VARIANTS)])
    for buffers in sorted({point.buffers for point in points}):
        costs.add_row(str(buffers), *(_cell(at.get((buffers, topple))) for topple, _ in VARIANTS))
    fewest = {topple: fewest_buffers(points, topple) for topple, _ in VARIANTS}
    needs = _table("fewest buffers for so many actions", ["actions", *(name for _, name in VARIANTS)])
    for cost in sorted({*fewest[False], *fewest[True]}):
        reached = [[buffers for most, buffers in fewest[topple].items() if most <= cost] for topple, _ in VARIANTS]
        needs.add_row(str(cost), *(str(min(buffers)) if buffers else "-" for buffers in reached))
    return [costs, needs]


def _tables(points: list[FrontierPoint], most: int) -> list[Table]:
    """Return the table of a set: per number of buffers and variant the mean cost, and how many need no more."""
    headings = [f"{what}, {name}" for _, name in VARIANTS for what in ("mean actions", "proven", "buffers enough")]
    table = _table(
        f"fewest actions over {counted(len({point.instance for point in points}), 'instance')}", ["buffers", *headings]
    )
    last = {(point.instance, point.topple): point.cost for point in points if point.buffers == most}
    for buffers in range(most + 1):
        cells: list[str] = []
        for topple, _ in VARIANTS:
            part = [point for point in points if point.buffers == buffers and point.topple == topple]
            solved = [point.cost for point in part if point.cost is not None]
            enough = sum(point.cost == last[point.instance, topple] for point in part)
            proven = sum(point.status in ("optimal", "infeasible") for point in part)
            cells += [f"{mean(solved):.2f}" if solved else "no plan", f"{proven}/{len(part)}", f"{enough}/{len(part)}"]
        table.add_row(str(buffers), *cells)
    return [table]


def _write(points: list[FrontierPoint], title: str, out: Path) -> None:
    """Write the points as CSV and draw them."""
    from smash_analysis.charts.frontier import frontier_figure

    out.mkdir(parents=True, exist_ok=True)
    rows = [point.row() for point in points]
    with (
        replacing(out / "frontier.csv") as whole,
        whole.open("w", newline="", encoding="utf-8", errors="backslashreplace") as file,
    ):
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    figure = frontier_figure(rows, Path(title).stem)
    for ending in ("png", "pdf"):
        with replacing(out / f"frontier.{ending}") as whole:
            figure.savefig(whole, dpi=200)
    click.echo("\n".join(str(out / f"frontier.{ending}") for ending in ("csv", "png", "pdf")))
