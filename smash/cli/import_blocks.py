"""`smash import-blocks PROBLEM.pddl`: a classical blocks-world problem as an instance."""

from __future__ import annotations

from pathlib import Path

import click

from smash.problem.blocksworld.problem_file import read_blocksworld
from smash.problem.files.instances import write_instance


@click.command("import-blocks")
@click.argument("problem", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), required=True, help="Instance file to write.")
def command(problem: Path, out: Path) -> None:
    """Turn a blocks-world PROBLEM in PDDL (the IPC's, typed or not) into an instance.

    As many locations as blocks, no buffer, an `on` goal: without topple its costs are the classical plan lengths.

    \b
    Example:
      smash import-blocks probBLOCKS-16-1.pddl --out blocks-16-1.json
      smash plan blocks-16-1.json --planner precedence --no-topple
    """
    instance = read_blocksworld(problem)
    write_instance(instance, out)
    click.echo(f"{len(instance.blocks)} blocks in {out}")
