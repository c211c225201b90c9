"""`smash costs RESULTS INSTANCE`: an instance whose costs are the durations that the executor measured."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import click

from smash.cli import fail
from smash.problem.extras import require
from smash.problem.files.instances import instance_from_document, read_instance, write_instance
from smash.problem.words import one_line


@click.command("costs")
@click.argument("results", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.argument("instance", type=click.Path(path_type=Path))
@click.option("--scene", type=click.Path(path_type=Path), help="Scene file (default: the built-in scene).")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write INSTANCE with these costs here.")
def command(results: Path, instance: Path, scene: Path | None, out: Path | None) -> None:
    """Fit the costs of actions and travel, in milliseconds, to the episodes of RESULTS, and say how well they fit.

    Travel is measured between the places of the scene along the arc that the arm turns on. An action of INSTANCE that
    no episode has carried out keeps its cost. The episodes are of one scene, noise and pace.

    \b
    Examples:
      smash costs runs/scoop examples/scoop-seconds.json --scene examples/scoop-scene.toml
      smash costs runs/tables my.json --out my-in-milliseconds.json
    """
    require("smash costs", "pinocchio", "coal", "toppra", "scipy")
    from smash.execution.layout.unrolled import unrolled_positions
    from smash.execution.scene.scene_file import scene_of
    from smash.experiments.studies.durations import Duration, durations, fit
    from smash.records.engines import require_alike
    from smash.records.files import EPISODES, RUNS
    from smash.records.reading import read
    from smash.records.scenes import DEFAULT, require_one_scene

    problem = read_instance(instance)
    tabletop = scene_of(scene)
    positions = unrolled_positions(tabletop, problem)
    runs, episodes = read(results, RUNS), read(results, EPISODES)
    for note in (*runs.notes(), *episodes.notes()):
        click.echo(one_line(note), err=True)
    require_alike(str(results), "episodes", episodes.records)
    require_one_scene(str(results), (record.scene or DEFAULT for record in episodes.records))
    filed = {run.key: run.instance_document for run in runs.records}
    measured: list[Duration] = []
    for record in episodes.records:
        if record.episode is not None and record.run in filed:
            done = instance_from_document(filed[record.run])
            measured += durations(record.episode.actions, done, unrolled_positions(tabletop, done))
    if not measured:
        fail(f"{results}: no action was carried out", 2)
    fitted = fit(measured)
    click.echo("action      base [s]  spread [s]  count")
    for kind, base in fitted.bases.items():
        click.echo(f"{kind:<10}{base:>10.2f}{fitted.spread[kind]:>12.2f}{fitted.counts[kind]:>7}")
    click.echo(f"travel    {fitted.per_metre:>10.2f} s/m; {100 * fitted.explained:.0f} % of the variance explained")
    if out is not None:
        costs = fitted.costs(positions)
        write_instance(replace(problem, costs=replace(costs, actions={**problem.costs.actions, **costs.actions})), out)
