"""`smash topple-map`: where toppled blocks land, and how often a topple of each size and height goes well."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from smash.cli.choices import dask_option, engine_option, robot_option, say_engine
from smash.cli.signals import stopped_by_signals
from smash.problem.errors import SmashError
from smash.problem.extras import EXECUTION, require
from smash.problem.words import counted, one_line

if TYPE_CHECKING:
    from smash.experiments.episodes.question import TrialRun
    from smash.records.trials import Trial


@click.command("topple-map")
@click.option(
    "--highest-cut", type=click.IntRange(1, 9), default=4, show_default=True, metavar="H", help="Cuts 1 to H."
)
@click.option(
    "--most", type=click.IntRange(1, 9), default=9, show_default=True, metavar="M", help="1 to M blocks fall."
)
@click.option(
    "--seeds", type=click.IntRange(1, 10_000), default=4, show_default=True, metavar="N", help="Trials of each."
)
@click.option(
    "--first-seed", type=click.IntRange(min=0), default=0, metavar="S", help="Seeds S, S + 1, … (default: 0)."
)
@click.option("--scene", type=click.Path(path_type=Path), help="Scene file (default: the built-in scene).")
@engine_option
@robot_option
@click.option("--jobs", type=click.IntRange(min=1), default=1, show_default=True, metavar="N", help="At a time.")
@dask_option
@click.option(
    "--model", type=click.Path(path_type=Path, dir_okay=False), help="Write the scene's outcome model here, too."
)
@click.option(
    "--against",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Hold this outcome model against the trials (others than it was made from): calibration.md.",
)
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), default=Path("runs/topple-map"))
def command(
    highest_cut: int,
    most: int,
    seeds: int,
    first_seed: int,
    scene: Path | None,
    engine: str | None,
    robot: str | None,
    jobs: int,
    dask: str | None,
    model: Path | None,
    against: Path | None,
    out: Path,
) -> None:
    """Topple piles of up to 9 blocks in simulation; write trials.jsonl, estimates.json and map.png to OUT.

    It may be stopped at any moment: start it again and it does the trials that are left.

    With --model it rehearses picks and places, too, and writes what `smash plan --objective seconds --model` reads.

    \b
    Examples:
      smash topple-map --highest-cut 3 --most 5 --jobs 2
      smash topple-map --scene my-scene.toml --out runs/my-map --model my-model.json
      smash plan my.json --objective seconds --model my-model.json
      smash topple-map --first-seed 4 --out runs/check --against my-model.json
      smash topple-map --dask tcp://head:8786 --out runs/my-map
    """
    require("smash topple-map", *EXECUTION, "matplotlib")
    from smash.execution.physics.engines import engine_of
    from smash.execution.scene.scene_file import scene_of
    from smash.execution.trials.calibration import calibrations, require_comparable, table
    from smash.execution.trials.estimates import ENOUGH, TRUSTED, write_estimates
    from smash.execution.trials.outcome_model import outcome_model, require_modelled
    from smash.execution.trials.topple_map import draw, estimates
    from smash.experiments.episodes.simulation import LONGEST
    from smash.experiments.episodes.topple_trials import run_apart, wanted_trials
    from smash.experiments.isolation.job import longest
    from smash.experiments.sweeps.pool import pool
    from smash.experiments.sweeps.sweep import sweep
    from smash.forecast.model import read_model, write_model
    from smash.problem.files.documents import require_writable, write_text
    from smash.records.files import TRIALS
    from smash.records.writing import Writer

    require_writable(model)
    tabletop = scene_of(scene, robot=robot)
    if model is not None:
        require_modelled(tabletop)
    named, engine = engine, engine_of(tabletop, engine)
    say_engine(engine, tabletop, named)
    chosen_seeds = range(first_seed, first_seed + seeds)
    judged = None
    if against is not None:
        judged = read_model(against)
        try:
            require_comparable(judged, tabletop.fingerprint, engine, chosen_seeds)
        except SmashError as error:
            raise SmashError(f"--against {against}: {error}") from None
    trials: dict[Hashable, Trial] = {}
    wanted = wanted_trials(tabletop, engine, highest_cut, most, chosen_seeds)

    with stopped_by_signals() as stop, Writer(out, TRIALS) as records:
        trials |= {trial.key: trial for trial in records.earlier}
        for line in records.set_aside:
            click.echo(one_line(f"{line}: damaged: set aside, its trial is done again"), err=True)
        if any(run.key not in records.finished for run in wanted):
            with pool(jobs, dask, longest(LONGEST), partial(click.echo, err=True)) as there:
                task = partial(run_apart, stop=stop) if there.here else run_apart
                sweep(wanted, records, there.executor, task, _Said(trials, wanted), stop)
    chosen = [trials[run.key] for run in wanted]
    found = estimates(tabletop.name, chosen)
    write_estimates(found, out / "estimates.json")
    draw(chosen, out / "map.png")
    if model is not None:
        made = outcome_model(tabletop, chosen)
        write_model(made, model)
        click.echo(
            f"{model}: {len(made.topples)} topples; {made.moves.count} picks and places, "
            f"{100 * made.moves.explained:.0f} % of the variance of their times explained"
        )
    if judged is not None:
        held = table(calibrations(judged, chosen))
        write_text(out / "calibration.md", f"{held}\n")
        click.echo(held)
    suggested = found.suggested_max_topple
    none = f"none is trusted: {ENOUGH} trials of a size or more, {TRUSTED:.0%} of them successful, are needed"
    said = f"suggested --max-topple {suggested}" if suggested else none
    click.echo(f"{counted(len(chosen), 'trial')} in {out}; {said}")


class _Said:
    """Keeps each trial, and says how it went."""

    def __init__(self, trials: dict[Hashable, Trial], wanted: Sequence[TrialRun]) -> None:
        self._trials = trials
        self._wanted = wanted

    def ended(self, run: TrialRun, trial: Trial) -> None:
        """Say it."""
        self._trials[run.key] = trial
        words = "success" if trial.success else trial.problem or "failure"
        done = sum(wanted.key in self._trials for wanted in self._wanted)
        click.echo(f"[{done}/{len(self._wanted)}] cut {trial.height}, {trial.falling} falling: {words}", err=True)
