"""`smash planners`: what there is to plan with."""

from __future__ import annotations

from shutil import get_terminal_size
from textwrap import wrap

import click

from smash.planners.registry import get_planner, planner_names
from smash.problem.errors import Unsupported
from smash.problem.words import one_line

UNBROKEN = 10_000
"""Columns of what is no terminal: a line a planner."""
NARROWEST = 30
"""Fewest columns of what a planner is, beside its name."""


@click.command("planners")
def command() -> None:
    """List the planners: what each is, whether it is anytime and proves optima, what is missing."""
    rows = []
    for name in planner_names():
        try:
            planner = get_planner(name)
        except Unsupported as error:
            rows.append((name, "-", "-", str(error).split(": ", 1)[-1]))
            continue
        except (Exception, SystemExit) as error:  # another's package: it must not hide the others
            rows.append((name, "-", "-", one_line(f"broken: {type(error).__name__}: {error}")))
            continue
        rows.append(
            (
                name,
                "anytime" if getattr(planner, "anytime", False) else "one plan",
                "proves" if getattr(planner, "proves", False) else "-",
                getattr(planner, "summary", ""),
            )
        )
    widths = [max(len(row[column]) for row in rows) for column in range(3)]
    before = sum(widths) + 2 * len(widths)
    room = get_terminal_size(fallback=(UNBROKEN, 0)).columns - before
    for row in rows:
        first = "".join(f"{cell:<{width}}  " for cell, width in zip(row, widths, strict=False))
        click.echo(first + f"\n{' ' * before}".join(wrap(row[3], max(room, NARROWEST))))
