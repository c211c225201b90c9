"""`smash generate single|multi`: random instances of the paper's two benchmarks."""

from __future__ import annotations

from pathlib import Path

import click

from smash.problem.files.instances import write_instance
from smash.problem.sets.generators import BENCHMARKS, BUFFERS, MOST, STACKS, generate


@click.command("generate")
@click.argument("benchmark", type=click.Choice(sorted(BENCHMARKS)))
@click.option(
    "--blocks", type=click.IntRange(1, MOST), required=True, metavar="N", help="Blocks, one for every stack or more."
)
@click.option("--stacks", type=click.IntRange(1, MOST), default=STACKS, show_default=True, metavar="N", help="Stacks.")
@click.option(
    "--buffers", type=click.IntRange(0, MOST), default=BUFFERS, show_default=True, metavar="B", help="Buffers."
)
@click.option("--count", type=click.IntRange(1, MOST), default=1, show_default=True, metavar="K", help="Instances.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, metavar="S", help="Random seed.")
@click.option("--out", type=click.Path(path_type=Path, file_okay=False), required=True, help="Directory to write to.")
def command(benchmark: str, blocks: int, stacks: int, buffers: int, count: int, seed: int, out: Path) -> None:
    """Make random instances of a benchmark of the paper; the same seed gives the same files.

    Files of the same names are replaced; other instance files in the directory stay, which is said.

    \b
    single  one target block must reach height 1 of a further, empty location
    multi   all blocks have a place in the goal, on the same locations

    With --stacks N there are N stacks instead of the paper's three, and the names say so: multi-9x4-000.

    \b
    Example:
      smash generate multi --blocks 9 --buffers 12 --count 20 --seed 1 --out my-set
    """
    instances = generate(benchmark, blocks, stacks=stacks, buffers=buffers, count=count, seed=seed)
    out.mkdir(parents=True, exist_ok=True)
    written = {f"{instance.name}.json" for instance in instances}
    others = sorted(file.name for file in out.glob("*.json") if file.name not in written)
    for instance in instances:
        write_instance(instance, out / f"{instance.name}.json")
    click.echo(f"{count} instance{'s' if count > 1 else ''} in {out}")
    if others:
        more = f" and {len(others) - 1} more" if len(others) > 1 else ""
        click.echo(f"{out} holds other files too, which belong to the set now: {others[0]}{more}", err=True)
