"""`smash prompt INSTANCE`: a problem as a text for a language model, in words or in PDDL."""

from __future__ import annotations

from pathlib import Path

import click

from smash.problem.files.instances import read_instance
from smash.problem.model import PlanOptions


@click.command("prompt")
@click.argument("instance", type=click.Path(path_type=Path))
@click.option("--as", "form", type=click.Choice(["words", "pddl"]), default="words", show_default=True)
@click.option("--no-topple", is_flag=True, help="Pick and place only.")
@click.option("--max-topple", type=click.IntRange(min=1), metavar="M", help="At most M blocks in one topple.")
def command(instance: Path, form: str, no_topple: bool, max_topple: int | None) -> None:
    """Print INSTANCE as a prompt: the rules, the start, the goal, and how to answer.

    `smash score` judges what comes back.

    \b
    Examples:
      smash prompt examples/figure1.json
      smash prompt examples/figure1.json --as pddl --no-topple
    """
    from smash.experiments.dataset.prompts import prompt_in_pddl, prompt_in_words

    tell = prompt_in_words if form == "words" else prompt_in_pddl
    click.echo(tell(read_instance(instance), PlanOptions(not no_topple, max_topple)), nl=False)
