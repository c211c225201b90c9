"""`smash topple-map`: where toppled blocks land, and how often a topple of each size and height goes well."""

from __future__ import annotations

from pathlib import Path

import click


@click.command("topple-map")
@click.option(
    "--highest-cut", type=click.IntRange(1, 9), default=4, show_default=True, metavar="H", help="Cuts 1 to H."
)
@click.option(
    "--most", type=click.IntRange(1, 9), default=6, show_default=True, metavar="M", help="1 to M blocks fall."
)
@click.option(
    "--seeds",
    type=click.IntRange(min=1),
    default=4,
    show_default=True,
    metavar="N",
    help="Trials of each, stack by stack.",
)
@click.option("--scene", type=click.Path(path_type=Path), help="Scene file (default: the built-in scene).")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), default=Path("runs/topple-map"))
def command(highest_cut: int, most: int, seeds: int, scene: Path | None, out: Path) -> None:
    """Topple piles of up to 9 blocks in simulation; write trials.jsonl, estimates.json and map.png to OUT.

    It may be stopped at any moment: start it again and it does the trials that are left.

    \b
    Example:
      smash topple-map --highest-cut 3 --most 5 --seeds 4
    """
    import msgspec

    from smash.execution.estimates import write_estimates
    from smash.execution.scene_file import default_scene, read_scene
    from smash.execution.topple_map import Trial, draw, estimates, run_trial
    from smash.experiments.json_lines import set_damaged_aside

    tabletop = default_scene() if scene is None else read_scene(scene)
    out.mkdir(parents=True, exist_ok=True)
    path = out / "trials.jsonl"
    if set_damaged_aside(path, _is_trial):
        click.echo(f"the last line of {path} was damaged: set aside, its trial is done again", err=True)
    lines = path.read_bytes().splitlines() if path.exists() else []
    trials = {trial.key: trial for trial in (msgspec.json.decode(line, type=Trial) for line in lines)}
    wanted = [
        (tabletop.name, seed % len(tabletop.stacks), height, falling, seed)
        for seed in range(seeds)
        for height in range(1, highest_cut + 1)
        for falling in range(1, most + 1)
        if height - 1 + falling <= min(9, tabletop.highest)
    ]
    with path.open("ab") as file:
        for number, key in enumerate(wanted, start=1):
            if key in trials:
                continue
            trial = trials[key] = run_trial(tabletop, *key[1:])
            file.write(msgspec.json.encode(trial) + b"\n")
            file.flush()
            words = "success" if trial.success else trial.problem or "failure"
            click.echo(f"[{number}/{len(wanted)}] cut {trial.height}, {trial.falling} falling: {words}", err=True)
    chosen = [trials[key] for key in wanted]
    found = estimates(tabletop.name, chosen)
    write_estimates(found, out / "estimates.json")
    draw(chosen, out / "map.png")
    click.echo(f"{len(chosen)} trials in {out}; suggested --max-topple {found.suggested_max_topple}")


def _is_trial(line: bytes) -> bool:
    import msgspec

    from smash.execution.topple_map import Trial

    try:
        msgspec.json.decode(line, type=Trial)
    except msgspec.MsgspecError:
        return False
    return True
