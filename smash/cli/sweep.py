"""`smash sweep EXPERIMENT.toml`: run an experiment, here or on a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from pathlib import Path
from threading import Event

import click

from smash.cli.choices import dask_option
from smash.cli.signals import stopped_by_signals
from smash.experiments.environment import commit
from smash.experiments.isolation.job import longest
from smash.experiments.sweeps.cluster import slurm_script as batch_script
from smash.experiments.sweeps.display import Progress
from smash.experiments.sweeps.experiment import Experiment, Run, experiment_runs, not_installed, read_experiment
from smash.experiments.sweeps.keep import keep
from smash.experiments.sweeps.pool import pool
from smash.experiments.sweeps.sweep import execute, local_task, sweep
from smash.problem.files.documents import write_text
from smash.problem.words import counted, one_line
from smash.records.files import RUNS
from smash.records.outcomes import OUTCOMES
from smash.records.runs import RunRecord
from smash.records.writing import Writer


@click.command("sweep")
@click.argument("experiment", type=click.Path(path_type=Path))
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Runs at a time (default: the file's `jobs`).")
@dask_option
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), help="Default: runs/NAME-OF-EXPERIMENT.")
@click.option(
    "--redo",
    type=click.Choice(sorted(set(OUTCOMES) - {"interrupted", "malformed"})),
    multiple=True,
    metavar="OUTCOME",
    help="Do recorded runs that ended so again (crashed, memory, …); may stand several times.",
)
@click.option("--dry-run", is_flag=True, help="Check the file, say how many runs it means and how long at most.")
@click.option(
    "--slurm-script",
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="FILE",
    help="Write a Slurm batch script that runs it with --jobs workers, and run nothing.",
)
def command(
    experiment: Path,
    jobs: int | None,
    dask: str | None,
    out: Path | None,
    redo: tuple[str, ...],
    dry_run: bool,
    slurm_script: Path | None,
) -> None:
    """Do every run of EXPERIMENT.toml and record each as one line of OUT/runs.jsonl.

    It may be stopped or killed at any moment: start it again and it does what is left.

    \b
    Examples:
      smash sweep experiments/ablation.toml --jobs 2
      smash sweep experiments/ablation.toml --redo crashed --redo memory
      smash sweep experiments/ablation-full.toml --dask tcp://head:8786 --out runs/full
      smash sweep experiments/ablation-full.toml --jobs 40 --slurm-script full.sh && sbatch full.sh
    """
    read = read_experiment(experiment)
    runs = installed_runs(read, experiment.parent)
    out = out or Path("runs") / read.name
    width = jobs or read.jobs
    if dry_run:
        hours = sum(run.job.budget for run in runs) / width / 3600
        click.echo(
            f"{counted(len(runs), 'run')}, at most {hours:.1f} h with {width} at a time, to be recorded in {out}"
        )
        return
    if slurm_script is not None:
        out.mkdir(parents=True, exist_ok=True)  # Slurm writes its log there, and makes no directory
        write_text(slurm_script, batch_script(runs, experiment, out, width))
        click.echo(
            f"{slurm_script}: {counted(len(runs), 'run')} with {counted(width, 'worker')}, to be submitted with sbatch"
        )
        return
    run_all(runs, out, width, dask, partial(keep, read, experiment.parent, out, experiment), redo)


def installed_runs(experiment: Experiment, base: Path) -> list[Run]:
    """Return the experiment's runs; those of planners that are not installed here are left out, which is said."""
    lacking = not_installed(experiment)
    runs = [((run.job.planner, run.job.settings.command), run) for run in experiment_runs(experiment, base)]
    for planner, reason in lacking.items():
        count = sum(mine == planner for mine, _ in runs)
        words = f"{reason}; {counted(count, 'run')} left out, start again when it is there"
        click.echo(one_line(words), err=True)
    return [run for planner, run in runs if planner not in lacking]


def run_all(
    runs: list[Run],
    out: Path,
    jobs: int,
    dask: str | None,
    keep: Callable[[], None],
    redo: Collection[str] = (),
) -> None:
    """Do what is left of `runs`, recorded in `out`, and say how it went.

    Args:
        runs: what is to be recorded.
        out: the results directory.
        jobs: runs at a time, here.
        dask: where a scheduler is, or None.
        keep: writes what is run beside the records, once the directory is ours.
        redo: outcomes of recorded runs that are done again.

    Raises:
        SmashError: where the directory is in use or damaged, the scheduler cannot be reached, or it was interrupted.
    """
    meant = {run.key for run in runs}

    def again(record: RunRecord) -> bool:
        return record.key in meant and record.outcome in redo

    with stopped_by_signals() as stop, Writer(out, RUNS, again) as records:
        keep()
        kept = sum(run.key in records.finished for run in runs)
        _say_state(records, runs, kept)
        if kept < len(runs):
            _sweep(runs, records, kept, jobs, dask, stop)
    click.echo(f"{counted(len(runs), 'run')} recorded in {records.path}")


def _say_state(records: Writer[RunRecord], runs: list[Run], kept: int) -> None:
    for line in records.set_aside:
        click.echo(one_line(f"{line}: damaged: set aside, its run is done again"), err=True)
    if records.redone:
        click.echo(f"{records.redone} recorded runs are done again; their records lie in runs.redone", err=True)
    if kept:
        now, meant = commit().hash, {run.key for run in runs}
        old = sum(record.key in meant and record.commit.hash != now for record in records.earlier)
        mixed = f" ({old} of them made by another commit)" if old else ""
        click.echo(f"{kept} of {len(runs)} runs were finished before and are kept{mixed}", err=True)
    others = len(records.finished) - kept
    if others:
        click.echo(f"{others} records there belong to other experiments", err=True)


def _sweep(runs: list[Run], records: Writer[RunRecord], kept: int, jobs: int, dask: str | None, stop: Event) -> None:
    most = max(longest(run.job.budget) for run in runs)
    with (
        pool(jobs, dask, most, partial(click.echo, err=True)) as there,
        Progress(len(runs), kept, there.width or len(runs), pool_begins=there.here) as progress,
    ):
        sweep(runs, records, there.executor, local_task(stop, progress) if there.here else execute, progress, stop)
