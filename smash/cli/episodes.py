"""`smash episodes RESULTS`: carry out every plan of a sweep."""

from __future__ import annotations

from collections.abc import Collection, Hashable
from functools import partial
from itertools import product
from pathlib import Path

import click

from smash.cli.choices import PACE, dask_option, engine_option, robot_option
from smash.cli.signals import stopped_by_signals
from smash.experiments.episodes.asked import MOST_SEEDS, note_asked
from smash.experiments.episodes.question import EpisodeRun
from smash.experiments.episodes.series import POLICIES, REPLAYS, episode_runs, run_episode
from smash.experiments.episodes.simulation import LONGEST
from smash.experiments.isolation.job import longest
from smash.experiments.sweeps.display import span
from smash.experiments.sweeps.pool import pool
from smash.experiments.sweeps.sweep import sweep
from smash.problem.extras import EXECUTION, require
from smash.problem.words import counted, one_line
from smash.records.episodes import EpisodeRecord
from smash.records.files import EPISODES
from smash.records.reading import read
from smash.records.writing import Writer

SECONDS_AN_EPISODE = 5.0
"""Wall time of a typical episode on one core, for the estimate [s]."""


@click.command("episodes")
@click.argument("results", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option(
    "--seeds", type=click.IntRange(1, MOST_SEEDS), default=1, show_default=True, metavar="N", help="Seeds 0 to N-1."
)
@click.option(
    "--policy",
    "policies",
    type=click.Choice(POLICIES),
    multiple=True,
    default=("replan",),
    show_default=True,
    help="`open` is the paper's open pipeline; may be given twice.",
)
@click.option("--label", "labels", multiple=True, metavar="NAME", help="Only plans of this planner; repeatable.")
@click.option("--scene", type=click.Path(path_type=Path), help="Scene file (default: the built-in scene).")
@click.option(
    "--noise",
    "noises",
    multiple=True,
    metavar="KIND=AMOUNT,…",
    help="As of `smash execute`; each is a scene of its own.",
)
@click.option("--pace", "paces", type=PACE, multiple=True, metavar="SHARE", help="The same.")
@engine_option
@robot_option
@click.option("--replays", is_flag=True, help="Write a 3D replay of each plan's first episode to RESULTS/replays.")
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, metavar="N", help="At a time.")
@dask_option
@click.option(
    "--redo", is_flag=True, help="Carry out again what was recorded without an episode: its process ended badly."
)
@click.option("--dry-run", is_flag=True, help="Say how many episodes are left and how long they take at a guess.")
def command(
    results: Path,
    seeds: int,
    policies: tuple[str, ...],
    labels: tuple[str, ...],
    scene: Path | None,
    noises: tuple[str, ...],
    paces: tuple[float, ...],
    engine: str | None,
    robot: str | None,
    replays: bool,
    jobs: int,
    dask: str | None,
    redo: bool,
    dry_run: bool,
) -> None:
    """Carry out every plan in RESULTS/runs.jsonl and record each episode as one line of RESULTS/episodes.jsonl.

    It may be stopped or killed at any moment: start it again and it does what is left.

    \b
    Examples:
      smash sweep experiments/tables-subset.toml --out runs/tables && smash episodes runs/tables --jobs 2
      smash episodes runs/tables --label smash --policy replan --policy open --seeds 3
      smash episodes runs/tables --label smash --noise pose=3mm --noise pose=5mm
      smash episodes runs/tables-mujoco --engine mujoco
      smash episodes runs/tables --dask tcp://head:8786
    """
    require("smash episodes", *EXECUTION)
    if replays and dask is not None:
        raise click.UsageError("--replays goes with episodes here; `smash execute --replay` makes one of any episode")
    from smash.execution.physics.engines import engine_of
    from smash.execution.scene.scene_file import scene_of

    engine = engine_of(scene_of(scene), engine)
    file = None if scene is None else str(scene.resolve())
    changes = list(product(noises or (None,), paces or (None,)))
    runs = [
        run
        for noise, pace in changes
        for run in episode_runs(
            results, range(seeds), policies, file, labels, replays, noise=noise, pace=pace, engine=engine, robot=robot
        )
    ]
    again = partial(_ended_without, {run.key for run in runs} if redo else set())
    if dry_run:
        reading = read(results, EPISODES) if EPISODES.path(results).is_file() else None
        for note in () if reading is None else reading.notes():
            click.echo(one_line(note), err=True)
        kept = {record.key for record in ([] if reading is None else reading.records) if not again(record)}
        _say_left(len(runs), sum(run.key not in kept for run in runs), jobs, engine)
        return
    if replays:
        (results / REPLAYS).mkdir(exist_ok=True)
    with stopped_by_signals() as stop, Writer(results, EPISODES, again) as records:
        left = sum(run.key not in records.finished for run in runs)
        for line in records.set_aside:
            click.echo(one_line(f"{line}: damaged: set aside, its episode is carried out again"), err=True)
        _say_left(len(runs), left, jobs, engine)
        if records.redone:
            lie = f"their records lie in {EPISODES.redone(results).name}"
            click.echo(f"{counted(records.redone, 'recorded episode')} carried out again; {lie}", err=True)
        bare = sum(run.key in records.finished and not Path(run.replay).exists() for run in runs if run.replay)
        if bare:
            click.echo(f"{bare} recorded earlier have no replay: `smash execute --replay` makes one", err=True)
        for noise, pace in changes:
            note_asked(results, seeds, policies, scene, labels, noise, pace, engine, robot)
        if left:
            with pool(jobs, dask, longest(LONGEST), partial(click.echo, err=True)) as workers:
                task = partial(run_episode, stop=stop) if workers.here else run_episode
                sweep(runs, records, workers.executor, task, _Said(left), stop)
    click.echo(f"{counted(len(runs), 'episode')} recorded in {records.path}")


def _ended_without(meant: Collection[Hashable], record: EpisodeRecord) -> bool:
    return record.episode is None and record.key in meant


def _say_left(count: int, left: int, jobs: int, engine: str) -> None:
    about = span(left * SECONDS_AN_EPISODE / jobs)
    click.echo(f"{counted(count, 'episode')}, {left} left, about {about} with {jobs} at a time, by {engine}", err=True)


class _Said:
    """Says of each episode how it ended."""

    def __init__(self, left: int) -> None:
        self._left = left
        self._done = 0

    def ended(self, run: EpisodeRun, record: EpisodeRecord) -> None:
        """Say it."""
        self._done += 1
        words = f"{record.instance} {record.label} {record.variant} {record.policy} {record.seed}"
        click.echo(one_line(f"[{self._done}/{self._left}] {words}: {_end(record)}"), err=True)


def _end(record: EpisodeRecord) -> str:
    if record.episode is None:
        return record.problem
    return "success" if record.episode.failure is None else record.episode.failure.reason
