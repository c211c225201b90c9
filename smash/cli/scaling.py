"""`smash scaling`: every planner over growing sizes."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import click

from smash.cli.choices import budget_option, dask_option
from smash.cli.sweep import installed_runs, run_all
from smash.experiments.studies.scaling import LARGEST, SIZES, scaling_experiment, write_scaling_suites
from smash.experiments.sweeps.experiment import INSTANCES
from smash.experiments.sweeps.keep import keep
from smash.planners.registry import why_unknown
from smash.problem.errors import SmashError


@click.command("scaling")
@click.option("--planner", "planners", multiple=True, metavar="NAME", help="Repeatable (default: those that scale).")
@click.option("--largest", type=click.IntRange(min=4), default=SIZES[-1][0], show_default=True, help="Most blocks.")
@click.option("--count", type=click.IntRange(1, 1000), default=3, show_default=True, help="Instances a size.")
@budget_option("of each run")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, help="Runs at a time.")
@dask_option
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Of the instances.")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), default="runs/scaling", show_default=True)
def command(
    planners: tuple[str, ...],
    largest: int,
    count: int,
    budget: float,
    jobs: int,
    dask: str | None,
    seed: int,
    out: Path,
) -> None:
    """Run planners on random instances of 4 to 10,000 blocks, with and without topple, and record every run.

    Each size has no buffer, the paper's 12, and as many as blocks. Curves and growth exponents are made from the
    records by `python -m smash_analysis.scaling OUT`; `make scaling` does both. Start it again and it does what is
    left.

    \b
    Examples:
      smash scaling --planner precedence --planner greedy --largest 100
      smash scaling --dask tcp://head:8786 --out runs/scaling
    """
    for unknown in filter(None, map(why_unknown, planners)):
        raise SmashError(unknown)
    sizes = write_scaling_suites(out / INSTANCES, largest, count, seed)
    experiment = scaling_experiment(sizes, planners or tuple(LARGEST), budget)
    base = out / INSTANCES
    run_all(installed_runs(experiment, base), out, jobs, dask, partial(keep, experiment, base, out))
