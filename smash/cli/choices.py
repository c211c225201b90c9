"""Options that several subcommands share."""

from __future__ import annotations

import click

from smash.problem.family import FAMILY

without_option = click.option(
    "--without",
    type=click.Choice([name for name in FAMILY if name != "topple"]),
    multiple=True,
    help="An aggregating action of the instance that plans may not use; may be given twice.",
)
