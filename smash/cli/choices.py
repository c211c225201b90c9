"""Options that several subcommands share."""

from __future__ import annotations

from math import isnan
from typing import Any

import click

from smash.problem.actions.registry import FAMILY

without_option = click.option(
    "--without",
    type=click.Choice([name for name in FAMILY if name != "topple"]),
    multiple=True,
    help="An aggregating action of the instance that plans may not use; may be given twice.",
)


class _Seconds(click.FloatRange):
    """A span of time: more than none, and a number."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        seconds: float = super().convert(value, param, ctx)
        if isnan(seconds):
            self.fail(f"{value!r} is not a number of seconds.", param, ctx)
        return seconds


SECONDS = _Seconds(min=0, min_open=True, max=1e9)
"""The type of options that take a span of time."""
